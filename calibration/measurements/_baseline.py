"""The baseline of a model: free coordinates u, and the one material that they give each specimen.

A diagnosis fits one shear modulus a specimen (`per_specimen`) at a held K/G; a fit of a law fits that law's
own coordinates of `calibration.parameters`, one material for all its specimens (`of_law`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import helmert

from calibration.parameters import Parametrisation, parametrisation
from tisim import Material

Array = NDArray[np.float64]

SCATTER = 0.15  # sd of ln G from one specimen of a material to the next
LARGEST = 0.20  # the same in a lab that moulds them badly: more is no scatter
SPECIMENS = "specimens"  # the part of a discrepancy basis in which specimens of one material differ
# squares of a part of the basis are taken less by this factor before they are compared with noise
ALLOWED: Mapping[str, float] = {SPECIMENS: (SCATTER / LARGEST) ** 2}
REFERENCE = 1e5  # shear modulus at which a law's shape is evaluated, before it is scaled [Pa]


class OfSpecimen(Protocol):
    @property
    def material(self) -> str: ...

    @property
    def specimen(self) -> str | None: ...


@dataclass(frozen=True, kw_only=True)
class Extra:
    """A further coordinate of a kind of measurement (a release time, a test's own deviation), with its normal
    prior: centre and sd; bounds : it is clipped to these where it is used."""

    name: str
    sd: float
    centre: float = 0.0
    bounds: tuple[float, float] = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False, kw_only=True)
class Baseline:
    """Coordinates u, in this order: ln(G / 1 Pa) of each specimen; of each material the law's coordinates
    other than its modulus (without K/G, which is held); extras. Where `whole` is set (a fit of one law): of
    each material all coordinates of its law, then extras.

    Attributes
    ----------
    specimens, owners : names, and the material of each.
    law : the law in search coordinates.
    bulk_ratio : K/G that is held.
    extras : further coordinates.
    whole : all of the law's coordinates are free, one set a material.
    """

    specimens: tuple[str, ...]
    owners: tuple[str, ...]
    law: Parametrisation
    bulk_ratio: float
    extras: tuple[Extra, ...] = field(default=())
    whole: bool = False

    @classmethod
    def per_specimen(
        cls, records: Sequence[OfSpecimen], *, law: str = "neo-hookean", terms: int = 1, bulk_ratio: float
    ) -> Baseline:
        """One shear modulus a specimen; specimens of one material lie together within SCATTER.

        ValueError for an unknown law, or one whose first coordinate is no modulus.
        """
        form = parametrisation(law, terms=terms)
        first = form.coordinates[0]
        if not (first.log and first.start is None):
            raise ValueError(f"{law}: expected a law whose first coordinate is a modulus")
        specimens, owners = _specimens(records)
        return cls(law=form, bulk_ratio=bulk_ratio, specimens=specimens, owners=owners)

    @classmethod
    def of_law(cls, records: Sequence[OfSpecimen], law: Parametrisation) -> Baseline:
        """A law's own coordinates, K/G among them, one material for all its specimens. records : trials will
        do; one without a specimen is of one that has the material's name."""
        specimens, owners = _specimens(records)
        return cls(law=law, bulk_ratio=float("nan"), whole=True, specimens=specimens, owners=owners)

    def with_extras(self, extras: Sequence[Extra]) -> Baseline:
        """The same with these further coordinates at the end."""
        return replace(self, extras=tuple(extras))

    @cached_property
    def materials(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self.owners))

    @cached_property
    def free(self) -> tuple[int, ...]:
        """Coordinates of the law that are free for each material, by index."""
        if self.whole:
            return tuple(range(len(self.law.coordinates)))
        return tuple(k for k, c in enumerate(self.law.coordinates) if k > 0 and c.name != "bulk_ratio")

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the coordinates, (n,)."""
        own = tuple(self.law.coordinates[k].name for k in self.free)
        single = self.whole and len(self.materials) == 1
        shape = tuple(name if single else f"{m} {name}" for m in self.materials for name in own)
        return (() if self.whole else self.specimens) + shape + tuple(e.name for e in self.extras)

    @cached_property
    def first_extra(self) -> int:
        """Where the extras begin in u."""
        return len(self.names) - len(self.extras)

    @cached_property
    def bounds(self) -> Array:
        """Beyond which a coordinate changes nothing, shape (n, 2)."""
        found = np.tile([-np.inf, np.inf], (len(self.names), 1))
        if not self.whole:
            for m in self.materials:
                begin = self._begin(m)
                found[begin : begin + len(self.free)] = self.law.bounds[list(self.free)]
        found[self.first_extra :] = np.reshape([e.bounds for e in self.extras], (-1, 2))
        return found

    @cached_property
    def held(self) -> int:
        """How many rows of the prior hold specimens of one material together; they come first."""
        return 0 if self.whole else len(scatter_rows(self.owners))

    @cached_property
    def prior(self) -> Array:
        """Rows (k, n) of what is known beforehand, in its sd: prior @ u - centre ~ N(0, 1)."""
        return self._priors[0]

    @cached_property
    def centre(self) -> Array:
        """Shape (k,); see `prior`."""
        return self._priors[1]

    def prior_residuals(self, u: Array) -> Array:
        """Shape (k,)."""
        return np.asarray(self.prior @ u - self.centre)

    # -- materials --

    def shear_modulus(self, specimen: str, u: Array) -> float:
        """[Pa]."""
        if self.whole:
            return self.law.moduli(self.law_coordinates(self._owner[specimen], u)).shear_modulus
        return float(np.exp(u[self.specimens.index(specimen)]))

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Of each material [Pa]: the geometric mean over its specimens."""
        if self.whole:
            return {m: self.law.moduli(self.law_coordinates(m, u)).shear_modulus for m in self.materials}
        return mean_moduli(self.owners, u[: len(self.owners)])

    def modulus_weights(self, material: str, u: Array) -> Array:
        """Derivatives of the logarithm of a material's shear modulus by u, shape (n,)."""
        weights = np.zeros(len(self.names))
        if not self.whole:
            mine = [k for k, owner in enumerate(self.owners) if owner == material]
            weights[mine] = 1.0 / len(mine)
            return weights
        step = 1e-5
        for k in range(self._begin(material), self._begin(material) + len(self.free)):
            moved = [u + s * step * np.eye(len(u))[k] for s in (1.0, -1.0)]
            up, down = (np.log(self.shear_moduli(v)[material]) for v in moved)
            weights[k] = (up - down) / (2.0 * step)
        return weights

    def law_coordinates(self, material: str, u: Array) -> Array:
        """Coordinates of `law` of a material; its modulus is REFERENCE where specimens have their own."""
        begin = self._begin(material)
        if self.whole:
            return np.asarray(u[begin : begin + len(self.free)])
        found = self.law.start(shear=REFERENCE)
        found[0] = np.log(REFERENCE)
        low, high = self.law.bounds[list(self.free)].T if self.free else (-np.inf, np.inf)
        # at an end of its range a constant stays, and the others go on
        found[list(self.free)] = np.clip(u[begin : begin + len(self.free)], low, high)
        return found

    def material(self, specimen: str, u: Array, *, density: float = 1000.0) -> Material:
        """What a specimen is made of; density [kg/m3]."""
        own = self.law_coordinates(self._owner[specimen], u)
        if not self.whole:
            own = self.scaled(own, self.shear_modulus(specimen, u))
        return self.law.material(own, density=density)

    def scaled(self, own: Array, shear_modulus: float) -> Array:
        """The law's coordinates with K/G as it is held and a small-strain shear modulus [Pa]."""
        found = own.copy()
        for k, c in enumerate(self.law.coordinates):
            if c.name == "bulk_ratio":
                found[k] = np.log(self.bulk_ratio)
        moduli = np.array([c.start is None for c in self.law.coordinates])
        return np.where(moduli, found + np.log(shear_modulus / self.law.moduli(found).shear_modulus), found)

    def start(self, shear_moduli: Mapping[str, float]) -> Array:
        """u with these shear moduli [Pa] of specimens, everything else where a search begins."""
        if self.whole:
            parts = []
            for m in self.materials:
                mine = [np.log(shear_moduli[s]) for s, owner in self._owner.items() if owner == m]
                parts.append(self.law.start(shear=float(np.exp(np.mean(mine)))))
        else:
            shape = self.law.start(shear=REFERENCE)[list(self.free)]
            parts = [
                np.array([np.log(shear_moduli[s]) for s in self.specimens]),
                *(shape for _ in self.materials),
            ]
        return np.concatenate([*parts, [e.centre for e in self.extras]])

    def informed_by(self, record: OfSpecimen, *, whole_material: bool) -> NDArray[np.bool_]:
        """Coordinates (n,) that a record constrains, without extras: its specimen's modulus and its
        material's law. whole_material : the moduli of all specimens of its material, which lie together."""
        found = np.zeros(len(self.names), dtype=bool)
        if not self.whole:
            for k, (s, owner) in enumerate(zip(self.specimens, self.owners, strict=True)):
                found[k] = owner == record.material if whole_material else s == record.specimen
        begin = self._begin(record.material)
        found[begin : begin + len(self.free)] = True
        return found

    # -- inside --

    @cached_property
    def _owner(self) -> dict[str, str]:
        return dict(zip(self.specimens, self.owners, strict=True))

    def _begin(self, material: str) -> int:
        """Where a material's coordinates of the law begin."""
        first = 0 if self.whole else len(self.specimens)
        return first + len(self.free) * self.materials.index(material)

    @cached_property
    def _priors(self) -> tuple[Array, Array]:
        n = len(self.names)
        held = np.zeros((0, 0)) if self.whole else scatter_rows(self.owners)
        rows = list(np.pad(held, ((0, 0), (0, n - held.shape[1]))))
        centres = [0.0] * len(rows)

        def add(k: int, centre: float, sd: float) -> None:
            row = np.zeros(n)
            row[k] = 1.0 / sd
            rows.append(row)
            centres.append(centre / sd)

        for m in self.materials:
            for j, k in enumerate(self.free):
                prior = self.law.coordinates[k].prior
                if prior is not None:
                    add(self._begin(m) + j, *prior)
        for j, e in enumerate(self.extras):
            add(self.first_extra + j, e.centre, e.sd)
        return np.array(rows).reshape(len(rows), n), np.array(centres)


