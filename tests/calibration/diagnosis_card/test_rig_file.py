"""rig.yaml: its valid content, and its influence on a beam and its image."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from card_cases import bench, rig_effect, rig_file

import tisim
from calibration.diagnosis.rig import Rig, read_rig
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment

TILT = rig_effect("clamp-tilt", "angle_deg", 2.0, 0.2)
DEPTH = rig_effect("grip-length", "depth_mm", 1.5, 0.1, scope="S1")
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=10e3, bulk_modulus=3e6)


def trial(experiment: Experiment, name: str) -> BeamTrial:
    found = next(t for t in experiment.trials if t.id == name)
    assert isinstance(found, BeamTrial)
    return found


def test_effects_reach_the_scenes_and_pictures_that_they_are_in(tmp_path: Path) -> None:
    experiment = bench(tmp_path / "bench")
    rig = read_rig(rig_file(tmp_path / "rig.yaml", DEPTH, TILT))
    beam = tisim.Beam(material=SOFT, length=0.05)
    points = np.array([[0.0, 0.01], [0.03, 0.0]])
    one, other = trial(experiment, "S0-50"), trial(experiment, "S1-50")
    assert rig.bend(beam, one).length == 0.05
    assert rig.bend(beam, other).length == pytest.approx(0.0515)
    assert rig.bend(beam, one).clamp_imperfections.tilt == pytest.approx(np.radians(2.0))
    np.testing.assert_array_equal(rig.image(points, one), points)
    np.testing.assert_allclose(rig.image(points, other), points - [0.0015, 0.0])


def test_doubts_have_the_covariance_of_the_file(tmp_path: Path) -> None:
    matrix = [[0.04, 0.012], [0.012, 0.01]]
    path = rig_file(tmp_path / "rig.yaml", TILT, DEPTH, covariance={"names": ["a", "b"], "matrix": matrix})
    rig = read_rig(path)
    off = np.array([np.subtract(r.amplitudes, rig.amplitudes) for _, r in rig.doubts() if isinstance(r, Rig)])
    units = np.array([np.radians(1.0), 1e-3])
    np.testing.assert_allclose(off.T @ off, matrix * np.outer(units, units), rtol=1e-3)
    assert [name for name, _ in rig.doubts()] == ["clamp-tilt (rig)", "grip-length of S1 (rig)"]


def test_an_effect_known_exactly_leaves_no_doubt(tmp_path: Path) -> None:
    assert (
        read_rig(rig_file(tmp_path / "rig.yaml", rig_effect("clamp-tilt", "angle_deg", 2.0, 0.0))).doubts()
        == []
    )


def test_a_doubt_keeps_an_amplitude_in_its_bounds(tmp_path: Path) -> None:
    matrix = [[4.0, -0.19], [-0.19, 0.01]]
    effects = (
        rig_effect("clamp-tilt", "angle_deg", 2.0, 2.0),
        rig_effect("clamp-compliance", "rad_per_Nm", 0.01, 0.1),
    )
    path = rig_file(tmp_path / "rig.yaml", *effects, covariance={"names": ["a", "b"], "matrix": matrix})
    assert min(r.amplitudes[1] for _, r in read_rig(path).doubts()) == 0.0  # no compliance is negative


def test_it_says_what_it_is(tmp_path: Path) -> None:
    experiment = bench(tmp_path / "bench")
    path = rig_file(
        tmp_path / "rig.yaml", TILT, {**DEPTH, "scope": "S7"}, experiment_sha256=experiment.digest
    )
    rig = read_rig(path).on(experiment)
    assert "clamp-tilt, angle_deg 2 ± 0.2; grip-length of S7, depth_mm 1.5 ± 0.1" in rig.sentence
    assert rig.digest[:16] in rig.sentence
    assert "grip-length of S7 reaches no beam of this experiment" in rig.sentence
    assert "found on these very measurements" in rig.sentence
    assert pickle.loads(pickle.dumps(rig)) == rig  # fits run in worker processes


BAD: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    (
        {"effect": "residual-curvature"},
        {},
        "key effects[#1].effect: expected one that beams can be corrected by",
    ),
    ({"effect": "machine-compliance"}, {}, "expected one that beams can be corrected by"),
    ({"belongs_to": "specimen"}, {}, "key effects[#1].belongs_to: expected 'rig', 'camera' or 'simulator'"),
    ({"belongs_to": "camera"}, {}, "key effects[#1].belongs_to: expected rig of clamp-tilt, got camera"),
    ({"parameters": {"angle": {"value": 1.0, "sd": 0.2}}}, {}, "expected angle_deg of clamp-tilt"),
    (
        {"parameters": {"angle_deg": {"value": 90.0, "sd": 0.2}}},
        {},
        "key effects[#1].parameters.angle_deg.value: expected -5.73 to 5.73, got 90",
    ),
    (
        {"parameters": {"angle_deg": {"value": 1.0}}},
        {"covariance": {"names": [], "matrix": []}},
        "sd: expected it",
    ),
    ({}, {"covariance": {"names": ["a"], "matrix": [[1.0, 0.0]]}}, "expected 1 rows of 1 numbers"),
    ({}, {"covariance": {"names": ["a"], "matrix": [[9.0]]}}, "the squares of the sd on its diagonal"),
    ({}, {"experiment_sha256": "abc"}, "key experiment_sha256: "),
    ({}, {"effects": []}, "key effects: expected at least 1"),
    ({}, {"format": 2}, "key format: expected 1"),
    ({}, {"colour": "red"}, "unknown key colour"),
]


@pytest.mark.parametrize(("change", "more", "words"), BAD)
def test_bad_files_end_in_one_sentence(
    change: dict[str, Any], more: dict[str, Any], words: str, tmp_path: Path
) -> None:
    effect = {**TILT, **change}
    sound = {"covariance": {"names": ["a"], "matrix": [[0.04]]}}
    path = rig_file(tmp_path / "rig.yaml", TILT, **{**sound, "effects": [effect], **more})
    with pytest.raises(InputError) as caught:
        read_rig(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_covariance_must_be_one(tmp_path: Path) -> None:
    matrix = [[0.04, 0.03], [0.03, 0.01]]
    path = rig_file(tmp_path / "rig.yaml", TILT, DEPTH, covariance={"names": ["a", "b"], "matrix": matrix})
    with pytest.raises(InputError, match="no negative eigenvalue"):
        read_rig(path)
