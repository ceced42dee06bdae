"""The measured benches: beams of another solver. Only this file reads the truth.

The diagnosis reads a copy without the truth.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _folders import measured

from calibration.diagnosis import diagnose, model_of
from calibration.experiment import read

# names and units of the benches' truth (their README) -> those of calibration
NAMES = {
    "residual_curvature": ("residual-curvature", "curvature_per_m", 1.0),
    "eff_length": ("grip-length", "depth_mm", 1e3),
    "creep": ("creep", "per_decade", 1.0),
    "stiffening": ("strain-stiffening", "c2_over_c1", 1.0),
}


def diagnosed(name: str, folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Content of diagnosis.json, and the truth."""
    bench = measured() / "bench" / name
    if not bench.is_dir():
        pytest.skip(f"no bench {name} among the measured experiments")
    truth = yaml.safe_load((bench / "truth.yaml").read_text(encoding="utf-8"))
    seen = folder / "experiment"
    shutil.copytree(bench, seen, ignore=shutil.ignore_patterns("truth.yaml"))
    found = diagnose(model_of(read(seen)))
    return json.loads(json.dumps(found.to_json(), allow_nan=False)), truth


def check_moduli(found: dict[str, float], truth: dict[str, Any]) -> None:
    """Assert that the moduli are within 2 % of the truth.

    A beam determines the ratio of weight to stiffness, and the density is known to half a percent.
    """
    for name, shear in truth["shear_modulus_Pa"].items():
        assert found[name] == pytest.approx(shear, rel=0.02), name


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bent-in-the-mould", "creeps", "grips-short", "stiffens"])
def test_what_was_put_into_a_bench_is_found(name: str, tmp_path: Path) -> None:
    found, truth = diagnosed(name, tmp_path)
    ((key, value),) = truth["effects"].items()
    effect, parameter, per_unit = NAMES[key]
    assert found["verdict"] == "found", found["alternatives"]
    (cause,) = found["causes"]
    assert cause["effect"] == effect
    assert cause["scope"] == "all"
    said = cause["parameters"][parameter]
    assert abs(said["value"] - per_unit * value) < 3.5 * said["sd"]
    check_moduli(found["extended"]["shear_modulus_Pa"], truth)
    assert found["baseline"]["p_value"] < 0.005 < found["extended"]["p_value"]
    gain = found["gain"]
    assert gain["rms_mm_after"] < gain["rms_mm_before"]
    assert gain["log_likelihood"] > 0.0


@pytest.mark.slow
def test_a_clean_bench_has_no_cause(tmp_path: Path) -> None:
    found, truth = diagnosed("clean", tmp_path)
    assert truth["effects"] == {}
    assert found["verdict"] == "none"
    assert found["causes"] == []
    check_moduli(found["baseline"]["shear_modulus_Pa"], truth)
    assert found["baseline"]["p_value"] > 0.005
    assert any(entry["effect"] == "density" for entry in found["not_visible"])
    assert np.isfinite(found["seconds"])
