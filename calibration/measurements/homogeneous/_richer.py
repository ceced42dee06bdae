"""A richer law that an effect mixes with the baseline's law; start values for the fit of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.experiment.model import CouponMode
from calibration.measurements._baseline import REFERENCE, Baseline, Extra
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.stress import DRIVEN, nominal_stresses
from calibration.parameters import Parametrisation
from tisim.laws import evaluate

Array = NDArray[np.float64]

WIDE = 0.25  # prior sd of a constant, as a fraction of its search range: keeps unidentified constants finite
DRAWS = 60  # random draws per constant before the local searches
SPREAD = 1.5  # sd of the draws of a logarithm
STARTS, MOST_STEPS = 3, 40  # number of local searches, and their largest number of evaluations
SHARP = 1e-4  # relative tolerance on the sum of squares of the last search
_BAD = 1e6  # whitened residual of a point without a solution


@dataclass(frozen=True, eq=False, kw_only=True)
class RicherLaw:
    """A law whose constants are coordinates of a fit, one set per material.

    Attributes
    ----------
    law : the law in search coordinates.
    shear_moduli : shear modulus of each specimen by the law's own fit [Pa].
    centres : start values of all coordinates of the law by material; the first modulus is REFERENCE.
    """

    law: Parametrisation
    shear_moduli: Mapping[str, float]
    centres: Mapping[str, Array]

    @classmethod
    def fitted(
        cls, law: Parametrisation, records: Sequence[Record], materials: Sequence[str], *, bulk_ratio: float
    ) -> RicherLaw:
        """The law, fitted to the records of each material (`law_starts`)."""
        shear_moduli, centres = law_starts(law, records, materials, bulk_ratio=bulk_ratio)
        return cls(law=law, shear_moduli=shear_moduli, centres=centres)

    @cached_property
    def free(self) -> tuple[int, ...]:
        """Indices of the coordinates other than the modulus and K/G."""
        return tuple(k for k, c in enumerate(self.law.coordinates) if k > 0 and c.name != "bulk_ratio")

    @cached_property
    def materials(self) -> tuple[str, ...]:
        return tuple(self.centres)

    def extras(self) -> list[Extra]:
        """The constants as extras of a baseline, with wide priors."""
        bounds = self.law.bounds
        return [
            Extra(
                name=f"{m} {self.law.label} {self.law.coordinates[k].name}",
                sd=float(WIDE * np.ptp(bounds[k])),
                centre=float(own[k]),
                bounds=(float(bounds[k][0]), float(bounds[k][1])),
            )
            for m, own in self.centres.items()
            for k in self.free
        ]

    def of(self, material: str, extras: Array) -> Array:
        """All coordinates of a material's law, shape (n,), with the constants from `extras`."""
        first = self.first(material)
        found = self.centres[material].copy()
        low, high = self.law.bounds[list(self.free)].T
        found[list(self.free)] = np.clip(extras[first : first + len(self.free)], low, high)
        return found

    def first(self, material: str) -> int:
        """Index of a material's first constant among the extras."""
        return self.materials.index(material) * len(self.free)


