"""Effects hidden in synthetic beam experiments are found, and no others.

The cases are those of `benchmarks.blind.beams.make --survey` (each effect once, 6 to 15 sigma); the complete
set is diagnosed by `benchmarks.blind.beams.run`. Each experiment is in a temporary folder, without the truth.
"""

from __future__ import annotations

import csv
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from benchmarks.blind.beams.cases import draw
from benchmarks.blind.beams.effects import EFFECTS, OUTSIDE, PARAMETER
from benchmarks.blind.beams.experiment import write_experiment
from benchmarks.blind.beams.ideal_beams import LENGTHS, POINTS
from benchmarks.blind.beams.scores import Scored
from benchmarks.blind.beams.store import SURVEY, load_case, load_truth, save_case
from benchmarks.blind.under_test import Diagnoser

INDEX = {
    (case["hidden"][0]["effect"] if case["hidden"] else case["category"]): int(key)
    for key, case in load_truth(SURVEY)["cases"].items()
}
# every run has the three beams of one material, some 10 core-s per diagnosis; the nine of a case are slow
FEW, ALL = 3, 9
NOTHING = [
    ("clean", FEW),
    pytest.param("clean", ALL, marks=pytest.mark.slow),
    pytest.param("density", ALL, marks=pytest.mark.slow),
]
HIDDEN = [
    ("creep", FEW),
    # tests/packaging diagnoses a bench with residual curvature in every run, as the README does
    pytest.param("residual-curvature", FEW, marks=pytest.mark.slow),
    *(
        pytest.param(name, ALL, marks=pytest.mark.slow)
        for name in (
            "residual-curvature",
            "creep",
            "grip-length",
            "clamp-compliance",
            "free-length",
            "taper",
            "strain-stiffening",
            "clamp-gap",
            "void",
        )
    ),
]


def diagnosed(name: str, beams: int, folder: Path, *, magnified: float = 1.0) -> Scored:
    """Diagnosis of the case's first beams; `magnified` scales hidden effects of the photographs."""
    index = INDEX[name]
    case, edges = load_case(SURVEY, index)
    hidden = tuple(replace(h, amplitude=magnified * h.amplitude) for h in case.hidden)
    fewer = replace(case, trials=case.trials[:beams], hidden=hidden)
    write_experiment(fewer, edges[:beams], folder / "experiment")
    verdict = Diagnoser(in_process=True, workers=1)(folder / "experiment")
    return Scored(load_truth(SURVEY)["cases"][f"{index:03d}"], verdict)


@pytest.mark.parametrize(("name", "beams"), NOTHING)
def test_nothing_is_named_where_nothing_can_be_seen(name: str, beams: int, tmp_path: Path) -> None:
    case = diagnosed(name, beams, tmp_path)
    assert case.verdict == "none"
    assert case.named == ()


@pytest.mark.parametrize(("name", "beams"), HIDDEN)
def test_a_hidden_effect_is_named(name: str, beams: int, tmp_path: Path) -> None:
    """The effect is in the named set, as its first one, with its amplitude within 3 standard deviations.

    Equivalent explanations may be named, too.
    """
    case = diagnosed(name, beams, tmp_path)
    assert case.in_the_set, (case.diagnosis["verdict"], case.diagnosis["alternatives"])
    assert case.named == (name,)
    for true, found, sd in case.amplitudes():
        assert abs(found - true) < 3 * sd


@pytest.mark.parametrize("beams", [FEW, pytest.param(ALL, marks=pytest.mark.slow)])
def test_what_no_library_holds_gets_no_confident_name(beams: int, tmp_path: Path) -> None:
    """The effect has as many standard deviations in a few beams as in all."""
    case = diagnosed("shadow", beams, tmp_path, magnified=(ALL / beams) ** 0.5)
    assert case.verdict in ("unexplained", "ambiguous")


def _edges_of_nothing() -> np.ndarray:
    """Straight edges of nine trials with three photographs."""
    s = np.linspace(0, 1, POINTS)
    edges = np.zeros((9, 3, 2, POINTS, 2))
    for trial in range(9):
        edges[trial, ..., 0] = s * LENGTHS[trial % 3][0]
        edges[trial, :, :, :, 1] = np.array([0.01, -0.01])[:, None]
    return edges


