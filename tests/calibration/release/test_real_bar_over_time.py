"""A small part of `studies/release/over_time.py`, if the measured Dragon Skin beam is available."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studies.release.over_time import compared, experiment_of, least_squares_of, measured, swings

ROOT = Path(__file__).resolve().parents[3]
MEASURED = Path(os.environ.get("TISIM_MEASURED") or ROOT.parent / "shared" / "measured")
FOLDER = MEASURED / "real" / "clamped-beam-dragonskin10" / "experiment"

pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="no measured bar: set TISIM_MEASURED to the folder that holds real/"
)


def test_one_spectrum_for_a_run_of_each_load() -> None:
    """With the reduced beam only. The frequency with 52 g is a prediction: its vibration is not fitted."""
    whole = experiment_of(FOLDER)
    experiment = replace(whole, trials=tuple(t for t in whole.trials if t.id in ("gravity-a", "load52-a")))
    _, objective = measured(experiment)
    objective.model.fem = False
    light, loaded = compared(objective.model, least_squares_of(objective))
    for run in (light, loaded):
        assert run.predicted.drop - run.held == pytest.approx(run.measured.drop, rel=0.03)
        assert run.predicted.ring.frequency == pytest.approx(run.measured.ring.frequency, rel=0.03)
        assert abs(run.held) < 0.8
    assert light.predicted.ring.damping_ratio == pytest.approx(light.measured.ring.damping_ratio, rel=0.03)


def test_what_hangs_rubs() -> None:
    """With 52 g, and only then, the damping ratio increases as the motion decays, as with dry friction.

    No linear material behaves so.
    """
    for name, rows in swings(experiment_of(FOLDER)):
        ratios = np.array([ratio for _, _, ratio in rows])
        grown = ratios[3:].mean() / ratios[:2].mean()
        assert grown > 1.5 if name.startswith("load52") else grown < 1.05, (name, ratios)
