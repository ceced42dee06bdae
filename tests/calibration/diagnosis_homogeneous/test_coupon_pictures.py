"""The first figure of a page: curves if the lack of fit is visible between them, else the residuals."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis_coupon_cases import Array, coupon_model, experiment, neo_hookean, ramps, trial

from calibration.diagnosis.drawing import figures_of
from calibration.diagnosis.engine.run import diagnose


@pytest.mark.parametrize(("size", "first"), [(0.6, "curves"), (0.02, "residuals")])
def test_the_first_picture_shows_the_departure(size: float, first: str) -> None:
    def stress(mode: str, s: Array) -> Array:
        return neo_hookean(mode, s) * (1.0 + size * (s - 1.0))

    made = experiment(trial("pull", "uniaxial", ramps(2.0, 1, 30), stress, sd=100.0))
    model = coupon_model(made)
    figures = figures_of(model, diagnose(model, gain=False))
    shown = [f.name for f in figures if f.section == "shapes"]
    assert shown[0] == first
    assert {f.name for f in figures} == {"curves", "residuals", "rms"}
    assert all(np.isfinite(f.figure.get_size_inches()).all() for f in figures)
