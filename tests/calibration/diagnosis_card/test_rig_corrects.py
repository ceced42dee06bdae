"""Only diagnoses of photographed beams write a rig.yaml that `calibration.fit --rig` reads."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import yaml
from card_cases import bench, diagnosis

from calibration.diagnosis import Candidate
from calibration.diagnosis._rig_file import USES, corrects
from calibration.diagnosis.card import write_cards
from calibration.diagnosis.effects.compression import EFFECTS as PRESSES
from calibration.diagnosis.effects.homogeneous import EFFECTS as COUPONS
from calibration.diagnosis.effects.indentation import EFFECTS as POKES
from calibration.diagnosis.effects.outlines import EFFECTS as BEAMS
from calibration.diagnosis.effects.release import EFFECTS as BARS
from calibration.diagnosis.rig import read_rig
from calibration.errors import InputError
from calibration.measurements._effect import Effect


def faults(effects: Mapping[str, Effect]) -> list[Effect]:
    found = [e for e in effects.values() if e.belongs_to != "specimen"]
    assert len(found) > 2
    return found


@pytest.mark.parametrize(
    "effects", [BARS, COUPONS, PRESSES, POKES], ids=["bars", "coupons", "presses", "pokes"]
)
def test_what_is_found_on_other_measurements_corrects_nothing(effects: Mapping[str, Effect]) -> None:
    for e in faults(effects):
        assert corrects([e]) == "nothing", e.name


@pytest.mark.parametrize(
    "effect", [e for e in faults(BEAMS) if e.belongs_to != "simulator"], ids=lambda e: e.name
)
@pytest.mark.parametrize("end", [0, 1])
def test_what_is_found_on_photographed_beams_is_read(effect: Effect, end: int, tmp_path: Path) -> None:
    """At the bounds of the amplitude, to the six digits of the file."""
    amplitude = effect.bounds[end]
    found = diagnosis({Candidate(effect=effect.name): amplitude})
    *_, path = write_cards(tmp_path / "cards", found, bench(tmp_path / "bench"))
    rig = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert (rig["corrects"], rig["use"]) == ("outlines", USES["outlines"])
    assert read_rig(path).amplitudes == pytest.approx((amplitude,), rel=1e-5)


def test_a_record_is_refused_whatever_its_effects_are_called(tmp_path: Path) -> None:
    found = diagnosis({Candidate(effect="clamp-tilt"): 0.02})
    *_, path = write_cards(tmp_path / "cards", found, bench(tmp_path / "bench"))
    text = path.read_text(encoding="utf-8")
    assert "corrects: outlines\n" in text
    for word, said in (("nothing", "is a record that no command reads"), ("markers", "expected 'outlines'")):
        path.write_text(text.replace("corrects: outlines\n", f"corrects: {word}\n"), encoding="utf-8")
        with pytest.raises(InputError, match=f"key corrects: .*{said}"):
            read_rig(path)
    # files from before this key existed
    path.write_text(text.replace("corrects: outlines\n", ""), encoding="utf-8")
    assert read_rig(path).amplitudes == pytest.approx((0.02,), rel=1e-5)


def test_a_fault_of_a_simulator_corrects_nothing_and_says_so(tmp_path: Path) -> None:
    """The amplitudes of rig and camera stay, with their covariance; a file without any is refused."""
    locking, tilt = Candidate(effect="locking"), Candidate(effect="clamp-tilt")
    made = diagnosis({locking: 0.5, tilt: 0.02})
    *_, path = write_cards(tmp_path / "cards", made, bench(tmp_path / "bench"))
    rig = read_rig(path)
    assert [c.effect for c in rig.candidates] == ["clamp-tilt"]
    assert rig.amplitudes == pytest.approx((0.02,), rel=1e-5)
    assert np.shape(rig.covariance) == (1, 1)
    assert "locking is a fault of the diagnosed simulator" in rig.on(bench(tmp_path / "other")).sentence
    *_, path = write_cards(tmp_path / "alone", diagnosis({locking: 0.5}), bench(tmp_path / "third"))
    with pytest.raises(InputError, match="key effects: expected one of rig or camera, got locking"):
        read_rig(path)
