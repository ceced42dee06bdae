"""Baseline of a model: the free coordinates u, and the material of each specimen as a function of u.

A diagnosis fits one shear modulus per specimen at a fixed K/G (`per_specimen`); a fit of a law fits the
coordinates of that law (`calibration.parameters`), one material for all its specimens (`of_law`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import helmert

from calibration.parameters import Parametrisation, parametrisation
from tisim import Material

Array = NDArray[np.float64]

SCATTER = 0.15  # sd of ln G between specimens of one material
LARGEST = 0.20  # the same with poor moulding: larger differences are not scatter
SPECIMENS = "specimens"  # set of the discrepancy basis for differences between specimens of one material
# factor on the squared projections onto a set of the basis before they are compared with noise
ALLOWED: Mapping[str, float] = {SPECIMENS: (SCATTER / LARGEST) ** 2}
REFERENCE = 1e5  # shear modulus at which a law's shape is evaluated, before it is scaled [Pa]


class OfSpecimen(Protocol):
    @property
    def material(self) -> str: ...

    @property
    def specimen(self) -> str | None: ...


@dataclass(frozen=True, kw_only=True)
class Extra:
    """A further coordinate of a kind of measurement (a release time, a test's own deviation).

    Attributes
    ----------
    name : name of the coordinate.
    sd, centre : standard deviation and mean of its normal prior.
    bounds : the model clips the coordinate to this interval.
    """

    name: str
    sd: float
    centre: float = 0.0
    bounds: tuple[float, float] = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False, kw_only=True)
class Baseline:
    """Layout, prior and material map of the coordinates u, shape (n,).

    Order of u: ln(G / 1 Pa) of each specimen; for each material the coordinates of the law except its modulus
    and K/G, which is fixed; extras. If `whole` is True (a fit of one law): for each material all coordinates
    of its law; extras.

    Attributes
    ----------
    specimens, owners : names of the specimens, and the material of each.
    law : the law in search coordinates.
    bulk_ratio : fixed K/G; NaN if `whole`.
    extras : further coordinates.
    whole : True if all coordinates of the law are free, one set per material.
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
        """One shear modulus per specimen; ln G scatters with sd SCATTER between specimens of one material.

        ValueError for an unknown law, or one whose first coordinate is not a modulus.
        """
        form = parametrisation(law, terms=terms)
        first = form.coordinates[0]
        if not (first.log and first.start is None):
            raise ValueError(f"{law}: expected a law whose first coordinate is a modulus")
        specimens, owners = _specimens(records)
        return cls(law=form, bulk_ratio=bulk_ratio, specimens=specimens, owners=owners)

    @classmethod
    def of_law(cls, records: Sequence[OfSpecimen], law: Parametrisation) -> Baseline:
        """All coordinates of a law, including K/G, one material for all its specimens.

        records : records or trials; one without a specimen counts as a specimen with the material's name.
        """
        specimens, owners = _specimens(records)
        return cls(law=law, bulk_ratio=float("nan"), whole=True, specimens=specimens, owners=owners)

    def with_extras(self, extras: Sequence[Extra]) -> Baseline:
        """Copy with these extras."""
        return replace(self, extras=tuple(extras))

    @cached_property
    def materials(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self.owners))

    @cached_property
    def free(self) -> tuple[int, ...]:
        """Indices of the law's coordinates that are free for each material."""
        if self.whole:
            return tuple(range(len(self.law.coordinates)))
        return tuple(k for k, c in enumerate(self.law.coordinates) if k > 0 and c.name != "bulk_ratio")

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates, (n,)."""
        own = tuple(self.law.coordinates[k].name for k in self.free)
        single = self.whole and len(self.materials) == 1
        shape = tuple(name if single else f"{m} {name}" for m in self.materials for name in own)
        return (() if self.whole else self.specimens) + shape + tuple(e.name for e in self.extras)

    @cached_property
    def first_extra(self) -> int:
        """Index of the first extra in u."""
        return len(self.names) - len(self.extras)

    @cached_property
    def bounds(self) -> Array:
        """Interval of each coordinate outside which it has no effect (it is clipped), shape (n, 2)."""
        found = np.tile([-np.inf, np.inf], (len(self.names), 1))
        if not self.whole:
            for m in self.materials:
                begin = self._begin(m)
                found[begin : begin + len(self.free)] = self.law.bounds[list(self.free)]
        found[self.first_extra :] = np.reshape([e.bounds for e in self.extras], (-1, 2))
        return found

    @cached_property
    def held(self) -> int:
        """Number of prior rows for the scatter between specimens of one material; they come first."""
        return 0 if self.whole else len(scatter_rows(self.owners))

    @cached_property
    def prior(self) -> Array:
        """Rows of the normal prior, shape (k, n): prior @ u - centre ~ N(0, 1)."""
        return self._priors[0]

    @cached_property
    def centre(self) -> Array:
        """Right-hand side of the prior (`prior`), shape (k,)."""
        return self._priors[1]

    def prior_residuals(self, u: Array) -> Array:
        """prior @ u - centre, shape (k,)."""
        return np.asarray(self.prior @ u - self.centre)

    # -- materials --

    def shear_modulus(self, specimen: str, u: Array) -> float:
        """Small-strain shear modulus of a specimen [Pa]."""
        if self.whole:
            return self.law.moduli(self.law_coordinates(self._owner[specimen], u)).shear_modulus
        return float(np.exp(u[self.specimens.index(specimen)]))

    def shear_moduli(self, u: Array) -> dict[str, float]:
        """Shear modulus of each material [Pa]: the geometric mean over its specimens."""
        if self.whole:
            return {m: self.law.moduli(self.law_coordinates(m, u)).shear_modulus for m in self.materials}
        return mean_moduli(self.owners, u[: len(self.owners)])

    def modulus_weights(self, material: str, u: Array) -> Array:
        """Derivatives of ln G of a material by u, shape (n,)."""
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
        """Coordinates of `law` for a material; the modulus is REFERENCE unless `whole`."""
        begin = self._begin(material)
        if self.whole:
            return np.asarray(u[begin : begin + len(self.free)])
        found = self.law.start(shear=REFERENCE)
        found[0] = np.log(REFERENCE)
        low, high = self.law.bounds[list(self.free)].T if self.free else (-np.inf, np.inf)
        # a constant beyond its range is clipped, and the others stay free
        found[list(self.free)] = np.clip(u[begin : begin + len(self.free)], low, high)
        return found

    def material(self, specimen: str, u: Array, *, density: float = 1000.0) -> Material:
        """Material of a specimen. density : [kg/m3]."""
        own = self.law_coordinates(self._owner[specimen], u)
        if not self.whole:
            own = self.scaled(own, self.shear_modulus(specimen, u))
        return self.law.material(own, density=density)

    def scaled(self, own: Array, shear_modulus: float) -> Array:
        """The law's coordinates with the fixed K/G, scaled to a small-strain shear modulus [Pa]."""
        found = own.copy()
        for k, c in enumerate(self.law.coordinates):
            if c.name == "bulk_ratio":
                found[k] = np.log(self.bulk_ratio)
        moduli = np.array([c.start is None for c in self.law.coordinates])
        return np.where(moduli, found + np.log(shear_modulus / self.law.moduli(found).shear_modulus), found)

    def start(self, shear_moduli: Mapping[str, float]) -> Array:
        """Start of a search, u (n,), from the specimens' shear moduli [Pa]; others at their start values."""
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
        """Mask (n,) of the coordinates that a record constrains, without extras.

        These are the modulus of its specimen and the law of its material; with `whole_material` the moduli of
        all specimens of its material, which the prior couples.
        """
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
        """Index in u of the first coordinate of a material's law."""
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
    """Prior rows (k, n) for the scatter of ln G between specimens of one material, in units of SCATTER.

    materials : the material of each of the n specimens. The rows are Helmert contrasts, one fewer per
    material than it has specimens: the mean of a material is free.
    """
    rows = []
    for m in dict.fromkeys(materials):
        mine = [k for k, owner in enumerate(materials) if owner == m]
        for contrast in helmert(len(mine)):
            row = np.zeros(len(materials))
            row[mine] = contrast
            rows.append(row / SCATTER)
    return np.array(rows).reshape(len(rows), len(materials))


