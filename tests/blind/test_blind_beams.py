"""Hidden effects in made beam experiments: each must be found, and nothing found where nothing is hidden.

The cases are those of `survey` (each effect once, 6 to 15 sigma, `make_beams.py --survey`); the whole set is
run by `run_beams.py`. What is diagnosed is an experiment folder in a temporary place, without the truth.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from _blind_cases import draw
from _blind_effects import EFFECTS, OUTSIDE, PARAMETER
from _blind_finder import Finder
from _blind_lab import write_experiment
from _blind_score import Scored
from _blind_store import load_case, load_truth, save_case
from _blind_table import LENGTHS, POINTS

SURVEY = Path(__file__).parent / "survey"
INDEX = {
    (case["hidden"][0]["effect"] if case["hidden"] else case["category"]): int(key)
    for key, case in load_truth(SURVEY)["cases"].items()
}
# of a dozen, the first of each list in every run; a diagnosis takes some 25 core-s
NOTHING = ["clean", pytest.param("density", marks=pytest.mark.slow)]
HIDDEN = [
    "residual-curvature",
    "creep",
    *(
        pytest.param(name, marks=pytest.mark.slow)
        for name in (
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


def judged(name: str, place: Path) -> Scored:
    index = INDEX[name]
    write_experiment(*load_case(SURVEY, index), place / "experiment")
    said = Finder(in_process=True, workers=1)(place / "experiment")
    return Scored(load_truth(SURVEY)["cases"][f"{index:03d}"], said)


@pytest.mark.parametrize("name", NOTHING)
def test_nothing_is_named_where_nothing_can_be_seen(name: str, tmp_path: Path) -> None:
    case = judged(name, tmp_path)
    assert case.verdict == "none"
    assert case.named == ()


@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_effect_is_named(name: str, tmp_path: Path) -> None:
    """In the named set, first of it, and by its size within 3 of its standard deviations; a rival may stand
    beside it."""
    case = judged(name, tmp_path)
    assert case.in_the_set, (case.said["verdict"], case.said["alternatives"])
    assert case.named == (name,)
    for true, said, sd in case.amplitudes():
        assert abs(said - true) < 3 * sd


def test_what_no_library_holds_gets_no_confident_name(tmp_path: Path) -> None:
    assert judged("shadow", tmp_path).verdict in ("unexplained", "ambiguous")


def _edges_of_nothing() -> np.ndarray:
    """Straight beams: nine trials, three photographs."""
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
    # as whole words, of which the format itself has "radius" (in radius_mm)
    words = set(re.findall(r"[a-z-]+", (tmp_path / "experiment" / "experiment.yaml").read_text()))
    assert words & {*EFFECTS, *OUTSIDE, "truth", "seed", "sigma"} == {"radius"}


def test_lab_draws_the_noise_that_it_states(tmp_path: Path) -> None:
    """0.1 mm along the normal with a registration of 0.1 mm, 0.15 degrees, 0.3 %: of straight edges, z."""
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


def test_score_tells_right_from_wrong() -> None:
    truth = load_truth(SURVEY)["cases"][f"{INDEX['creep']:03d}"]
    value = truth["hidden"][0]["parameters"]["per_decade"]
    cause = {"effect": "creep", "parameters": {"per_decade": {"value": value + 0.002, "sd": 0.001}}}
    said = {"verdict": "found", "causes": [cause], "alternatives": [["creep"]], "seconds": 1.0}
    right = Scored(truth, said)
    assert right.named == right.effects == ("creep",)
    assert right.in_the_set
    assert Scored(truth, said | {"alternatives": []}).in_the_set  # what is named belongs to the set
    (true, told, sd), *_ = right.amplitudes()
    assert (told - true) / sd == pytest.approx(2.0)
    rival = Scored(
        truth, said | {"causes": [cause | {"effect": "skin"}], "alternatives": [["skin"], ["creep"]]}
    )
    assert rival.named == ("skin",)
    assert rival.in_the_set
    assert not Scored(truth, said | {"verdict": "none", "causes": [], "alternatives": []}).in_the_set


def test_survey_holds_each_effect_once() -> None:
    assert {*INDEX} == {*EFFECTS, "clean", "density", "shadow"}
    assert {*PARAMETER} == {*EFFECTS}
