"""Fit of a law to homogeneous tests: multi-start least squares, after CMA-ES if the cost is multimodal."""

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

_SAME = 1.01  # a start whose cost is within this factor of the best has reached the best
_BAD = 1e30  # cost in CMA-ES of a point without a solution


class FitStatus(StrEnum):
    """Outcome of a fit."""

    CONVERGED = "converged"
    NOT_CONVERGED = "not-converged"  # the best start reached the limit of evaluations
    NO_ANSWER = "no-answer"  # at every start the law lacks a stress at some measured point


@dataclass(frozen=True, eq=False, kw_only=True)
class CouponFit:
    """Result of a fit: the best of all starts.

    Attributes
    ----------
    parametrisation : the law in search coordinates.
    records : points as compared (for long records, means of neighbours).
    status : outcome of the best start.
    u : search coordinates, shape (n,); NaN without a solution.
    chi2 : chi-square of the points, without priors.
    points : number of points.
    starts, reached, unanswered : number of starts, of those that reached the best cost (within 1 %), and of
        those at which the law had no solution.
    evaluations : number of evaluations of the law on all curves.
    held : names of the coordinates that were fixed.
    identification : covariance and identifiability; None without a solution. If the law misfits, errors of
        neighbouring points are correlated and the intervals are too narrow, though scaled by chi-square.
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
        """Coordinates that the data do not determine, by name.

        Values: "held", "not identified", "at a bound", or "weak" if the interval is too wide for one figure.
        """
        if self.identification is None:
            return {}
        seen = {e.name: e.seen for e in self.identification.estimates if e.seen != "identified"}
        return {**seen, **dict.fromkeys(self.held, "held")}

    def material(self, *, density: float = 1000.0) -> Material:
        """The fitted material; ValueError if there is no solution. density : [kg/m3]."""
        if self.status is FitStatus.NO_ANSWER:
            raise ValueError(
                f"{self.parametrisation.label}: no answer at the measured points, nothing fitted"
            )
        return self.parametrisation.material(self.u, density=density)


@dataclass(eq=False)
class _Counted:
    """Residuals as a function of the free coordinates, prior rows last; counts its calls."""

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
    """Fit a law to homogeneous tests of one material: minimise chi-square plus the parametrisation's priors.

    Points and errors are those of a diagnosis (`HomogeneousModel`).

    Parameters
    ----------
    parametrisation : the law in search coordinates.
    coupons : the tests.
    starts : number of local searches (bounded trust-region least squares): one from the parametrisation's
        start, the others from random draws.
    evolution : number of evaluations of a preceding CMA-ES search, whose best point is one more start; by
        default 4000 for laws with two or more exponents (Ogden-2, -3), whose cost has many local minima,
        else 0.
    seed : of the random draws and of CMA-ES.
    held : fixed coordinates (SI) by name; they enter the covariance by their prior. By default bulk_ratio is
        fixed at its start value, since the stress is insensitive to it and a fit of a wrong law would use it
        to compensate misfit. {} fits all coordinates.

    Raises
    ------
    ValueError
        If there are no coupons, they are of several materials, or a held name is not a coordinate of the law.
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
    """Model of these tests alone."""
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
    """Shear modulus [Pa] of the best-fit incompressible neo-Hookean curve, at least 100 Pa."""
    top = bottom = 0.0
    for r in records:
        unit = stress_of(r.mode, r.stretch, 0.5) / r.sd
        top += float(unit @ (r.stress / r.sd))
        bottom += float(unit @ unit)
    return max(top / bottom, 100.0) if bottom > 0.0 else 1e5


def _draw(p: Parametrisation, base: Array, free: NDArray[np.intp], rng: np.random.Generator) -> Array:
    """Random start: logarithms normal about `base` with sd 1, other coordinates uniform within bounds."""
    u = base.copy()
    for i, c in enumerate(p.coordinates):
        low, high = p.bounds[i]
        u[i] = np.clip(rng.normal(u[i], 1.0), low, high) if c.log else rng.uniform(low, high)
    return u[free]


def _evolve(residuals: _Counted, start: Array, bounds: Array, evaluations: int, seed: int) -> Array:
    """Best point of CMA-ES in the box of the bounds, scaled to the unit cube."""
    import cma  # imported when needed: it takes a second, with the plotting that it imports

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
    """Local search: (chi-square with priors, x, converged); None if the start has no solution."""
    inside = 1e-6 * (bounds[:, 1] - bounds[:, 0])
    x = np.clip(start, bounds[:, 0] + inside, bounds[:, 1] - inside)
    if not np.isfinite(residuals(x)).all():
        return None

    def jacobian(at: Array) -> Array:
        return _jacobian(residuals, at, residuals(at), bounds, 1e-6)

    found = least_squares(residuals, x, jac=jacobian, bounds=(bounds[:, 0], bounds[:, 1]), max_nfev=150)
    return 2.0 * float(found.cost), np.asarray(found.x), found.status > 0


def _jacobian(residuals: Residuals, x: Array, here: Array, bounds: Array, step: float) -> Array:
    """Jacobian by one-sided differences, inwards at an upper bound.

    If the first side has no solution the other one is used; a column is 0 if neither side has one.
    """
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
