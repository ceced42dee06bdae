"""Figures with one panel per trial: the choice of trials, and the curve drawn for the extension."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.diagnosis.drawing import (
    DrawnCurve,
    before_and_after,
    legend_handles,
    measured_and_simulated,
    per_trial,
    titled,
)
from calibration.pages import paper


def curve(name: str, size: float, *, extended: bool = True) -> DrawnCurve:
    left = np.full(4, size)
    return DrawnCurve(name=name, left_before=left, left_after=0.5 * left if extended else None, sd=np.ones(4))


def draw(axes: Any, d: DrawnCurve) -> None:
    titled(axes, d, "depth / mm", "force / mN", unit=("mN", 1e3), note=" (note)")


def test_those_that_depart_most_have_a_panel() -> None:
    curves = [curve(f"t{i}", 1.0 + i) for i in range(8)]
    made = per_trial(
        curves, draw, name="forces", caption="Dots.", handles=legend_handles(curves, "extended (creep)")
    )
    shown = [axes for axes in made.figure.axes if axes.get_visible()]
    assert [axes.get_title(loc="left").split()[0] for axes in shown] == [f"t{i}" for i in range(2, 8)]
    assert shown[0].get_title(loc="left") == "t2 (note)\nrms 3000 → 1500 mN"
    assert made.caption == "Dots. 2 trials that depart less are not drawn."
    (legend,) = made.figure.legends
    assert [t.get_text() for t in legend.get_texts()] == ["measured", "baseline", "extended (creep)"]


def test_without_an_extension_there_is_nothing_of_it() -> None:
    curves = [curve("t", 1.0, extended=False)]
    made = per_trial(
        curves, draw, name="x", caption="Dots.", handles=legend_handles(curves, "", measured=False)
    )
    (axes,) = made.figure.axes
    assert axes.get_title(loc="left") == "t (note)\nrms 1000 mN"
    assert made.caption == "Dots."
    assert [t.get_text() for t in made.figure.legends[0].get_texts()] == ["baseline"]


@pytest.mark.parametrize("extended", [True, False])
def test_branches_are_drawn_each_by_its_own_line(extended: bool) -> None:
    axes = paper(3.0, 3.0).subplots()
    x = np.arange(5.0)
    first = x < 3
    measured_and_simulated(
        axes, x, x + 1.0, x + 2.0, x + 3.0 if extended else None, [(first, False), (~first, True)]
    )
    drawn = [
        (line.get_marker(), line.get_markerfacecolor(), np.asarray(line.get_ydata()).tolist())
        for line in axes.lines
    ]
    ends = {m: [y for marker, _, y in drawn if marker == m] for m in ("o", "None")}
    assert ends["o"] == [[1.0, 2.0, 3.0], [4.0, 5.0]]
    simulated = [[2.0, 3.0, 4.0], [3.0, 4.0, 5.0], [5.0, 6.0], [6.0, 7.0]]
    assert ends["None"] == (simulated if extended else simulated[::2])
    assert [face == "none" for marker, face, _ in drawn if marker == "o"] == [False, True]


@pytest.mark.parametrize(
    ("named", "verdict", "p_value", "after"),
    [
        (True, "explained", 0.5, True),
        (False, "unexplained", 0.001, True),
        (False, "unexplained", 0.02, False),
        (False, "none", 0.001, False),
    ],
)
def test_what_stands_for_the_extension(named: bool, verdict: str, p_value: float, after: bool) -> None:
    best = SimpleNamespace(fit=SimpleNamespace(state=10))
    diagnosis: Any = SimpleNamespace(
        chosen=best if named else None,
        nearest=None,
        finding=SimpleNamespace(
            baseline=SimpleNamespace(state=1), explanations=[best], verdict=verdict, p_value=p_value
        ),
    )

    def evaluate(state: Any) -> list[int]:
        return [state, 2 * state]

    expected = [(1, 10), (2, 20)] if after else [(1, None), (2, None)]
    assert before_and_after(diagnosis, evaluate) == expected
