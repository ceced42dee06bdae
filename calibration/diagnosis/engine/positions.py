"""Optimisation of the position of a cause along the specimen, between the screened positions.

An effect with a position (a void) is screened at a few positions. Its signature depends on the position: a
large void fitted 3 mm away from its position leaves a chi-square of about 100 that nothing else explains. The
position of a significant cause is therefore optimised by parabolic interpolation of chi-square.
"""

from __future__ import annotations

from dataclasses import replace

from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.null import Null
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel

STEPS = (
    0.05,
    0.0125,
)  # relative to the specimen's length: half of the screened spacing, then a quarter of that
FARTHEST = 1.5  # largest move, in steps
ENDS = (0.02, 0.98)


def at_best_position(model: MeasurementModel, explanation: Explanation, null: Null) -> Explanation:
    """Minimise chi-square over the causes' positions, one cause after the other, in two step sizes.

    Returns the explanation itself if no cause has a position.
    """
    found = explanation
    for number, cause in enumerate(explanation.candidates):
        if cause.position is None:
            continue
        for step in STEPS:
            found = _improved(model, found, number, step, null)
    return found


def _improved(
    model: MeasurementModel, found: Explanation, number: int, step: float, null: Null
) -> Explanation:
    """The best of four positions: the current one, one step to each side, and the vertex of the parabola."""
    here = found.candidates[number].position
    assert here is not None
    tried = {here: found}
    for position in (here - step, here + step):
        _try(model, found, number, position, null, tried)
    if len(tried) == 3:
        low, high = min(tried), max(tried)
        a, b, c = (tried[p].fit.chi2 for p in (low, here, high))
        bend = a - 2.0 * b + c
        if bend > 0.0 and high - here == here - low:
            way = 0.5 * (a - c) / bend
            _try(model, found, number, here + step * min(max(way, -FARTHEST), FARTHEST), null, tried)
    best: Explanation = min(tried.values(), key=lambda e: e.fit.chi2)
    return best


def _try(
    model: MeasurementModel,
    found: Explanation,
    number: int,
    position: float,
    null: Null,
    tried: dict[float, Explanation],
) -> None:
    if not ENDS[0] <= position <= ENDS[1]:
        return
    moved: list[Candidate] = list(found.candidates)
    moved[number] = replace(moved[number], position=position)
    amplitudes = [found.fit.state.amplitudes[c] for c in found.candidates]
    there = explain(model, found.fit, moved, amplitudes, null)
    if there is not None:
        tried[position] = there
