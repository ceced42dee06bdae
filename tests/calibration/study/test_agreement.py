"""A fit and a diagnosis of one bench use one model: moduli agree to a tenth of the error bar.

The clean bench has one specimen per material, so that the diagnosis (one modulus per specimen) and the fit
(one per material) have the same moduli. Both hold K/G at 300 and use the neo-Hookean law.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from calibration.diagnosis.engine.search import fit_baseline
from calibration.experiment import read
from calibration.inference import Problem, identify, polish
from calibration.measurements.outlines.model import OutlineModel
from calibration.parameters import parametrisation
from calibration.study import measurements

CLEAN = Path(__file__).parents[3] / "datasets" / "measured" / "bench" / "clean"
LAW = parametrisation("neo-hookean").holding("bulk_ratio")


def fitted(material: str, begin: float) -> tuple[float, float, float]:
    """Shear modulus [Pa], its standard deviation and chi-square per point of the fit."""
    data = measurements(read(CLEAN), material, LAW, workers=1)
    problem = Problem(parametrisation=LAW, objectives=data.objectives)
    end = polish(problem, np.log([begin, 300.0]))
    assert end.converged
    known = identify(LAW, end.u, end.jacobian, reduced_chi2=1.0)
    prior = problem.prior_residuals(end.u[None])[0]
    chi2 = (end.cost - prior @ prior) / problem.points
    return LAW.moduli(end.u).shear_modulus, known.shear_modulus_sd, chi2


def diagnosed(materials: list[str]) -> tuple[dict[str, float], float]:
    """Shear moduli [Pa] and chi-square per point of the baseline of a diagnosis."""
    experiment = read(CLEAN)
    some = replace(experiment, trials=tuple(t for t in experiment.trials if t.material in materials))
    model = OutlineModel(some, workers=1)
    found = fit_baseline(model)
    assert found.converged
    return model.shear_moduli(found.state.u), found.chi2 / model.points


def test_one_material() -> None:
    material, begin = "S0", 28e3
    moduli, chi2 = diagnosed([material])
    own, sd, reduced = fitted(material, begin)
    assert abs(own - moduli[material]) < 0.1 * sd, (own, moduli, sd)
    assert reduced == pytest.approx(chi2, rel=1e-3)


@pytest.mark.slow
def test_all_materials_of_the_clean_bench() -> None:
    """The diagnosis of all materials at once, like the command's."""
    truth = yaml.safe_load((CLEAN / "truth.yaml").read_text(encoding="utf-8"))["shear_modulus_Pa"]
    moduli, _ = diagnosed([*truth])
    for material, other in moduli.items():
        own, sd, _ = fitted(material, 1.1 * truth[material])
        assert abs(own - other) < 0.1 * sd, (material, own, other, sd)
        assert abs(own - truth[material]) < 2.0 * sd
