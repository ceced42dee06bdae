"""Causes hidden in synthetic indentations are found, and no others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.blind.indentation.cases import make_poke, write
from benchmarks.blind.indentation.model import BASES, Case, force, table
from benchmarks.blind.indentation.run import run
from benchmarks.blind.record_scores import named, named_set, true_names
from benchmarks.blind.under_test import diagnose_indentation


def diagnosed(case: Case, tmp_path: Path, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    write(case, tmp_path / "experiment")
    return diagnose_indentation(tmp_path / "experiment", without=without)


def test_the_table_goes_up_and_comes_down() -> None:
    """Assumptions of the data: forces increase with depth, and retraction has no larger ones (to 1 %)."""
    for name, entry in table().items():
        there = np.array(entry["in"])
        assert (np.diff(there) > 0).all(), name
        back = np.array(entry["out"])
        assert (back <= 1.01 * there[len(there) - 1 - len(back) : len(there) - 1]).all(), name
    assert set(BASES) <= set(table())


def test_no_truth_is_written(tmp_path: Path) -> None:
    case = make_poke(3, "one", "force-offset")
    write(case, tmp_path / "experiment")
    texts = [p.read_text() for p in (tmp_path / "experiment").rglob("*") if p.is_file()]
    assert not any("force-offset" in t or "truth" in t for t in texts)
    assert any(np.abs(force(t, case.hidden) - force(t, ())).max() > 0 for t in case.trials)


@pytest.mark.slow
def test_a_hidden_cause_is_in_the_named_set(tmp_path: Path) -> None:
    """The cheapest geometry, with the complete search in simulated indentations.

    It is the example of datasets/measured, which tests/packaging diagnoses in every run, as in the tutorial.
    """
    case = make_poke(12, "one", "depth-offset", target=9.0)
    assert true_names(case.truth()) in named_set(diagnosed(case, tmp_path))


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "name"), [(1, "mullins"), (2, "force-drift"), (3, "adhesion")])
def test_a_hidden_cause_is_named(seed: int, name: str, tmp_path: Path) -> None:
    case = make_poke(seed, "one", name, target=20.0)
    verdict = diagnosed(case, tmp_path)
    assert named(verdict) == true_names(case.truth())


@pytest.mark.slow
def test_without_its_name_in_the_library_a_cause_is_not_found(tmp_path: Path) -> None:
    case = make_poke(1, "one", "mullins", target=25.0)
    assert diagnosed(case, tmp_path, without=("mullins",))["verdict"] != "found"


@pytest.mark.slow
def test_the_set() -> None:
    """Forty cases: lower bounds of the figures printed by `benchmarks.blind.indentation.run`."""
    pairs = run(40, 2, show_each=False)
    single = [p for p in pairs if p[0]["kind"] == "one"]
    wrong = [v["verdict"] == "found" and named(v) != true_names(t) for t, v in single]
    assert sum(wrong) <= 2
    clean = [v["verdict"] == "found" for t, v in pairs if t["kind"] in ("clean", "trap")]
    assert sum(clean) <= 1
