"""Scores of homogeneous tests and indentations, on invented verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from benchmarks.blind.record_scores import Pair, confusion, diagnosed, goals
from benchmarks.blind.records import apart, in_turn, reaching

GAIN = {
    "held_out": "leave-one-trial-out",
    "rms_before": 2.0,
    "rms_after": 1.5,
    "rms_noise": 1.4,
    "log_likelihood": 3.0,
}


def pair(kind: str, true: str, verdict: str, *names: str, sigma: float = 12.0, **others: Any) -> Pair:
    """Truth and verdict with these single causes, the chosen one first."""
    effects = [{"effect": true, "amplitude": 1e-3, "scope": "all", "sigma": sigma}] if true else []
    estimate = {"offset_percent": {"value": 0.14, "sd": 0.01}}
    diagnosis = {
        "verdict": verdict,
        "causes": [{"effect": n, "parameters": estimate} for n in names[:1]],
        "alternatives": [[n] for n in names],
        "extended": {"shear_modulus_Pa": {"M0": 1030.0}},
        "gain": GAIN,
    }
    return {"kind": kind, "effects": effects, "shear_modulus_Pa": {"M0": 1000.0}}, diagnosis | others


PAIRS = [
    pair("one", "strain-offset", "found", "strain-offset"),
    pair("one", "strain-offset", "found", "strain-offset", sigma=6.0),
    pair("one", "strain-offset", "ambiguous", "mullins", "strain-offset"),
    pair("one", "strain-offset", "found", "mullins", sigma=6.0),
    pair("one", "strain-offset", "none", sigma=4.0),
    pair("clean", "", "none"),
    pair("clean", "", "unexplained"),
    pair("outside", "slip", "unexplained"),
    pair("outside", "slip", "found", "mullins"),
    pair("outside", "slip", "found", "mullins", sigma=9.0),
]


@pytest.mark.parametrize(
    ("what", "reached"),
    [
        ("ranked first, 5 sigmas", "2 of 4"),
        ("ranked first, 7 sigmas", "1 of 2"),
        ("named set, 5 sigmas", "3 of 4"),
        ("named set, of those named", "3 of 4"),
        ("unique and wrong", "1 of 5"),
        ("unexplained: clean", "1 of 2"),
        ("unexplained, in part or ambiguous", "1 of 2"),
        ("10 sigmas: one name", "1 of 2"),
        ("within 3 of its sd", "0 of 2"),
        ("moduli within 2 %", "0 of 2"),
        ("within 5 %", "2 of 2"),
        ("rms falls by 30 %", "0 of 1"),
        ("beyond the noise", "1 of 1"),
        ("likelihood grows", "1 of 1"),
    ],
)
def test_counts(what: str, reached: str) -> None:
    (found,) = [r for name, _, r in goals(PAIRS) if what in name]
    assert found.startswith(reached)


def test_confusion_names_what_was_said() -> None:
    lines = dict(line.split("  ", 1) for line in confusion(PAIRS).splitlines())
    assert "right 2" in lines["strain-offset"]
    assert "mullins (ambiguous) 1" in lines["strain-offset"]


def test_cases_come_in_turn() -> None:
    def make(seed: int, kind: str, name: str) -> tuple[int, str, str]:
        return seed, kind, name

    made = in_turn(20, 3, make, library=("a", "b"), outside=("x", "y"), trap=True)
    kinds = [kind for _, kind, _ in made]
    assert [kinds.count(k) for k in ("clean", "trap", "outside", "two", "one")] == [5, 2, 2, 2, 9]
    assert made[0] == (3000, "clean", "")
    assert {name for _, kind, name in made if kind == "one"} == {"a", "b"}


def test_amplitude_reaches_its_size_or_the_largest() -> None:
    assert reaching(lambda a: 4.0 * a, 10.0, largest=100.0, steps=40) == pytest.approx(2.5)
    assert reaching(lambda a: 4.0 * a, 10.0, largest=2.0, steps=40) == 2.0


def test_two_causes_must_each_be_seen_beside_the_other() -> None:
    def size(trials: float, cause: int, others: tuple[int, ...]) -> float:
        return trials * (cause - sum(others))

    assert apart(size, 1.0, (5,))
    assert not apart(size, 1.0, (5, 4))


class _Case:
    def truth(self) -> dict[str, Any]:
        return PAIRS[0][0]


def test_a_wrong_verdict_is_shown_with_its_lack_of_fit(capsys: pytest.CaptureFixture[str]) -> None:
    wrong = {"verdict": "none", "causes": [], "alternatives": [], "lack_of_fit": {"p": 0.25}, "tried": []}

    def write(_case: _Case, folder: Path) -> None:
        folder.mkdir()

    assert diagnosed([(7, _Case())], write, lambda _: wrong, show_each=True) == [(_Case().truth(), wrong)]
    shown = capsys.readouterr().out
    assert shown.startswith("  7 one strain-offset")
    assert "lack of fit {'p': 0.25}" in shown