def test_lab_writes_the_format_and_nothing_of_the_truth(tmp_path: Path) -> None:
    case, edges = load_case(SURVEY, INDEX["void"])
    write_experiment(case, edges, tmp_path / "experiment")
    kept = sorted(p.relative_to(tmp_path / "experiment").as_posix() for p in tmp_path.rglob("*.*"))
    written = yaml.safe_load((tmp_path / "experiment" / "experiment.yaml").read_text())
    named = [c["outline"] for t in written["trials"] for c in t["captures"]]
    assert kept == sorted(["experiment.yaml", *named])
    # as whole words, since the format itself has "radius" in radius_mm
    words = set(re.findall(r"[a-z-]+", (tmp_path / "experiment" / "experiment.yaml").read_text()))
    assert words & {*EFFECTS, *OUTSIDE, "truth", "seed", "sigma"} == {"radius"}


def test_lab_draws_the_noise_that_it_states(tmp_path: Path) -> None:
    """Straight edges: 0.1 mm along the normal (z), with a registration of 0.1 mm, 0.15 degrees and 0.3 %."""
    heights, slopes = [], []
    for index in range(6):
        case = draw(index, 1, "clean", (), (3.0, 20.0))
        folder = tmp_path / str(index)
        write_experiment(case, _edges_of_nothing() + 1e-12 * index, folder)
        for path in sorted(folder.glob("beams/*cantilever-100*.csv")):
            rows: list[dict[str, Any]] = list(csv.DictReader(path.read_text().splitlines()))
            x, z = (np.array([float(r[k]) for r in rows]) for k in ("x_mm", "z_mm"))
            upper = np.array([r["side"] == "upper" for r in rows])
            error = z - np.where(upper, 10.0, -10.0)
            heights.append(error[upper][0])
            slopes.append(np.polyfit(x, error, 1)[0])
    assert np.std(heights) == pytest.approx(np.hypot(0.1, 0.1), rel=0.2)
    assert np.std(slopes) == pytest.approx(np.deg2rad(0.15), rel=0.25)


def test_case_comes_back_from_disk(tmp_path: Path) -> None:
    case, edges = load_case(SURVEY, INDEX["creep"])
    save_case(tmp_path, case, edges, {"creep": 7.0})
    again, kept = load_case(tmp_path, case.index)
    np.testing.assert_array_equal(kept, edges)
    assert (again.trials, again.hidden, again.stated) == (case.trials, case.hidden, case.stated)
    assert not np.array_equal(kept[:, 0], kept[:, 2])  # it creeps


def test_score_separates_right_from_wrong() -> None:
    truth = load_truth(SURVEY)["cases"][f"{INDEX['creep']:03d}"]
    value = truth["hidden"][0]["parameters"]["per_decade"]
    cause = {"effect": "creep", "parameters": {"per_decade": {"value": value + 0.002, "sd": 0.001}}}
    verdict = {"verdict": "found", "causes": [cause], "alternatives": [["creep"]], "seconds": 1.0}
    right = Scored(truth, verdict)
    assert right.named == right.effects == ("creep",)
    assert right.in_the_set
    assert Scored(truth, verdict | {"alternatives": []}).in_the_set  # the named cause belongs to the set
    (true, found, sd), *_ = right.amplitudes()
    assert (found - true) / sd == pytest.approx(2.0)
    other = Scored(
        truth, verdict | {"causes": [cause | {"effect": "skin"}], "alternatives": [["skin"], ["creep"]]}
    )
    assert other.named == ("skin",)
    assert other.in_the_set
    assert not Scored(truth, verdict | {"verdict": "none", "causes": [], "alternatives": []}).in_the_set


def test_survey_holds_each_effect_once() -> None:
    assert {*INDEX} == {*EFFECTS, "clean", "density", "shadow"}
    assert {*PARAMETER} == {*EFFECTS}
