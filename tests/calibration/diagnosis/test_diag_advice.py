"""The advised experiment in words: effects common to all explanations need no separation."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from calibration.diagnosis.engine.advice import Advice, all_parted, most_parted


def explanations(*names: str) -> Any:
    return [SimpleNamespace(names=tuple(n.split())) for n in names]


def advised(*separations: float) -> Advice:
    return Advice(name="turn", sentence="turn it over", separations=separations, enough=25.0)


@pytest.mark.parametrize(
    ("names", "first", "others"),
    [
        (("grip void", "grip tilt", "grip creep"), "void", "tilt, creep"),
        (("void", "tilt", "creep"), "void", "tilt, creep"),
        (("grip void", "grip"), "void", "grip"),
    ],
)
def test_what_all_have_is_not_said(names: tuple[str, ...], first: str, others: str) -> None:
    best = advised(*(100.0 for _ in names[1:]))
    said = most_parted(best, explanations(*names))
    assert said == f"turn it over: {first} parts there from {others} by 10 standard deviations"
    assert all_parted(best, explanations(*names)).startswith(
        f"turn it over: {first}, {others} part there by 10"
    )


def test_one_standard_deviation() -> None:
    few = explanations("void", "tilt")
    said = "part there by 1 standard deviation, which will help but may not settle it"
    assert all_parted(advised(1.2), few) == f"turn it over: void, tilt {said}"


def test_what_nothing_parts_is_said_in_the_same_words() -> None:
    few = explanations("grip void", "grip tilt", "grip creep")
    assert most_parted(advised(100.0, 0.0), few).endswith("; nothing of the catalogue parts it from creep")
    assert most_parted(advised(0.0, 0.0), few) == "no experiment of the catalogue parts void from tilt, creep"
