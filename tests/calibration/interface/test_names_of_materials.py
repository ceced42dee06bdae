"""Materials may have any name: commas, letters of other alphabets, names alike but for a blank."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

import calibration
from calibration.cli import names_in
from calibration.errors import InputError, OptionError
from calibration.prediction._select import chosen


def experiment(folder: Path, *materials: str) -> Path:
    stretch = np.linspace(1.05, 1.5, 8)
    table = {"stretch": stretch, "nominal_stress_kPa": 30.0 * (stretch - stretch**-2)}
    trials = [coupon_entry(f"t{k}", "a.csv", material=name) for k, name in enumerate(materials)]
    return write_experiment(folder, trials, tables={"a.csv": table}, materials={key: {} for key in materials})


def test_a_name_with_a_comma_is_chosen_in_quotes(tmp_path: Path) -> None:
    assert names_in('"gel, soft", foam,') == ["gel, soft", "foam"]
    data = calibration.read_experiment(experiment(tmp_path, "gel, soft", "foam"))
    assert [t.id for t in chosen(data, '"material=gel, soft"', "predict")] == ["t0"]
    assert [t.id for t in chosen(data, '"material=gel, soft", t1', "predict")] == ["t0", "t1"]
    with pytest.raises(OptionError):
        chosen(data, "material=gel, soft", "predict")


@pytest.mark.parametrize("names", [("α", "β"), ("a b", "a-b")])
def test_pictures_of_two_materials_have_two_files(tmp_path: Path, names: tuple[str, str]) -> None:
    found = calibration.fit(experiment(tmp_path / "data", *names), model="neo-hookean", workers=1)
    one = calibration.fit(experiment(tmp_path / "one", names[0]), model="neo-hookean", workers=1)
    for fits, folder in ((found, tmp_path / "both"), (one, tmp_path / "alone")):
        fits.write_report(folder)
    count = [len(list((tmp_path / name / "pictures").iterdir())) for name in ("both", "alone")]
    assert count[0] == 2 * count[1] > 0


def test_a_material_named_as_the_rigs_card_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    begun = time.monotonic()
    with pytest.raises(InputError, match="material rig: expected another name"):
        calibration.diagnose(experiment(tmp_path, "rig"), workers=1)
    assert time.monotonic() - begun < 2.0
