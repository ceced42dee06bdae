"""`python -m calibration.fit --objective dice` on a cantilever made by the elastica."""

from __future__ import annotations

import json

import pytest
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from planar_elastica import edges
from typer.testing import CliRunner

from calibration.fit import app

RUNNER = CliRunner()
SHEAR, RATIO = 500e3, 1000.0


@pytest.fixture
def folder(tmp_path):
    """A beam of 6 mm diameter and 100 mm length that sags by a third of its length."""
    young = 9 * RATIO / (3 * RATIO + 1) * SHEAR
    upper, lower = edges(young=young, density=1000.0, length=0.1, radius=0.003)
    entry = beam_entry(
        "slender",
        section={"circle": {"radius_mm": 3.0, "radius_sd_mm": 0.02}},
        captures=[capture_entry(60.0, "beams/slender.csv")],
    )
    tables = {"beams/slender.csv": outline_columns(1e3 * upper, 1e3 * lower)}
    return write_experiment(tmp_path / "made", [entry], tables=tables)


def test_unknown_objective_is_refused(folder, tmp_path):
    out = tmp_path / "out"
    found = RUNNER.invoke(app, [str(folder), "--objective", "overlap", "--out", str(out)])
    assert found.exit_code == 2
    assert "--objective overlap: expected likelihood or dice" in found.output
    assert not out.exists()


@pytest.mark.slow
def test_fit_to_dice_is_marked_as_one_and_not_gone_on_with_as_another(folder, tmp_path):
    out = tmp_path / "out"
    arguments = [str(folder), "--model", "neo-hookean", "--out", str(out), "--workers", "1"]
    found = RUNNER.invoke(app, [*arguments, "--objective", "dice"])
    assert found.exit_code == 0, found.output
    fit = json.loads((out / "fits" / "S0-neo-hookean.json").read_text(encoding="utf-8"))["calibration"]
    assert fit["objective"] == "dice"
    assert fit["estimates"] == []  # no error bars without a likelihood
    assert fit["shear_modulus"] == pytest.approx(SHEAR, rel=0.015)
    assert "mean Dice 0.9" in (out / "cards" / "S0.yaml").read_text(encoding="utf-8")
    again = RUNNER.invoke(app, arguments)
    assert again.exit_code == 2
    assert "made with another" in again.output
    assert "objective" in again.output
