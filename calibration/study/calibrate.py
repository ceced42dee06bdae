"""One calibration: scan for a start, CMA-ES, Gauss-Newton polish, uncertainty."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import psutil
from numpy.typing import NDArray

from calibration._numerics import rms_of
from calibration.inference import (
    CmaOptions,
    Estimate,
    Generation,
    Objective,
    OfMaterial,
    Polished,
    Problem,
    between_specimens,
    guess,
    identify,
    polish,
    profile,
    search,
    with_prior_sd,
)
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines.dice import DiceObjective
from calibration.parameters import Parametrisation, implausible, part_entry
from calibration.study.assessment import (
    at_bounds,
    constants_lacking,
    off_prior,
    step_gains,
    undetermined_terms,
)
from calibration.study.calibration import Calibration, Status
from calibration.study.held_out import held_out
from calibration.study.measurements import Measurements

Array = NDArray[np.float64]

BULK = "bulk_ratio"


@dataclass(frozen=True, kw_only=True)
class FitOptions:
    """Options of a calibration.

    Attributes
    ----------
    cma : CmaOptions
        Options of the global search.
    gauss_newton : bool
        True to polish its result; without, there are no error bars.
    leave_one_out : bool
        True to predict each beam from the others.
    """

    cma: CmaOptions = field(default_factory=CmaOptions)
    gauss_newton: bool = True
    leave_one_out: bool = True


def calibrate(
    data: Measurements,
    *,
    options: FitOptions | None = None,
    history: Sequence[Generation] = (),
    on_progress: Callable[[Generation], None] = lambda _: None,
) -> Calibration:
    """Fit the law of a material's measurements to them.

    A law without equilibrium, a search that does not converge and a lack of fit are statuses of the result,
    no exceptions.

    Parameters
    ----------
    data : Measurements
    options : FitOptions, optional
    history : sequence of Generation
        Generations of an earlier run of the same search, which is continued.
    on_progress : callable
        Called with each `Generation`.
    """
    options = options or FitOptions()
    parametrisation = _searched(data)
    wall, begun = time.perf_counter(), _core_seconds()
    none = Calibration(
        material=data.material,
        law=parametrisation.law,
        label=parametrisation.label,
        status="no equilibrium",
        message="no shear modulus between 1 kPa and 10 MPa has an answer for all trials",
        density=data.density,
        **_parts(parametrisation),
    )
    problem = Problem(parametrisation=parametrisation, objectives=data.objectives)
    start = guess(problem)
    if start is None or not problem.linearise(start):
        return replace(none, wall_seconds=time.perf_counter() - wall, search_seconds=_core_seconds() - begun)
    descent = _descended(problem, start) if parametrisation.parts else None
    found = search(
        problem,
        start=start if descent is None else descent.u,
        spread=parametrisation.spread,
        options=options.cma,
        history=history,
        known=np.inf if descent is None else descent.cost,
        on_progress=on_progress,
    )
    searched = _core_seconds()
    counts = {
        "candidates": found.evaluations,
        "generations": found.generations,
        "without_answer": found.without_answer,
        "search_reason": found.reason,
        "search_seconds": searched - begun,
    }
    if descent is not None and descent.cost <= found.cost:
        found = replace(found, u=descent.u, cost=descent.cost)
    else:
        descent = None
    if not np.isfinite(found.cost):
        return replace(
            none,
            message=f"none of {found.evaluations} candidates has an answer for all trials",
            wall_seconds=time.perf_counter() - wall,
            **counts,  # type: ignore[arg-type]
        )
    status: Status = "converged" if found.reason.startswith("converged") else "not converged"
    message = "" if status == "converged" else f"CMA-ES ended after {found.reason}"
    u = found.u
    best = _point(problem, data, u, status=status, message=message)
    if options.gauss_newton:
        done = descent if descent is not None and descent.converged else None
        best = _polished(problem, data, u, best, options, done)
    else:
        bounds = at_bounds(parametrisation, u)
        best = replace(best, unsettled=tuple(bounds)).assessed(constants_lacking(parametrisation, u))
    return replace(
        best,
        polish_seconds=_core_seconds() - searched,
        wall_seconds=time.perf_counter() - wall,
        **counts,  # type: ignore[arg-type]
    )


def best_so_far(data: Measurements, generations: Sequence[Generation]) -> Calibration | None:
    """The best candidate of an unfinished search, as a calibration with status "stopped".

    None if it has no answer any more: the search may have had one from a mesh or a step that differs.
    """
    costs = np.array([g.costs.min() for g in generations])
    g = generations[int(costs.argmin())]
    u = g.candidates[g.costs.argmin()]
    problem = Problem(parametrisation=_searched(data), objectives=data.objectives)
    if not problem.linearise(u, rough=True):
        return None
    message = f"stopped after {len(generations)} generations: no polish, mesh correction or error bars"
    return replace(
        _point(problem, data, u, status="stopped", message=message),
        candidates=sum(len(g.costs) for g in generations),
        generations=len(generations),
        without_answer=int(sum(np.isinf(g.costs).sum() for g in generations)),
    )


def _searched(data: Measurements) -> Parametrisation:
    """The law as it is searched: K/G is held, unless photographs, which alone see it, are to find it."""
    return data.law if data.free_bulk_ratio and data.outlines is not None else data.law.holding(BULK)


def _descended(problem: Problem, start: Array) -> Polished | None:
    """Result of Gauss-Newton from a start; None where it fails. Relaxation times and fractions make long
    curved valleys, along which a random search gets nowhere."""
    try:
        return polish(problem, start)
    except ValueError:
        return None


def _polished(
    problem: Problem,
    data: Measurements,
    u: Array,
    best: Calibration,
    options: FitOptions,
    done: Polished | None,
) -> Calibration:
    """The calibration `best`, polished from u and with error bars.

    done : result of a polish that ended at u already; None to polish here.
    """
    try:
        end = done or polish(problem, u)
    except ValueError as error:
        return replace(best, status="not converged", message=f"polish: {error}")
    free = problem.parametrisation
    lacking = constants_lacking(free, end.u, step_gains(end.residuals, end.jacobian))
    wrong = {*at_bounds(free, end.u), *off_prior(free, end.u)}
    if BULK in wrong:
        problem, end = _bulk_held(problem, end)
    # the polish has the last word: a search that ran out of generations did its part if this converges
    status: Status = "converged" if end.converged else "not converged"
    message = "" if end.converged else f"polish: {end.message}"
    fitted = _point(problem, data, end.u, status=status, message=message, residuals=end.residuals)
    seen = data.outlines is not None
    fitted = replace(_certain(problem, fitted, end, bulk_seen=seen), unsettled=_unsettled(problem, end))
    if not end.converged:
        terms = undetermined_terms(fitted.law, fitted.terms, fitted.estimates)
        fitted = replace(fitted, message="; ".join(filter(None, (terms, message))))
    if options.leave_one_out and data.outlines is not None:
        checks, note = held_out(problem, data.outlines, end.u)
        fitted = replace(fitted, held_out=checks, held_out_note=note)
    return fitted.assessed(lacking)


def _bulk_held(problem: Problem, end: Polished) -> tuple[Problem, Polished]:
    """The problem with K/G held at its prior's centre, polished from `end`; as given where that fails.

    Photographs hardly see K/G. Where a fit drives it to its bound, or away from all that is known of rubbers,
    it repairs with it what the law or the rig lacks, and takes the shear modulus along.
    """
    held = replace(problem, parametrisation=problem.parametrisation.holding(BULK))
    centre, _ = held.parametrisation.prior()
    i = held.parametrisation.names.index(BULK)
    start = end.u.copy()
    start[i] = centre[i]
    try:
        return held, polish(held, start)
    except ValueError:
        problem.linearise(end.u)
        return problem, end


def _unsettled(problem: Problem, end: Polished) -> tuple[str, ...]:
    return tuple(at_bounds(problem.parametrisation, end.u, step_gains(end.residuals, end.jacobian)))


def _point(
    problem: Problem,
    data: Measurements,
    u: Array,
    *,
    status: Status,
    message: str,
    residuals: Array | None = None,
) -> Calibration:
    """A calibration at u, without error bars."""
    p = problem.parametrisation
    moduli = p.moduli(u)
    if residuals is None:
        residuals = problem.residuals(u[None])[0]
    prior = problem.prior_residuals(u[None])[0]
    chi2 = float(residuals @ residuals - prior @ prior)
    rms: float | None = None
    nuisances: dict[str, float] = {}
    if isinstance(data.outlines, ModelObjective):
        rms = rms_of(s.left for s in data.outlines.model.seen(data.outlines.state(u)))
    for o in problem.objectives:
        if isinstance(o, ModelObjective):
            nuisances = {**nuisances, **o.nuisances(u)}
    found = Calibration(
        material=data.material,
        law=p.law,
        label=p.label,
        status=status,
        message=message,
        density=data.density,
        u=tuple(float(x) for x in u),
        held_coordinates=sum(c.held for c in p.coordinates),
        parameters=p.parameters(u),
        shear_modulus=moduli.shear_modulus,
        bulk_modulus=moduli.bulk_modulus,
        chi2=chi2,
        points=problem.points,
        noise_freedom=_noise_freedom(data.objectives),
        rms=rms,
        nuisances=nuisances,
        note="; ".join(n for n in (_note(data, moduli.shear_modulus), *p.remarks(u)) if n),
        **_parts(p),
        objective="dice" if any(_is_dice(o) for o in data.objectives) else "likelihood",
    )
    return replace(found, reduced_chi2=chi2 / found.freedom)


def _noise_freedom(objectives: Sequence[Objective]) -> float | None:
    """Degrees of freedom of the noise of all objectives, each weighted by its fraction of the points.

    None if all of it is stated.
    """
    models = [o.model for o in objectives if isinstance(o, ModelObjective)]
    doubt = sum(m.points**2 / m.noise_freedom() for m in models)
    return float(sum(o.points for o in objectives) ** 2 / doubt) if doubt else None


def _parts(p: Parametrisation) -> dict[str, Any]:
    """Attributes of a `Calibration` that say what the material has beside the law."""
    if not p.parts:
        return {}
    values: dict[str, float] = {}
    return {
        "parts": tuple(part.spec for part in p.parts if part.spec),
        "held": {part.field: part_entry(part.assembled(values)) for part in p.parts if not part.spec},
        "protocol": asdict(p.parts[0].window),
    }


def _is_dice(objective: Objective) -> bool:
    return isinstance(objective, OfMaterial) and isinstance(objective.objective, DiceObjective)


def _note(data: Measurements, shear_modulus: float) -> str:
    """Notes for the reader of the result, beyond its status."""
    notes = [note for o in data.objectives if isinstance(o, ModelObjective) for note in o.shortcomings()]
    notes.append(implausible(shear_modulus))
    return "; ".join(n for n in notes if n)


def _certain(problem: Problem, fitted: Calibration, end: Polished, *, bulk_seen: bool) -> Calibration:
    """The calibration `fitted` with error bars.

    bulk_seen : True if the other constants depend on a K/G that is held, and so on its uncertainty.
    """
    p = problem.parametrisation
    known = identify(p, end.u, end.jacobian, reduced_chi2=fitted.reduced_chi2)
    estimates = profile(problem, end, known)
    labels = [n for o in problem.objectives for n in _specimens(o)]
    labels += [""] * (len(end.residuals) - len(labels))
    scattered = between_specimens(known, p, end, labels)
    if scattered is not known:
        known = scattered
        estimates = _widest(estimates, known.estimates)
        count = len(set(labels) - {""})
        note = f"the {count} specimens differ by more than the noise: error bars are those of their mean"
        fitted = replace(fitted, note="; ".join(n for n in (fitted.note, note) if n))
    if bulk_seen and any(c.held for c in p.coordinates if c.name == BULK):
        known = with_prior_sd(known, p.believed(), end.u, BULK)
        estimates = _widest(estimates, known.estimates)
    return replace(
        fitted,
        estimates=estimates,
        blind=known.blind,
        covariance=tuple(tuple(float(c) for c in row) for row in known.of_intervals),
        shear_modulus_sd=known.shear_modulus_sd,
    )


def _specimens(objective: Objective) -> list[str]:
    """Specimen of each residual of an objective; "" where it is not known."""
    if isinstance(objective, ModelObjective):
        return objective.specimens()
    return [""] * objective.size()


def _widest(profiled: Sequence[Estimate], linear: Sequence[Estimate]) -> tuple[Estimate, ...]:
    """On each side the farther end of both intervals.

    In valleys that curve, or run along a bound, the profile's few Newton steps stop short of the least
    chi-square, and its ends come too early.
    """
    return tuple(
        replace(b, low=min(a.low, b.low), high=max(a.high, b.high))
        for a, b in zip(profiled, linear, strict=True)
    )


def _core_seconds() -> float:
    """CPU time of this process and of the workers that solve for it [s]."""
    seconds = time.process_time()
    for worker in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            spent = worker.cpu_times()
            seconds += spent.user + spent.system
    return seconds
