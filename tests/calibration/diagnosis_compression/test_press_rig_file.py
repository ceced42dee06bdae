"""Rig faults from a diagnosis of compression tests are recorded, and correct no calibration."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from diagnosis_press_cases import both, press_model, sliding

from calibration.diagnosis.card import write_cards
from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.rig import read_rig
from calibration.errors import InputError


def test_a_rig_of_presses_is_a_record(tmp_path: Path) -> None:
    data = both(lambda strain: sliding(strain + 0.006), seed=1)
    found = diagnose(press_model(data), gain=False)
    *_, path = write_cards(tmp_path / "cards", found, data)
    assert path.name == "rig.yaml"
    rig = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert [e["effect"] for e in rig["effects"]] == ["strain-offset"]
    assert rig["corrects"] == "nothing"
    assert "no command reads" in rig["use"]
    with pytest.raises(InputError) as caught:
        read_rig(path)
    assert str(caught.value) == (
        f"{path}: key corrects: expected outlines, got nothing: this was not found on photographed beams, and"
        " is a record that no command reads"
    )
