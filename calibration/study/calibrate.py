"""One calibration: scan for a start, CMA-ES, Gauss-Newton polish, certainty, held-out check."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import psutil
from numpy.typing import NDArray

from calibration.outlines import OutlineObjective
from calibration.parameters import Parametrisation
from calibration.search import (
    CmaOptions,
    Generation,
    Polished,
    Problem,
    guess,
    identify,
    polish,
    profile,
    search,
)
from calibration.study.calibration import Calibration, Status
from calibration.study.heldout import held_out
from calibration.study.measurements import Measurements

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FitOptions:
    """cma: of the search; gauss_newton: whether it is polished (without, there are no error bars);
    leave_one_out: whether each beam is predicted from the others."""

    cma: CmaOptions = field(default_factory=CmaOptions)
    gauss_newton: bool = True
    leave_one_out: bool = True


def calibrate(
    parametrisation: Parametrisation,
    data: Measurements,
    *,
    options: FitOptions | None = None,
    history: Sequence[Generation] = (),
    told: Callable[[Generation], None] = lambda _: None,
) -> Calibration:
    """Fit one law to one material's measurements.

    A law without equilibrium, or a search that does not converge, is a status of the result, no exception.
    """
    options = options or FitOptions()
    if data.outlines is None:
        parametrisation = parametrisation.holding("bulk_ratio")
    wall, begun = time.perf_counter(), _core_seconds()
    none = Calibration(
        material=data.material,
        law=parametrisation.law,
        label=parametrisation.label,
        status="no equilibrium",
        message="no shear modulus between 1 kPa and 10 MPa has an answer for all trials",
        density=data.density,
    )
    problem = Problem(parametrisation=parametrisation, objectives=data.objectives)
    start = _start(problem, data)
    if start is None or not problem.linearise(start):
        return replace(none, wall_seconds=time.perf_counter() - wall, search_seconds=_core_seconds() - begun)
    found = search(
        problem,
        start=start,
        spread=parametrisation.spread,
        options=options.cma,
        history=history,
        told=told,
    )
    searched = _core_seconds()
    counts = {
        "candidates": found.evaluations,
        "generations": found.generations,
        "without_answer": found.without_answer,
        "search_reason": found.reason,
        "search_seconds": searched - begun,
    }
    if not np.isfinite(found.cost):
        return replace(
            none,
            message=f"none of {found.evaluations} candidates has an answer for all trials",
            wall_seconds=time.perf_counter() - wall,
            **counts,  # type: ignore[arg-type]
        )
    status: Status = "converged" if found.reason.startswith("converged") else "not converged"
    message = "" if status == "converged" else f"CMA-ES ended after {found.reason}"
    best = _point(problem, data, found.u, status=status, message=message)
    if options.gauss_newton:
        best = _polished(problem, data, found.u, best, options)
    return replace(
        best,
        polish_seconds=_core_seconds() - searched,
        wall_seconds=time.perf_counter() - wall,
        **counts,  # type: ignore[arg-type]
    )


def best_so_far(
    parametrisation: Parametrisation, data: Measurements, generations: Sequence[Generation]
) -> Calibration:
    """The best candidate of an unfinished search, as a calibration with status "stopped"."""
    costs = np.array([g.costs.min() for g in generations])
    g = generations[int(costs.argmin())]
    u = g.candidates[g.costs.argmin()]
    if data.outlines is None:
        parametrisation = parametrisation.holding("bulk_ratio")
    problem = Problem(parametrisation=parametrisation, objectives=data.objectives)
    if not problem.linearise(u):
        raise ValueError("the best candidate so far has no answer any more")
    message = f"stopped after {len(generations)} generations: no polish, mesh correction or error bars"
    return replace(
        _point(problem, data, u, status="stopped", message=message),
        candidates=sum(len(g.costs) for g in generations),
        generations=len(generations),
        without_answer=int(sum(np.isinf(g.costs).sum() for g in generations)),
    )


def _start(problem: Problem, data: Measurements) -> Array | None:
    """A scan needs no mesh correction, which costs more than all of it."""
    outlines = data.outlines
    if outlines is None:
        return guess(problem)
    reference, outlines.reference = outlines.reference, None
    try:
        return guess(problem)
    finally:
        outlines.reference = reference


def _polished(
    problem: Problem, data: Measurements, u: Array, best: Calibration, options: FitOptions
) -> Calibration:
    try:
        end = polish(problem, u)
    except ValueError as error:
        return replace(best, status="not converged", message=f"polish: {error}")
    # the polish has the last word: a search that ran out of generations did its part if this converges
    status: Status = "converged" if end.converged else "not converged"
    message = "" if end.converged else f"polish: {end.message}"
    fitted = _point(problem, data, end.u, status=status, message=message, residuals=end.residuals)
    fitted = _certain(problem, fitted, end)
    if options.leave_one_out and data.outlines is not None:
        checks, note = held_out(problem, data.outlines, end.u)
        fitted = replace(fitted, held_out=checks, held_out_note=note)
    return fitted


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
    if isinstance(data.outlines, OutlineObjective):
        rms, nuisances = data.outlines.summary(p.material(u))
    if data.pokes is not None:
        nuisances = {**nuisances, **data.pokes.summary(p.material(u))[1]}
    return Calibration(
        material=data.material,
        law=p.law,
        label=p.label,
        status=status,
        message=message,
        density=data.density,
        u=tuple(float(x) for x in u),
        parameters=p.parameters(u),
        shear_modulus=moduli.shear,
        bulk_modulus=moduli.bulk,
        chi2=chi2,
        points=problem.points,
        reduced_chi2=chi2 / max(1, problem.points - len(u)),
        rms=rms,
        nuisances=nuisances,
        note=_note(data),
    )


def _note(data: Measurements) -> str:
    """What the reader of the result must know beyond its status."""
    notes = [data.outlines.uncorrected] if data.outlines is not None else []
    notes += data.pokes.shortfalls if data.pokes is not None else []
    return "; ".join(n for n in notes if n)


def _certain(problem: Problem, fitted: Calibration, end: Polished) -> Calibration:
    known = identify(problem.parametrisation, end.u, end.jacobian, reduced_chi2=fitted.reduced_chi2)
    return replace(
        fitted,
        estimates=profile(problem, end, known),
        blind=known.blind,
        shear_modulus_sd=known.shear_modulus_sd,
    )


def _core_seconds() -> float:
    """CPU time of this process and of the workers that solve for it [s]."""
    seconds = time.process_time()
    for worker in psutil.Process().children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            spent = worker.cpu_times()
            seconds += spent.user + spent.system
    return seconds
