"""The example experiments are small, readable, and made by their documented command."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from benchmarks.blind import make_examples
from calibration.experiment import read
from tests.packaging.blocks import ROOT

MEASURED = ROOT / "datasets" / "measured"
FOLDERS = sorted(p.parent for p in MEASURED.rglob("experiment.yaml"))


def test_there_is_one_of_each_kind_of_measurement() -> None:
    names = {p.relative_to(MEASURED).as_posix() for p in FOLDERS}
    assert {
        "photographs",
        "indentation",
        "coupons",
        "compression",
        "bench/clean",
        "bench/bent-in-the-mould",
    } <= names
    listed = (MEASURED / "README.md").read_text(encoding="utf-8")
    assert all(f"`{name}`" in listed for name in names)


def test_they_are_small() -> None:
    assert sum(p.stat().st_size for p in MEASURED.rglob("*") if p.is_file()) < 3e6


@pytest.mark.parametrize("folder", FOLDERS, ids=[p.name for p in FOLDERS])
def test_each_is_a_valid_experiment_with_its_truth_beside_it(folder: Path) -> None:
    experiment = read(folder)
    truth = yaml.safe_load((folder / "truth.yaml").read_text(encoding="utf-8"))
    assert set(truth["shear_modulus_Pa"]) == set(experiment.materials)
    text = (folder / "experiment.yaml").read_text(encoding="utf-8")
    assert "truth" not in text
    assert "seed" not in text


@pytest.mark.parametrize("name", list(make_examples.EXAMPLES))
def test_the_command_makes_the_files_that_are_shipped(name: str, tmp_path: Path) -> None:
    """Byte for byte, but for the photographs, whose compression belongs to the version of OpenCV."""
    make_examples.EXAMPLES[name](tmp_path / name)
    made = {p.relative_to(tmp_path): p for p in tmp_path.rglob("*") if p.is_file()}
    kept = {p.relative_to(MEASURED) for p in (MEASURED / name).rglob("*") if p.is_file()}
    assert set(made) == kept
    for relative, path in made.items():
        if relative.suffix != ".jpg":
            assert path.read_bytes() == (MEASURED / relative).read_bytes(), relative