def scatter_basis(size: int, first: int, held: int) -> Mapping[str, Array]:
    """Set of a discrepancy basis for differences between specimens of one material.

    Its columns (size, held) are unit vectors of the `held` rows of `scatter_rows`, which begin at row
    `first`. Empty if no material has two specimens.
    """
    return {SPECIMENS: np.eye(size)[:, first : first + held]} if held else {}


def mean_moduli(materials: Sequence[str], u: Array) -> dict[str, float]:
    """Shear modulus of each material [Pa]: the geometric mean over its specimens; u (n,) are ln(G / 1 Pa)."""
    found: dict[str, list[float]] = {}
    for m, value in zip(materials, u, strict=True):
        found.setdefault(m, []).append(float(value))
    return {m: float(np.exp(np.mean(v))) for m, v in found.items()}


def least_squares_moduli(
    curves: Iterable[tuple[str, Array, Array]], *, specimens: Sequence[str], falling: str
) -> dict[str, float]:
    """Least-squares shear modulus of each specimen [Pa], for a response that is proportional to it.

    Parameters
    ----------
    curves : for each record its specimen, the response for a unit modulus, and the measured one, shape (k,);
        both over the standard deviation, if points differ in it.
    specimens : names of the specimens; records of others do not count.
    falling : start of the sentence on a specimen for which no modulus is positive.

    Raises
    ------
    ValueError
        If the modulus of a specimen would not be positive.
    """
    top, bottom = dict.fromkeys(specimens, 0.0), dict.fromkeys(specimens, 0.0)
    for specimen, unit, measured in curves:
        if specimen not in top:
            continue
        top[specimen] += float(unit @ measured)
        bottom[specimen] += float(unit @ unit)
    for name in specimens:
        if not top[name] > 0.0:
            raise ValueError(f"specimen {name}: {falling}, no shear modulus gives that")
    return {name: top[name] / bottom[name] for name in specimens}