def _specimens(records: Sequence[OfSpecimen]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the specimens, and the material of each."""
    owner = {r.specimen or r.material: r.material for r in records}
    return tuple(owner), tuple(owner.values())


def scatter_rows(materials: Sequence[str]) -> Array:
    """Prior rows (k, n) that hold the specimens of one material together, in sd of their scatter; materials :
    of the n specimens. One row fewer than each material has specimens: their mean is free."""
    rows = []
    for m in dict.fromkeys(materials):
        mine = [k for k, owner in enumerate(materials) if owner == m]
        for contrast in helmert(len(mine)):
            row = np.zeros(len(materials))
            row[mine] = contrast
            rows.append(row / SCATTER)
    return np.array(rows).reshape(len(rows), len(materials))


def scatter_basis(size: int, first: int, held: int) -> Mapping[str, Array]:
    """The part of a discrepancy basis in which specimens of one material differ: columns (size, held), where
    the rows of `scatter_rows` are those from `first`. None where no material has two specimens."""
    return {SPECIMENS: np.eye(size)[:, first : first + held]} if held else {}


def mean_moduli(materials: Sequence[str], u: Array) -> dict[str, float]:
    """Of each material [Pa]: the geometric mean over its specimens, whose ln(G / 1 Pa) are u (n,)."""
    found: dict[str, list[float]] = {}
    for m, value in zip(materials, u, strict=True):
        found.setdefault(m, []).append(float(value))
    return {m: float(np.exp(np.mean(v))) for m, v in found.items()}
