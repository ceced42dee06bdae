"""An indentation and a homogeneous test of one material in one fit."""

from __future__ import annotations

import made_pokes as made
import numpy as np
import pytest

import tisim
from calibration.experiment.model import CouponTrial
from calibration.measurements._baseline import Baseline
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.indentation.model import IndentationModel
from calibration.measurements.objective import ModelObjective
from calibration.parameters import parametrisation
from calibration.study import FitOptions, calibrate
from calibration.study.measurements import Measurements

C10, C01 = 9e3, 3e3
LAW = parametrisation("mooney-rivlin")


def uniaxial(noise: float) -> CouponTrial:
    """Incompressible Mooney-Rivlin material in closed form: 2 (C10 + C01 / s) (s - s^-2)."""
    s = np.linspace(1.0, 1.8, 30)
    rng = np.random.default_rng(1)
    stress = 2 * (C10 + C01 / s) * (s - s**-2) + rng.normal(0.0, noise, s.shape)
    return CouponTrial(id="u", material="S1", mode="uniaxial", stretch=s, stress=stress, stress_sd=noise)


def poke() -> ModelObjective[IndentationModel]:
    """Indentation simulated by tisim on another mesh; the mesh of the fit is coarse."""
    truth = tisim.Material(law="mooney-rivlin", parameters={"c10": C10, "c01": C01, "bulk": 300 * 2 * 12e3})
    scene = tisim.Poke(
        material=truth,
        block=tisim.Block(size=(0.06, 0.06, 0.03)),
        depth=0.7e-3,
        frame_spacing=0.7e-4,
        refinement=0.8,
    )
    (result,) = tisim.simulate([scene], workers=1)
    assert result.ok
    rng = np.random.default_rng(2)
    force = result.rod_force[:, 2] + rng.normal(0.0, 3e-3, result.load.shape)
    trial = made.trial(np.r_[0.0, result.load], np.r_[0.0, force], force_sd=3e-3)
    model = IndentationModel(
        made.experiment(trial), baseline=Baseline.of_law([trial], LAW), refinement=0.75, workers=1
    )
    return ModelObjective(model, name="poke p1")


def test_a_poke_and_a_coupon_in_one_fit() -> None:
    """The fit converges, the modulus is within its interval, and curves are simulated a few times only."""
    pokes, trial = poke(), uniaxial(300.0)
    coupons = HomogeneousModel(made.experiment(trial), baseline=Baseline.of_law([trial], LAW))
    both = (ModelObjective(coupons, name="coupon u"), pokes)
    data = Measurements(material="S1", law=LAW, density=None, objectives=both, outlines=None, ignored=())
    fit = calibrate(data, options=FitOptions())
    assert fit.status == "converged", fit.message
    assert fit.points == 30 + 11
    assert 0.4 < fit.reduced_chi2 < 1.8
    assert abs(fit.shear_modulus - 24e3) < 2 * fit.shear_modulus_sd
    assert fit.shear_modulus_sd < 0.05 * 24e3
    assert fit.candidates > 100
    assert pokes.model.curves.simulated <= 11  # two meshes of the block, and three curves of a law each time


@pytest.mark.slow
def test_the_poke_alone_knows_the_modulus_and_no_shape() -> None:
    data = Measurements(material="S1", law=LAW, density=None, objectives=(poke(),), outlines=None, ignored=())
    fit = calibrate(data, options=FitOptions())
    assert fit.status == "converged", fit.message
    known = {e.name: e for e in fit.estimates}
    assert known["shear_modulus"].low < 24e3 < known["shear_modulus"].high
    assert known["second_share"].seen in ("not identified", "at a bound")
