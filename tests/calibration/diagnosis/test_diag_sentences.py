"""Verdicts in sentences: the causes common to all explanations, and their fraction of the misfit."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from calibration.diagnosis.engine.sentences import percent, sentence
from calibration.diagnosis.engine.shares import Interval
from calibration.measurements._effect import Candidate


@pytest.mark.parametrize(
    ("grip", "rest"), [(0.6, "There is another, smaller cause"), (0.2, "There is another, larger cause")]
)
def test_a_cause_that_is_certain_is_said_with_its_weight(grip: float, rest: str) -> None:
    shares = {"grip": grip, "void": 0.9 - grip}
    finding: Any = SimpleNamespace(
        verdict="ambiguous", equivalent=(("grip", "void"), ("grip", "tilt")), certain=("grip",)
    )
    chosen: Any = SimpleNamespace(candidates=[Candidate(effect=n) for n in shares], names=tuple(shares))
    verdict = sentence(
        finding,
        chosen,
        {n: SimpleNamespace(sentence=f"there is a {n}") for n in ("grip", "void", "tilt")},
        unit=("mm", 1e3),
        shares={Candidate(effect=n): Interval(value=s, low=s - 0.1, high=s + 0.1) for n, s in shares.items()},
    )
    part = f"{100 * grip:.0f} % [{100 * grip - 10:.0f}, {100 * grip + 10:.0f}]"
    assert verdict == (
        f"Found in part: there is a grip (grip, {part} of the misfit beyond noise)."
        f" {rest}, which these data cannot identify: void or tilt."
    )


@pytest.mark.parametrize(
    ("value", "low", "high", "said"),
    [
        (0.9951, 0.9951, 0.99994, "99.5 % [99.5, 99.9]"),
        (0.994, 0.8, 1.0, "99 % [80, 100]"),
        (1.2, -0.1, 1.3, "100 % [0, 100]"),
    ],
)
def test_all_of_a_misfit_is_said_only_where_nothing_is_left(
    value: float, low: float, high: float, said: str
) -> None:
    assert percent(Interval(value=value, low=low, high=high)) == said
