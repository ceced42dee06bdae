"""The laboratory's further experiments: the same specimen in another pose, and values that gauges add."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from benchmarks.blind.beams.cases import Case
from benchmarks.blind.beams.experiment import write_experiment
from benchmarks.blind.beams.follow_up import GRIP, OTHER, deeper, measure, photograph_again, swapped, turned
from benchmarks.blind.beams.model import Beam
from benchmarks.blind.beams.solver import solve
from benchmarks.blind.beams.store import SURVEY, load_case, load_truth
from calibration.experiment import read
from calibration.experiment.model import BeamTrial, Capture

INDEX = {
    (case["hidden"][0]["effect"] if case["hidden"] else case["category"]): int(key)
    for key, case in load_truth(SURVEY)["cases"].items()
}
FAULTY = Beam(
    length=0.1,
    bridge=False,
    mu=2e4,
    taper=0.8,
    axial_gradient=-2.0,
    curvature=0.5,
    void=0.3,
    void_at=0.040,
    blob=1e-3,
)


def written(name: str, place: Path) -> tuple[Case, Path]:
    """A case of the survey with its first material only, and the folder of its experiment."""
    case, edges = load_case(SURVEY, INDEX[name])
    case = replace(case, trials=case.trials[:3], stated={"S0": case.stated["S0"]})
    write_experiment(case, edges, place / "experiment")
    return case, place / "experiment"


def beams(folder: Path) -> list[BeamTrial]:
    return [t for t in read(folder).trials if isinstance(t, BeamTrial)]


def height(capture: Capture) -> float:
    """Height of the lower edge's end."""
    assert capture.outline is not None
    return float(capture.outline.lower[-1, 1])


def local(beam: Beam, x: float) -> tuple[float, float]:
    """Radius and modulus of the section at x."""
    away = x - beam.length / 2
    return beam.radius * (1 + beam.taper * away), beam.mu * (1 + beam.axial_gradient * away)


@pytest.mark.parametrize("x", [0.0, 0.03, 0.08])
def test_sections_stay_where_they_are_in_the_specimen(x: float) -> None:
    other_way = swapped(FAULTY, FAULTY.length)
    assert local(other_way, FAULTY.length - GRIP - x) == pytest.approx(local(FAULTY, x))
    pushed = deeper(FAULTY, OTHER)
    assert pushed is not None
    assert local(pushed, x - (FAULTY.length - OTHER)) == pytest.approx(local(FAULTY, x))


def test_what_sits_in_a_beam_moves_with_it() -> None:
    assert swapped(FAULTY, 0.1).void_at == pytest.approx(0.040)
    assert swapped(FAULTY, 0.1).blob == 0.0
    pushed = deeper(FAULTY, OTHER)
    assert pushed is not None
    assert (pushed.void_at, pushed.blob) == pytest.approx((0.015, 1e-3))
    assert deeper(Beam(length=0.05, bridge=False, mu=2e4), OTHER) is None
    held = deeper(Beam(length=0.1, bridge=False, mu=2e4, void=0.3, void_at=0.012), OTHER)
    assert held is not None
    assert held.void == 0.0  # in the grip, where the beam does not bend


def test_a_turned_beam_bends_the_other_way() -> None:
    """Without weight, turning a curved beam over mirrors its image."""
    bent = Beam(length=0.05, bridge=False, mu=1e6, density=1e-3, curvature=2.0, transverse_gradient=10.0)
    s = np.linspace(0.1, 1.0, 5)
    over, under = solve(turned(bent, bent.length)).edges(s)
    upper, lower = solve(bent).edges(s)
    np.testing.assert_allclose(over * [1, -1], lower, atol=1e-7)
    np.testing.assert_allclose(under * [1, -1], upper, atol=1e-7)


def test_a_pose_is_added_in_the_form_that_a_lab_writes(tmp_path: Path) -> None:
    """Tip masses: one new trial per cantilever, lower than before, with the old measurements unchanged."""
    case, folder = written("clean", tmp_path)
    before = {p.name: p.read_bytes() for p in (folder / "beams").iterdir()}
    assert photograph_again(case, "tip-mass", folder) == [
        f"{t.id}: not in this pose" for t in case.trials if t.kind == 2
    ]
    now = {p.name: p.read_bytes() for p in (folder / "beams").iterdir()}
    assert len(now) == len(before) + 2
    assert {name: now[name] for name in before} == before
    trials = {t.id: t for t in beams(folder)}
    for own in case.trials:
        if own.kind < 2:
            new, old = trials[f"{own.id}-tip-mass"], trials[own.id]
            assert new.tip_force == pytest.approx((0.0, 0.0, -0.04905))
            assert new.specimen == old.specimen
            assert height(new.captures[0]) < height(old.captures[0]) - 1e-3


def test_later_photographs_are_of_the_same_trials_and_creep_goes_on(tmp_path: Path) -> None:
    case, folder = written("creep", tmp_path)
    assert photograph_again(case, "later", folder) == []
    trials = beams(folder)
    assert len(trials) == 3
    creeping = next(k for k in case.hidden[0].trials if case.trials[k].kind == 1)
    captures = trials[creeping].captures
    assert [c.time for c in captures] == [10.0, 100.0, 1000.0, 10000.0]
    first, second, third, fourth = map(height, captures)
    assert fourth < third < second < first


def test_gauges_enter_what_the_format_has_keys_for(tmp_path: Path) -> None:
    case, folder = written("free-length", tmp_path)
    (hidden,) = case.hidden
    entered, out = measure(case, "gauge-block", [("free-length",), ("skin",)], folder)
    assert entered == ("free-length",)
    assert out == ("clamp-gap", "image-scale")
    trials = yaml.safe_load((folder / "experiment.yaml").read_text())["trials"]
    for k, (own, entry) in enumerate(zip(case.trials, trials, strict=True)):
        true = own.length + (hidden.amplitude if own.kind < 2 and k in hidden.trials else 0.0)
        assert entry["free_length_sd_mm"] == pytest.approx(0.05)
        assert 0 < abs(entry["free_length_mm"] - 1e3 * true) < 0.25  # the reading has an error
