"""A law fitted to coupons: local least squares from many starts, CMA-ES before where the cost has basins."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.experiment.model import CouponTrial, Experiment, MaterialBelief
from calibration.inference import Identification, identify
from calibration.measurements._baseline import Baseline
from calibration.measurements._state import State
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import stress_of
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.parameters import Parametrisation
from tisim import Material

Array = NDArray[np.float64]
Residuals = Callable[[Array], Array]

_SAME = 1.01  # a start within this factor of the best cost has reached it
_BAD = 1e30  # CMA-ES's cost of a candidate without an answer


class FitStatus(StrEnum):
    """How a fit ended."""

    CONVERGED = "converged"
    NOT_CONVERGED = "not-converged"  # the best start ran out of steps
    NO_ANSWER = "no-answer"  # at no start has the law a stress at all measured points


@dataclass(frozen=True, eq=False, kw_only=True)
class CouponFit:
    """The best of all starts.

    Attributes
    ----------
    records : points as they are compared (of long records the means of neighbours).
    status : how it ended.
    u : search coordinates, shape (n,); NaN without an answer.
    chi2 : of the points, with their standard deviations.
    points : how many.
    starts, reached, unanswered : starts tried, those that ended at the best cost (within 1 %), those at which
        the law had no answer.
    evaluations : of the law on all curves.
    held : coordinates that were not fitted.
    identification : covariance and what the data see; None without an answer. Where the law misfits, errors
        of neighbouring points are alike and the intervals are too narrow, though scaled by chi-square.
    """

    parametrisation: Parametrisation
    records: tuple[Record, ...]
    status: FitStatus
    u: Array
    chi2: float
    points: int
    starts: int
    reached: int
    unanswered: int
    evaluations: int
    held: tuple[str, ...] = ()
    identification: Identification | None = None

    @property
    def undecided(self) -> dict[str, str]:
        """Coordinates that priors, bounds or the caller decided, not the data: name -> "held",
        "not identified" or "at a bound"; "weak" where an interval is too wide to print one figure."""
        if self.identification is None:
            return {}
        seen = {e.name: e.seen for e in self.identification.estimates if e.seen != "identified"}
        return {**seen, **dict.fromkeys(self.held, "held")}

    def material(self, *, density: float = 1000.0) -> Material:
        """ValueError where there is no answer."""
        if self.status is FitStatus.NO_ANSWER:
            raise ValueError(
                f"{self.parametrisation.label}: no answer at the measured points, nothing fitted"
            )
        return self.parametrisation.material(self.u, density=density)


@dataclass(eq=False)
class _Counted:
    """Residuals of the free coordinates, prior rows last; counts its calls."""

    model: HomogeneousModel
    base: Array
    free: NDArray[np.intp]
    calls: int = field(default=0)

    def full(self, x: Array) -> Array:
        u = self.base.copy()
        u[self.free] = x
        return u

    def __call__(self, x: Array) -> Array:
        self.calls += 1
        with np.errstate(over="ignore", invalid="ignore"):
            return self.model.residuals([State(u=self.full(x))])[0]


def fit_coupons(
    parametrisation: Parametrisation,
    coupons: Sequence[CouponTrial],
    *,
    starts: int = 6,
    evolution: int | None = None,
    seed: int = 0,
    held: Mapping[str, float] | None = None,
) -> CouponFit:
    """Fit a law to homogeneous tests of one material: chi-square plus the parametrisation's priors.

    What is compared, and by which errors, is what a diagnosis compares (`HomogeneousModel`).

    Parameters
    ----------
    parametrisation : the law in search coordinates.
    coupons : the tests.
    starts : local searches (bounded trust-region least squares): the parametrisation's start, then draws.
    evolution : evaluations spent on CMA-ES first, its best point being one more start; by default 4000 for
        laws with two exponents or more (Ogden-2, -3), whose cost has many basins, else none.
    held : coordinates fixed at a value (SI), by name; they enter the covariance by their prior. By default
        bulk_ratio at its prior's centre: a stress does not see it, and where the law is wrong the fit would
        move it to repair the curve. {} fits everything.

    Raises
    ------
    ValueError : there are no coupons, they are of several materials, or a held name is none of the law's.
    """
    if not coupons:
        raise ValueError("expected at least one coupon")
    materials = dict.fromkeys(t.material for t in coupons)
    if len(materials) > 1:
        raise ValueError(f"expected coupons of one material, got {', '.join(materials)}")
    held = _bulk_ratio(parametrisation) if held is None else dict(held)
    if unknown := sorted(set(held) - set(parametrisation.names)):
        raise ValueError(f"{parametrisation.label}: has no coordinate {', '.join(unknown)}")
    names = parametrisation.names
    model = _model(parametrisation, coupons)
    base = parametrisation.start(shear=_nearest_modulus(model.records))
    for name, value in held.items():
        base[names.index(name)] = parametrisation.coordinates[names.index(name)].inside(value)
    free = np.array([i for i, name in enumerate(names) if name not in held])
    residuals = _Counted(model, base, free)
    bounds = parametrisation.bounds[free]
    rng = np.random.default_rng(seed)
    points = [base[free], *(_draw(parametrisation, base, free, rng) for _ in range(starts - 1))]
    if evolution is None:
        evolution = 4000 if sum(n.startswith("alpha") for n in names) > 1 else 0
    if evolution:
        points.append(_evolve(residuals, points[0], bounds, evolution, seed))
    ends = [_descend(residuals, np.clip(p, bounds[:, 0], bounds[:, 1]), bounds) for p in points]
    good = [end for end in ends if end is not None]
    nothing = CouponFit(
        parametrisation=parametrisation,
        records=tuple(model.records),
        status=FitStatus.NO_ANSWER,
        u=np.full(len(names), np.nan),
        chi2=np.nan,
        points=model.points,
        starts=len(points),
        reached=0,
        unanswered=len(points) - len(good),
        evaluations=residuals.calls,
        held=tuple(held),
    )
    if not good:
        return nothing
    cost, x, converged = min(good, key=lambda end: end[0])
    u = residuals.full(x)
    chi2 = float((residuals(x)[: model.points] ** 2).sum())
    everything = _Counted(model, u, np.arange(len(u)))
    jacobian = _jacobian(everything, u, everything(u), parametrisation.bounds, 1e-4)
    return replace(
        nothing,
        status=FitStatus.CONVERGED if converged else FitStatus.NOT_CONVERGED,
        u=u,
        chi2=chi2,
        reached=sum(end[0] <= _SAME * cost + 1e-9 for end in good),
        evaluations=residuals.calls + everything.calls,
        identification=identify(
            parametrisation, u, jacobian, reduced_chi2=chi2 / max(1, model.points - len(free))
        ),
    )


def _bulk_ratio(parametrisation: Parametrisation) -> dict[str, float]:
    return {c.name: c.start for c in parametrisation.coordinates if c.name == "bulk_ratio" and c.start}


def _model(parametrisation: Parametrisation, coupons: Sequence[CouponTrial]) -> HomogeneousModel:
    """Of these tests alone."""
    experiment = Experiment(
        name="coupons",
        folder=Path(),
        notes="",
        materials={t.material: MaterialBelief(name=t.material) for t in coupons},
        trials=tuple(coupons),
        digest="",
    )
    return HomogeneousModel(experiment, baseline=Baseline.of_law(coupons, parametrisation))


def _nearest_modulus(records: Sequence[Record]) -> float:
    """Shear modulus [Pa] of the incompressible neo-Hookean curve nearest to the data, whitened."""
    top = bottom = 0.0
    for r in records:
        unit = stress_of(r.mode, r.stretch, 0.5) / r.sd
        top += float(unit @ (r.stress / r.sd))
        bottom += float(unit @ unit)
    return max(top / bottom, 100.0) if bottom > 0.0 else 1e5


def _draw(p: Parametrisation, base: Array, free: NDArray[np.intp], rng: np.random.Generator) -> Array:
    """Logarithms about the start with sd 1, other coordinates anywhere between their bounds."""
    u = base.copy()
    for i, c in enumerate(p.coordinates):
        low, high = p.bounds[i]
        u[i] = np.clip(rng.normal(u[i], 1.0), low, high) if c.log else rng.uniform(low, high)
    return u[free]


def _evolve(residuals: _Counted, start: Array, bounds: Array, evaluations: int, seed: int) -> Array:
    """CMA-ES in the unit box."""
    import cma  # imported when needed: it takes a second with the plotting it brings along

    low, span = bounds[:, 0], bounds[:, 1] - bounds[:, 0]
    options = {
        "bounds": [0.0, 1.0],
        "seed": seed + 1,  # 0 means the clock to cma
        "maxfevals": evaluations,
        "popsize": 4 + 4 * len(start),
        "verbose": -9,
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # cma warns of flat regions, which the local search then reports
        strategy = cma.CMAEvolutionStrategy((start - low) / span, 0.15, options)
        while not strategy.stop():
            asked = strategy.ask()
            costs = [float((residuals(low + span * np.asarray(x)) ** 2).sum()) for x in asked]
            strategy.tell(asked, [c if np.isfinite(c) else _BAD for c in costs])
    best = strategy.result.xbest
    return start if best is None else low + span * np.asarray(best)


def _descend(residuals: Residuals, start: Array, bounds: Array) -> tuple[float, Array, bool] | None:
    """(chi-square with priors, x, converged); None where the start has no answer."""
    inside = 1e-6 * (bounds[:, 1] - bounds[:, 0])
    x = np.clip(start, bounds[:, 0] + inside, bounds[:, 1] - inside)
    if not np.isfinite(residuals(x)).all():
        return None

    def jacobian(at: Array) -> Array:
        return _jacobian(residuals, at, residuals(at), bounds, 1e-6)

    found = least_squares(residuals, x, jac=jacobian, bounds=(bounds[:, 0], bounds[:, 1]), max_nfev=150)
    return 2.0 * float(found.cost), np.asarray(found.x), found.status > 0


def _jacobian(residuals: Residuals, x: Array, here: Array, bounds: Array, step: float) -> Array:
    """One-sided differences, inwards at a bound, to the other side where the first has no answer; 0 where
    neither side has one."""
    columns = np.zeros((len(here), len(x)))
    for i in range(len(x)):
        h = step if x[i] + step <= bounds[i, 1] else -step
        for change in (h, -h):
            moved = x.copy()
            moved[i] += change
            there = residuals(moved)
            if np.isfinite(there).all():
                columns[:, i] = (there - here) / change
                break
    return columns
