"""The example experiments are small, valid, and reproduced by their documented command."""

from __future__ import annotations

import re
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
    """Compare all files but photographs, and numbers to a relative 1e-12.

    The compression of photographs depends on the version of OpenCV, and the last digits of numbers on the
    processor's vector instructions.
    """
    make_examples.EXAMPLES[name](tmp_path / name)
    made = {p.relative_to(tmp_path): p for p in tmp_path.rglob("*") if p.is_file()}
    kept = {p.relative_to(MEASURED) for p in (MEASURED / name).rglob("*") if p.is_file()}
    assert set(made) == kept
    for relative, path in made.items():
        if relative.suffix != ".jpg":
            words, numbers = _words_and_numbers(path)
            kept_words, kept_numbers = _words_and_numbers(MEASURED / relative)
            assert words == kept_words, relative
            assert numbers == pytest.approx(kept_numbers, rel=1e-12, abs=0.0), relative


def _words_and_numbers(path: Path) -> tuple[list[str], list[float]]:
    parts = re.split(r"(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)", path.read_text(encoding="utf-8"))
    return parts[::2], [float(x) for x in parts[1::2]]
