"""Cross-validation of a fit to photographs: each beam predicted from all other measurements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import rms_of
from calibration.inference import Problem, polish
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines.model import OutlineModel
from calibration.study.calibration import HeldOut

Array = NDArray[np.float64]


def held_out(
    problem: Problem, outlines: ModelObjective[OutlineModel], u: Array
) -> tuple[tuple[HeldOut, ...], str]:
    """Each beam predicted from all other measurements, the fit starting at u; and a note where that fails.

    Nuisances and mesh corrections stay as taken at u, so that this costs no reference solve.
    """
    others = tuple(o for o in problem.objectives if o is not outlines)
    trials = outlines.model.trials
    if len(trials) < 2 and not others:
        return (), "one beam alone: no length can be left out"
    checks, notes = [], []
    for i, trial in enumerate(trials):
        own = outlines.model.of_trial(i)
        objectives = (*others, outlines.subset(own, others=True)) if len(trials) > 1 else others
        part = Problem(parametrisation=problem.parametrisation, objectives=objectives)
        try:
            end = polish(part, u, settled=0.04)
        except ValueError as error:
            notes.append(f"{trial.id}: {error}")
            continue
        if not end.converged:
            notes.append(f"{trial.id}: {end.message}")
        alone = outlines.subset(own)
        residuals = alone.residuals(end.u[None])[0]
        if not np.isfinite(residuals).all():
            notes.append(f"{trial.id}: no equilibrium with the parameters of the others")
            continue
        seen = alone.model.seen(alone.state(end.u))
        checks.append(
            HeldOut(
                trial=trial.id,
                shear_modulus=problem.parametrisation.moduli(end.u).shear_modulus,
                rms_raw=rms_of(s.raw for s in seen),
                rms=rms_of(s.left for s in seen),
                reduced_chi2=float(residuals @ residuals) / alone.points,
            )
        )
    return tuple(checks), "; ".join(notes)
