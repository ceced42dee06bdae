"""The example of docs/reference/extended-cards.md runs as printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from card_cases import bench, diagnosis

from calibration.diagnosis import Candidate
from calibration.diagnosis.card import write_cards

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reference" / "extended-cards.md"


def test_tisim_takes_an_extended_card(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    found = diagnosis({Candidate(effect="strain-stiffening", at="S1", alternatives=2): 0.5})
    write_cards(tmp_path / "OUT" / "cards", found, bench(tmp_path / "bench"))
    monkeypatch.chdir(tmp_path)
    exec(compile(code, str(PAGE), "exec"), {})
    assert capsys.readouterr().out == "yeoh converged\n"
