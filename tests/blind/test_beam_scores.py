"""Scores of held-out improvement, scope, advice and controls, on invented verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from benchmarks.blind.beams.cases import MODULI
from benchmarks.blind.beams.controls import (
    SENTENCES,
    advice_goals,
    advised,
    control_goals,
    settled,
    shuffle_materials,
)
from benchmarks.blind.beams.follow_up import GAUGES, POSES, refuted
from benchmarks.blind.beams.held_out import Fall, gain_goals
from benchmarks.blind.beams.scores import Goal, Scored, beams_in, scope_goals, scopes


def truth(*effects: str, sigma: float = 12.0, category: str = "single", scope: str = "all") -> dict[str, Any]:
    trials = [k for k in range(9) if scope == "all" or list(MODULI)[k // 3] == scope]
    hidden = [{"effect": e, "scope": scope, "trials": trials, "parameters": {}} for e in effects]
    sizes = dict.fromkeys(effects, sigma)
    return {"category": category, "per_beam": True, "hidden": hidden, "sigma": sizes}


def made_diagnosis(
    verdict: str, *names: tuple[str, ...], scope: str = "all", **others: Any
) -> dict[str, Any]:
    """A diagnosis with these sets of names, the chosen one first."""
    causes = [{"effect": e, "scope": scope, "parameters": {}} for e in (names[0] if names else ())]
    return {"verdict": verdict, "causes": causes, "alternatives": [list(n) for n in names]} | others


def gain(before: float | None, after: float | None, noise: float | None = 0.08) -> dict[str, Any]:
    held = "leave-one-length-out" if before is not None else "none"
    return {
        "held_out": held,
        "rms_mm_before": before,
        "rms_mm_after": after,
        "rms_mm_noise": noise,
        "note": "",
    }


def count(rows: list[Goal], what: str) -> tuple[int, int]:
    (row,) = [r for r in rows if what in r[0]]
    return row[2], row[3]


def test_fall_of_rms_and_of_what_it_has_beyond_noise() -> None:
    f = Fall(before=0.10, after=0.08, noise=0.06)
    assert f.raw == pytest.approx(0.2)
    assert f.beyond == pytest.approx(1 - (0.08**2 - 0.06**2) ** 0.5 / 0.08)
    assert f.has_room
    assert not Fall(before=0.10, after=0.09, noise=0.08).has_room
    assert Fall(before=0.08, after=0.07, noise=0.09).beyond == 0.0


def test_gain_counts_what_fell_what_was_not_named_and_what_no_fold_keeps() -> None:
    creep = ("creep",)
    verdicts = {
        "fell": made_diagnosis("found", creep, gain=gain(0.20, 0.09)),
        "beyond": made_diagnosis("found", creep, gain=gain(0.10, 0.085)),  # 15 % of rms, 52 % of the excess
        "stayed": made_diagnosis("found", creep, gain=gain(0.20, 0.19)),
        "no fold": made_diagnosis("found", creep, gain=gain(None, None, None)),
        "unnamed": made_diagnosis("unexplained", gain=None),
        "not measured": made_diagnosis("found", creep, gain=None),
    }
    cases = {k: Scored(truth("creep"), v) for k, v in verdicts.items()}
    cases["small"] = Scored(truth("creep", sigma=9.0), made_diagnosis("found", creep, gain=gain(0.2, 0.2)))
    true_cause = {
        "fell": made_diagnosis("found", creep, gain=gain(0.20, 0.089)),
        "stayed": made_diagnosis("found", creep, gain=gain(0.20, 0.10)),
        "unnamed": made_diagnosis("found", creep, gain=gain(0.20, 0.10)),
    }
    rows = gain_goals(cases, true_cause)
    assert count(rows, "no fold") == (1, 6)
    assert count(rows, "rms falls by 30 % (noise") == (1, 4)
    assert count(rows, "where noise leaves room") == (1, 2)
    assert count(rows, "excess over noise falls") == (2, 4)
    assert count(rows, "rms within 1.2") == (1, 3)
    assert count(rows, "excess over noise within 1.2") == (1, 3)


def test_gain_without_any_measured_is_not_scored() -> None:
    rows = gain_goals({"a": Scored(truth("creep"), made_diagnosis("none", gain=None))}, {})
    assert {r[3] for r in rows if "falls" in r[0]} == {0}


def test_scope_is_compared_as_the_beams_that_an_effect_acts_on() -> None:
    assert beams_in("S0.5", "creep", per_beam=True) == {3, 4, 5}
    assert beams_in("S0.5-b", "creep", per_beam=True) == {4}
    assert beams_in("all", "clamp-gap", per_beam=False) == {2, 5, 8}
    with pytest.raises(ValueError, match="scope elsewhere"):
        beams_in("elsewhere", "creep", per_beam=False)
    right = Scored(truth("creep", scope="S1"), made_diagnosis("found", ("creep",), scope="S1"))
    whole = Scored(truth("creep", scope="S1"), made_diagnosis("found", ("creep",), scope="all"))
    other = Scored(truth("creep", scope="S1"), made_diagnosis("found", ("creep",), scope="S0"))
    wrong = Scored(truth("creep", scope="S1"), made_diagnosis("found", ("skin",), scope="S1"))
    # a bridge does not slip out: for this effect all beams of a material are its cantilevers
    slipped = Scored(truth("free-length", scope="S0"), made_diagnosis("found", ("free-length",), scope="S0"))
    assert [t == s for _, t, s in scopes(slipped)] == [True]
    rows = scope_goals([right, whole, other, wrong, slipped])
    assert count(rows, "in the right beams") == (2, 4)
    assert count(rows, "in one material") == (2, 4)
    assert count(rows, "some of the right") == (3, 4)


def test_each_experiment_of_the_diagnosis_is_understood() -> None:
    from calibration.measurements.outlines.experiments import EXPERIMENTS

    assert {e.name for e in EXPERIMENTS} == {*SENTENCES} == {*POSES, *GAUGES}
    for e in EXPERIMENTS:
        assert advised({"next_experiment": f"{e.sentence}: void, skin part there"}) == e.name
    assert advised({"next_experiment": "no experiment of the catalogue parts void, skin"}) is None
    with pytest.raises(ValueError, match="does not understand"):
        advised({"next_experiment": "ask somebody"})


def test_advice_settles_where_the_truth_is_found_alone() -> None:
    both = made_diagnosis("ambiguous", ("taper",), ("skin",))
    case = Scored(truth("taper"), both)

    def after(new: dict[str, Any] | None, entered: list[str] | None = None) -> dict[str, Any]:
        return {"advice": "callipers", "entered": entered or [], "diagnosis": new}

    assert settled(case, after(made_diagnosis("found", ("taper",))))
    assert not settled(case, after(made_diagnosis("found", ("skin",))))
    assert not settled(case, after(made_diagnosis("ambiguous", ("taper",), ("skin",))))
    assert not settled(case, after(made_diagnosis("none")))
    assert not settled(case, after(None))
    # its value is in the experiment, so that nothing remains to be found
    assert settled(case, after(made_diagnosis("none"), ["taper"]))
    assert not settled(case, after(made_diagnosis("found", ("skin",)), ["taper"]))
    string = Scored(truth("string", category="outside"), both)
    assert settled(string, after(made_diagnosis("unexplained")))
    assert not settled(string, after(made_diagnosis("found", ("taper",))))
    clean = Scored(truth(category="clean"), both)
    assert settled(clean, after(made_diagnosis("none")))
    answers = {
        "a": after(made_diagnosis("found", ("taper",))),
        "b": after(made_diagnosis("none")),
        "elsewhere": after(None),
    }
    rows = advice_goals({"a": case, "b": case}, answers)
    assert count(rows, "advised experiment made") == (1, 2)


def test_readings_refute_the_sets_that_they_disagree_with() -> None:
    sets = [("clamp-tilt",), ("residual-curvature",), ("gravity-tilt", "skin")]
    nothing = {"clamp-tilt": False, "gravity-tilt": False}
    assert refuted(nothing, sets) == ("clamp-tilt", "gravity-tilt", "skin")
    tilted = {"clamp-tilt": True, "gravity-tilt": False}
    assert refuted(tilted, sets) == ("gravity-tilt", "residual-curvature", "skin")
    # a cause that a reading confirms stays, although no set has it
    assert refuted({"clamp-gap": True}, sets) == ("clamp-tilt", "gravity-tilt", "residual-curvature", "skin")


def test_without_the_truth_only_listed_alternatives_are_excused() -> None:
    full = Scored(truth("taper"), made_diagnosis("ambiguous", ("taper",), ("skin", "radius")))
    cases = dict.fromkeys("abcde", full)
    without = {
        "a": made_diagnosis("unexplained"),
        "b": made_diagnosis("found", ("radius", "skin")),
        "c": made_diagnosis("found", ("creep",)),
        "d": made_diagnosis("none"),
        "e": made_diagnosis("ambiguous", ("creep",), ("radius", "skin")),
    }
    rows = control_goals(cases, without, {})
    assert count(rows, "unexplained or a listed alternative") == (2, 5)
    assert count(rows, "another name, alone") == (1, 5)


def test_shuffled_materials_must_lose_the_name() -> None:
    cases = dict.fromkeys("ab", Scored(truth("taper"), made_diagnosis("found", ("taper",))))
    mixed = {"a": made_diagnosis("found", ("taper",)), "b": made_diagnosis("unexplained")}
    assert count(control_goals(cases, {}, mixed), "old name") == (1, 2)


def test_shuffling_gives_no_material_its_own_outlines_of_all_lengths(tmp_path: Path) -> None:
    lengths = (50.0, 100.0, 150.0)
    trials: list[dict[str, Any]] = [
        {"id": f"{m}-{x}", "free_length_mm": x, "captures": [f"{m}-{x}"]} for m in "abc" for x in lengths
    ]
    (tmp_path / "experiment.yaml").write_text(yaml.safe_dump({"trials": trials}))
    shuffle_materials(tmp_path)
    mixed = yaml.safe_load((tmp_path / "experiment.yaml").read_text())["trials"]
    assert [t["id"] for t in mixed] == [t["id"] for t in trials]
    assert sorted(t["captures"][0] for t in mixed) == sorted(t["captures"][0] for t in trials)
    for k in range(0, 9, 3):
        assert len({t["captures"][0][0] for t in mixed[k : k + 3]}) == 3
        assert [t["captures"][0][2:] for t in mixed[k : k + 3]] == ["50.0", "100.0", "150.0"]
