"""Which experiment is advised where any of the rivals may be the cause."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pytest

from calibration.diagnosis.advice import advise, from_nearest


@dataclass(frozen=True)
class Test:
    """parts: by how much of chi-square, by (true, other)."""

    name: str
    parts: dict[tuple[str, str], float]

    __test__ = False

    @property
    def sentence(self) -> str:
        return f"do {self.name}"


def apart(test: Test, true: Any, others: Sequence[Any]) -> list[float]:
    return [test.parts.get((true, other), 100.0) for other in others]


CAUSES: list[Any] = ["bend", "lean", "void"]


def names(tests: list[Test], *, whichever: bool) -> list[str]:
    found = advise(tests, CAUSES, apart, enough=25.0, rank=from_nearest, whichever=whichever)
    return [a.name for a in found]


def test_an_experiment_that_settles_it_for_the_first_only_comes_behind() -> None:
    one_sided = Test("cheap", {("lean", "void"): 1.0, ("void", "lean"): 1.0})
    sure = Test("dear", {})
    assert names([one_sided, sure], whichever=False) == ["cheap", "dear"]
    assert names([one_sided, sure], whichever=True) == ["dear", "cheap"]


def test_of_those_that_settle_it_whichever_is_true_the_cheapest_comes_first() -> None:
    assert names([Test("cheap", {("void", "bend"): 26.0}), Test("dear", {})], whichever=True)[0] == "cheap"


def test_what_is_said_of_the_first_and_of_whichever_is_true() -> None:
    parts = {("bend", "lean"): 40.0, ("lean", "bend"): 30.0, ("void", "bend"): float("inf")}
    (found,) = advise([Test("one", parts)], CAUSES, apart, enough=25.0, rank=from_nearest, whichever=True)
    assert found.separations == (40.0, 100.0)
    assert found.whichever == (40.0, 30.0, 100.0)
    assert found.separation == pytest.approx(40.0)
    never = {(a, b): float("inf") for a in CAUSES for b in CAUSES}
    (found,) = advise([Test("one", never)], CAUSES, apart, enough=25.0, rank=from_nearest, whichever=True)
    assert found.separation == 0.0
    assert found.whichever == (float("inf"),) * 3
