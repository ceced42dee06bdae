"""The measured Dragon Skin beam, if it is available: see studies/release."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from calibration.experiment import read
from calibration.measurements.release import Damping, MarkerObjective, Nuisances, ringdown
from calibration.parameters import parametrisation
from studies.release.fit import fit_motion

ROOT = Path(__file__).resolve().parents[3]
MEASURED = Path(os.environ.get("TISIM_MEASURED") or ROOT.parent / "shared" / "measured")
FOLDER = MEASURED / "real" / "clamped-beam-dragonskin10" / "experiment"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not FOLDER.is_dir(), reason="no measured bar: set TISIM_MEASURED to the folder that holds real/"
    ),
]


def test_modulus_of_the_settled_pose_and_frequency_of_another_trial():
    """Published static moduli are 267 to 298 kPa; the frequency requires a few per cent more stiffness."""
    experiment = read(FOLDER)
    trials = {t.id: t for t in experiment.trials}
    belief = experiment.materials["dragonskin10"]
    tip = ("tip1", "tip2", "tip3")
    still = MarkerObjective(trials["gravity-a"], belief, markers=tip, stages=("settled",), workers=1)
    fit = fit_motion(still, parametrisation("neo-hookean"), shear=80e3)
    ratio = fit.values["bulk_ratio"]
    assert 267e3 < 9.0 * ratio * fit.values["shear_modulus"] / (3.0 * ratio + 1.0) < 298e3
    other = MarkerObjective(
        trials["load52-a"],
        belief,
        markers=tip,
        window=1.6,
        workers=1,
        nuisances=Nuisances(position=0.0, frame=0.0),
    )
    assert other.tip_mass == pytest.approx(0.052, rel=1e-3)
    (match,) = other.matches([fit.material], [Damping(mass=1.0, stiffness=1.8e-3)])
    assert match is not None
    time = match.time[0] - match.release
    measured, predicted = (
        ringdown(time, 1e3 * np.mean([u[:, 2] for u in way], axis=0), last=1.5)
        for way in (match.measured, match.predicted)
    )
    assert predicted.frequency == pytest.approx(measured.frequency, rel=0.05)
    assert abs(predicted.frequency - measured.frequency) > 1e-3 * measured.frequency
