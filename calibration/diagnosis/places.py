"""Where a cause sits, between the places that the search knows.

An effect that sits somewhere (a void) is screened at a few places. The shape of its trace depends on where it
sits: a large one fitted 3 mm beside its place leaves a hundred of chi-square, which nothing else explains. So
the place of what promises much is moved to where the fit is best, by parabolas through three fits.
"""

from __future__ import annotations

from dataclasses import replace

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.explanation import Explanation, explain
from calibration.diagnosis.nested import Nested
from calibration.diagnosis.null import Null

STEPS = (
    0.05,
    0.0125,
)  # of the specimen's length: half of what parts the places of the search, then a quarter
FARTHEST = 1.5  # steps
ENDS = (0.02, 0.98)


def settled(model: Nested, explanation: Explanation, null: Null) -> Explanation:
    """The explanation with its causes' places where chi-square is least; itself where none has a place."""
    found = explanation
    for number, cause in enumerate(explanation.candidates):
        if cause.place is None:
            continue
        for step in STEPS:
            found = _nearer(model, found, number, step, null)
    return found


def _nearer(model: Nested, found: Explanation, number: int, step: float, null: Null) -> Explanation:
    """The best of the place, one step to either side, and the vertex of the parabola through these."""
    here = found.candidates[number].place
    assert here is not None
    tried = {here: found}
    for place in (here - step, here + step):
        _try(model, found, number, place, null, tried)
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
    model: Nested, found: Explanation, number: int, place: float, null: Null, tried: dict[float, Explanation]
) -> None:
    if not ENDS[0] <= place <= ENDS[1]:
        return
    moved: list[Candidate] = list(found.candidates)
    moved[number] = replace(moved[number], place=place)
    amplitudes = [found.fit.state.amplitudes[c] for c in found.candidates]
    there = explain(model, found.fit, moved, amplitudes, null)
    if there is not None:
        tried[place] = there
