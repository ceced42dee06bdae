"""What a lab writes down naturally: zero-padded numbers, specimens A and B of each material, empty keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from _folders import coupon_entry, write_experiment

import calibration
from calibration.errors import InputError
from calibration.experiment import PHOTOGRAPHS, CouponTrial, read, read_photo_settings
from calibration.measurements.homogeneous.model import HomogeneousModel

STRETCH = np.linspace(1.02, 1.6, 20)


def coupons(folder: Path, names: dict[str, tuple[str, str]]) -> Path:
    """Exact neo-Hookean pulls of (material, specimen) by trial, 30 kPa and 60 kPa."""
    tables, trials = {}, []
    for name, (material, specimen) in names.items():
        modulus = {"M1": 30.0, "M2": 60.0}[material]
        stress = modulus * (STRETCH - STRETCH**-2)
        tables[f"{name}.csv"] = {"stretch": STRETCH, "nominal_stress_kPa": stress}
        own = {"material": material, "specimen": specimen, "stress_sd_kPa": 0.1}
        trials.append(coupon_entry(name, f"{name}.csv", **own))
    return write_experiment(folder, trials, tables=tables, materials={"M1": {}, "M2": {}})


def test_specimens_of_two_materials_may_have_one_name(tmp_path: Path) -> None:
    names = {"a": ("M1", "A"), "b": ("M1", "C"), "c": ("M2", "A"), "d": ("M2", "B")}
    data = read(coupons(tmp_path, names))
    assert [t.specimen for t in data.trials] == ["M1 A", "C", "M2 A", "B"]
    model = HomogeneousModel(data)
    assert not any(r.remembers or r.reloaded for r in model.records)
    found = calibration.diagnose(data, workers=1)
    assert found.verdict == "none"


@pytest.mark.parametrize("text", ["0100", "16:40", "0x64", "1_00"])
def test_a_number_of_another_base_is_refused(tmp_path: Path, text: str) -> None:
    """YAML 1.1 reads 64, 1000, 100 and 100."""
    folder = write_experiment(
        tmp_path,
        [coupon_entry("a", "a.csv")],
        tables={"a.csv": {"stretch": STRETCH, "nominal_stress_kPa": STRETCH - 1.0}},
    )
    file = folder / "experiment.yaml"
    stated = yaml.safe_load(file.read_text(encoding="utf-8"))
    stated["trials"][0]["stress_sd_kPa"] = 7.25
    file.write_text(yaml.safe_dump(stated).replace("7.25", text), encoding="utf-8")
    with pytest.raises(InputError, match=r"trials\[a\]\.stress_sd_kPa: expected"):
        read(folder)


def test_lines_above_the_header_may_be_blank(tmp_path: Path) -> None:
    folder = write_experiment(tmp_path, [coupon_entry("a", "a.csv")])
    rows = "".join(f"{s:.6f},{s - 1.0:.6f}\n" for s in STRETCH)
    (folder / "a.csv").write_text(f"\n , \nstretch,nominal_stress_kPa\n\n{rows}", encoding="utf-8")
    (trial,) = read(folder).trials
    assert isinstance(trial, CouponTrial)
    np.testing.assert_allclose(trial.stretch, STRETCH, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("board_corner_mm:\n", "board_corner_mm"),
        ("board_roll_sd_deg: true\n", "board_roll_sd_deg"),
        ("board_distance_mm: 1.0e+9\n", "board_distance_mm"),
        ("calibration_photos: 1\n", "calibration_photos"),
        ("board: 1\n", "unknown key board"),
    ],
)
def test_photographs_yaml_is_read_strictly(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / PHOTOGRAPHS).write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_photo_settings(tmp_path)
