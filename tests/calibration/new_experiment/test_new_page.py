"""The commands of docs/how-to/lab-files.md run as printed, and its tables agree with the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from calibration.lab_files import _formats, importers
from calibration.new._answers import BoardAnswers, CouponAnswers, PokeAnswers
from calibration.new._plausible import CHECKS
from tests.packaging.blocks import ROOT, blocks
from tests.packaging.test_pages import run_here

PAGE = "docs/how-to/lab-files.md"


def test_commands_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_formats, "_IMPORTERS", dict(_formats._IMPORTERS))
    (tmp_path / "datasets").symlink_to(ROOT / "datasets")
    (tmp_path / "lab").mkdir()  # an empty folder may exist
    found = blocks(PAGE)
    assert len(found) == 4
    for block in found:
        run_here(block, tmp_path)
    assert (tmp_path / "lab" / "experiment.yaml").exists()
    assert (tmp_path / "board.pdf").read_bytes().startswith(b"%PDF-")
    assert (tmp_path / "lab" / "board.pdf").read_bytes() == (tmp_path / "board.pdf").read_bytes()


def test_tables_of_the_page_are_those_of_the_code() -> None:
    text = (ROOT / PAGE).read_text(encoding="utf-8")
    rows = re.findall(r"^\| (.+?) \|", text, re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`([\w-]+)`", row)}
    assert {i.name for i in importers()} <= named
    assert {c.name for c in CHECKS} <= named
    own = (set(CouponAnswers.model_fields) | set(PokeAnswers.model_fields) | {"board"}) - {
        *("id", "kind", "material", "specimen", "mode"),  # keys of experiment.yaml
        *("block_mm", "inclusion", "rod", "start_mm", "direction"),
    }
    assert own <= named
    assert BoardAnswers().squares == (9, 6)