def law_start(
    law: Parametrisation, records: Sequence[Record], *, bulk_ratio: float
) -> tuple[dict[str, float], Array] | None:
    """Fit a law to the records of one material, as the start of a joint fit.

    The search is at constant volume, where a stress takes one evaluation; the moduli of the specimens are
    linear and are solved for. Constants are drawn over their range; the best draws are refined by local least
    squares. The best result is refined once more at `bulk_ratio`: at a stretch of 10 a rubber is 1 % larger,
    and nearly collinear terms of a series law are resolved by this search, not by the joint steps of a fit.

    Returns
    -------
    tuple or None
        Shear modulus of each specimen [Pa], and coordinates of the law (n,), whose first modulus is
        REFERENCE. None if the law has no solution.
    """
    curves = _Curves.of(law, records)
    base = law.start(shear=REFERENCE)
    moduli = [k for k, c in enumerate(law.coordinates) if c.start is None]
    base[moduli] += np.log(REFERENCE) - base[0]
    free = [k for k, c in enumerate(law.coordinates) if k > 0 and c.name != "bulk_ratio"]

    def full(x: Array) -> Array:
        u = base.copy()
        u[free] = x
        return u

    def residuals(x: Array) -> Array:
        return curves.residuals(full(x))

    def finite(x: Array) -> Array:
        return np.nan_to_num(residuals(x), nan=_BAD)

    low, high = law.bounds[free].T if free else (np.zeros(0), np.zeros(0))
    rng = np.random.default_rng(0)
    logs = np.array([law.coordinates[k].log for k in free], dtype=bool)
    drawn = [np.clip(base[free], low, high)]
    for _ in range(DRAWS * len(free)):
        x = np.where(logs, rng.normal(base[free], SPREAD), rng.uniform(low, high))
        drawn.append(np.clip(x, low, high))
    costs = np.array([_cost(residuals(x)) for x in drawn])
    best = drawn[int(np.argmin(costs))]
    least = float(costs.min())
    for k in np.argsort(costs)[:STARTS] if free else []:
        if not np.isfinite(costs[k]):
            break
        inside = 1e-6 * (high - low)
        start = np.clip(drawn[k], low + inside, high - inside)
        found = least_squares(finite, start, bounds=(low, high), max_nfev=MOST_STEPS)
        if 2.0 * found.cost < least:
            best, least = found.x, 2.0 * found.cost
    if not np.isfinite(least):
        return None
    real = replace(curves, bulk_ratio=bulk_ratio)

    def real_residuals(x: Array) -> Array:
        return np.nan_to_num(real.residuals(full(x)), nan=_BAD)

    if free and np.isfinite(_cost(real.residuals(full(best)))):
        start = np.clip(best, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
        best = least_squares(real_residuals, start, bounds=(low, high), max_nfev=MOST_STEPS, ftol=SHARP).x
    u = full(best)
    scale = law.moduli(u).shear_modulus
    return {s: scale * x for s, x in real.scales(u).items()}, u


def law_starts(
    law: Parametrisation, records: Sequence[Record], materials: Sequence[str], *, bulk_ratio: float
) -> tuple[dict[str, float], dict[str, Array]]:
    """Shear moduli by specimen [Pa], and coordinates of the law by material, from `law_start` of each.

    ValueError if the law has no solution for a material.
    """
    moduli: dict[str, float] = {}
    coordinates: dict[str, Array] = {}
    for m in materials:
        found = law_start(law, [r for r in records if r.material == m], bulk_ratio=bulk_ratio)
        if found is None:
            raise ValueError(f"{law.label}: no stress at the stretches of {m}")
        moduli |= found[0]
        coordinates[m] = found[1]
    return moduli, coordinates


@dataclass(frozen=True, eq=False, kw_only=True)
class _Curves:
    """Measured curves of a material for the comparison with a law.

    Attributes
    ----------
    law : the law in search coordinates.
    bulk_ratio : K/G; None for constant volume.
    modes : mode and stretches of each record.
    F : deformation gradients of all points at constant volume, shape (n, 3, 3).
    free, driven : principal stretch in the free and in the driven direction; 1 in simple shear, shape (n,).
    sheared : True for points in simple shear, shape (n,).
    stress, sd : measured stress and its standard deviation [Pa], shape (n,).
    owners : mask (n,) of the points of each specimen.
    """

    law: Parametrisation
    bulk_ratio: float | None
    modes: Sequence[tuple[CouponMode, Array]]
    F: Array
    free: Array
    driven: Array
    sheared: NDArray[np.bool_]
    stress: Array
    sd: Array
    owners: Mapping[str, NDArray[np.bool_]]

    @classmethod
    def of(cls, law: Parametrisation, records: Sequence[Record]) -> _Curves:
        sizes = [r.points for r in records]
        s = np.concatenate([r.stretch for r in records])
        sheared = np.repeat([r.mode == "simple-shear" for r in records], sizes)
        directions = np.array([DRIVEN.get(r.mode, (0.0, 0.0, 0.0)) for r in records])
        stretches = np.exp(np.log(np.where(sheared, 1.0, s))[:, None] * np.repeat(directions, sizes, axis=0))
        F = np.zeros((s.size, 3, 3))
        axis = np.arange(3)
        F[:, axis, axis] = stretches
        F[sheared, 0, 2] = s[sheared] - 1.0
        specimens = np.repeat([r.specimen for r in records], sizes)
        return cls(
            law=law,
            bulk_ratio=None,
            modes=[(r.mode, r.stretch) for r in records],
            F=F,
            free=stretches[:, 2],
            driven=stretches[:, 0],
            sheared=sheared,
            stress=np.concatenate([r.stress for r in records]),
            sd=np.concatenate([r.sd for r in records]),
            owners={n: specimens == n for n in dict.fromkeys(r.specimen for r in records)},
        )

    def scales(self, u: Array) -> dict[str, float]:
        """Best-fit factor on the law's stress for each specimen."""
        return self._scales(self._own(u))

    def _scales(self, own: Array) -> dict[str, float]:
        found = {}
        for name, mine in self.owners.items():
            q = own[mine] / self.sd[mine]
            found[name] = float(q @ (self.stress[mine] / self.sd[mine]) / (q @ q))
        return found

    def residuals(self, u: Array) -> Array:
        """Whitened residuals, shape (n,); NaN without a stress or with a modulus that is not positive."""
        with np.errstate(all="ignore"):
            try:
                own = self._own(u)
            except ValueError:  # outside the law's domain
                return np.full(self.stress.size, np.nan)
            scales = self._scales(own)
            factor = np.zeros(self.stress.size)
            for name, mine in self.owners.items():
                factor[mine] = scales[name] if scales[name] > 0.0 else np.nan
            return np.asarray((factor * own - self.stress) / self.sd)

    def _own(self, u: Array) -> Array:
        """Nominal stress of the law [Pa] with a traction-free side, shape (n,)."""
        if self.bulk_ratio is not None:
            bulk = [c.name == "bulk_ratio" for c in self.law.coordinates]
            material = self.law.material(np.where(bulk, np.log(self.bulk_ratio), u))
            return np.concatenate(nominal_stresses(material, self.modes))
        material = self.law.material(u)
        P = evaluate(material.law, material.parameters, self.F)[1]
        pulled = P[:, 0, 0] - P[:, 2, 2] * self.free / self.driven
        return np.asarray(np.where(self.sheared, P[:, 0, 2], pulled))


def _cost(z: Array) -> float:
    total = float(z @ z)
    return total if np.isfinite(total) else np.inf


def start_of(baseline: Baseline, records: Sequence[Record], *, bulk_ratio: float) -> Array:
    """Start coordinates u of a baseline: best fit of each material by itself at this K/G (`law_starts`).

    ValueError if the law has no solution.
    """
    moduli, laws = law_starts(baseline.law, records, baseline.materials, bulk_ratio=bulk_ratio)
    return np.concatenate(
        [
            [np.log(moduli[s]) for s in baseline.specimens],
            *(laws[m][list(baseline.free)] for m in baseline.materials),
            [e.centre for e in baseline.extras],
        ]
    )
