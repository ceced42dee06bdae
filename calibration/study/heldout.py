"""Leave one beam out, predict it: what a calibration is worth on a length that it has not seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.outlines import OutlineObjective
from calibration.search import Objective, Problem, polish
from calibration.study.calibration import HeldOut

Array = NDArray[np.float64]


def held_out(problem: Problem, outlines: OutlineObjective, u: Array) -> tuple[tuple[HeldOut, ...], str]:
    """Each beam predicted from all other measurements, the fit starting at u; and a note where that fails.

    Nuisances and mesh corrections stay as taken at u, so that this costs no reference solve.
    """
    others: tuple[Objective, ...] = tuple(o for o in problem.objectives if o is not outlines)
    n = len(outlines.trials)
    if n < 2 and not others:
        return (), "one beam alone: no length can be left out"
    checks, notes = [], []
    for i, trial in enumerate(outlines.trials):
        rest = [k for k in range(n) if k != i]
        objectives = (*others, outlines.subset(rest)) if rest else others
        part = Problem(parametrisation=problem.parametrisation, objectives=objectives)
        try:
            end = polish(part, u, tolerance=0.002)
        except ValueError as error:
            notes.append(f"{trial.id}: {error}")
            continue
        if not end.converged:
            notes.append(f"{trial.id}: {end.message}")
        alone = outlines.subset([i])
        material = problem.parametrisation.material(end.u)
        residuals = alone.residuals([material])[0]
        if not np.isfinite(residuals).all():
            notes.append(f"{trial.id}: no equilibrium with the parameters of the others")
            continue
        raw, after = alone.distances_rms(material)
        checks.append(
            HeldOut(
                trial=trial.id,
                shear_modulus=problem.parametrisation.moduli(end.u).shear,
                rms_raw=raw,
                rms=after,
                reduced_chi2=float(residuals @ residuals) / alone.points,
            )
        )
    return tuple(checks), "; ".join(notes)
