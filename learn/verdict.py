"""The domain of validity of one poke in words: what is outside, by how much, and what follows from it.

The live page states the same: `words` holds the sentences and their limits as data, with which its script
(`learn/page/js/verdict.js`) makes the text that `verdict` makes here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from learn.quantities import CLOCK_QUANTITIES, QUANTITIES

_UNITS = {key: quantity.units for key, quantity in {**QUANTITIES, **CLOCK_QUANTITIES}.items()}


class Grade(NamedTuple):
    """Words for the distances (`learn.validity.Domain.distance`) above `above`, up to the next larger grade.

    `place` says how far outside a poke is, `follows` what that means for the prediction, `wider` for its
    intervals.
    """

    above: float
    place: str
    follows: str
    wider: str


class Multiple(NamedTuple):
    """Words for an excess of `least` or more, up to the next larger: a number, `factor` times the excess."""

    least: float
    factor: float
    digits: int
    text: str


# Up to a distance of 0.05 the intervals have 1 % of the variance of an uninformed prediction at most, beyond
# 0.5 two thirds or more (`learn.evaluation.intervals`). A kind of inclusion alone has the distance 0.
GRADES = (
    Grade(0.5, "Far outside", "The force may be wrong by a factor", "nearly as wide as without a prediction"),
    Grade(0.05, "Outside", "The force may be wrong by a factor", "wider"),
    Grade(0.0, "Just outside", "Errors may be larger than inside", "little wider"),
    Grade(-1.0, "Outside", "Errors may be larger than inside", "not wider"),
)
MULTIPLES = (
    Multiple(10.0, 1.0, 0, "{number} times"),
    Multiple(0.0995, 100.0, 0, "{number} % of"),
    Multiple(1e-3, 100.0, 1, "{number} % of"),
    Multiple(0.0, 100.0, 1, "less than 0.1 % of"),
)
SENTENCES = {
    "contact": "No contact: nothing moves.",
    "unknown": "The trained ranges are not known: the prediction may be wrong.",
    "inside": "Inside the trained ranges.",
    "outside": "{grade} the trained ranges: {places}. {follows}{intervals}.",
    "place": "{name} ({value}; trained: {trained})",
    "place_with_excess": "{name} ({value}; trained: {trained}; {excess})",
    "excess": "beyond by {times} {unit}",
    "intervals": "; the intervals are {wider}, and not calibrated there",
}


@dataclass(frozen=True, kw_only=True)
class Check:
    """One quantity of a poke against its trained range.

    Attributes
    ----------
    key, name : key and name of the quantity.
    value : value of the poke; a number, or a name for the kind of inclusion or the law.
    trained : the trained range or names, as text.
    inside : True if the value is in the trained range; None if that is not known.
    beyond : excess over the range and its tolerance, in units of `unit`, as it counts in
        `learn.validity.Domain.distance`; 0 inside, for an inclusion of a kind that was not trained, and where
        it is not known.
    unit : what `beyond` is a multiple of, in words: "the range", or "the trained value" of a narrow range.
    """

    key: str
    name: str
    value: float | str
    trained: str
    inside: bool | None
    beyond: float = 0.0
    unit: str = "the range"

    @property
    def text(self) -> str:
        """One line: "depth 12 mm: outside the trained range (0.5 to 10 mm), beyond by 21 % of the range"."""
        word = {True: "inside", False: "outside", None: "not known whether inside"}[self.inside]
        trained = f" ({self.trained})" if self.trained else ""
        far = f", {self.far}" if self.far else ""
        return f"{self.name} {self.value_text}: {word} the trained range{trained}{far}"

    @property
    def value_text(self) -> str:
        """The value with its unit."""
        value = self.value if isinstance(self.value, str) else f"{self.value:.4g}"
        return f"{value} {_UNITS.get(self.key, '')}".rstrip()

    @property
    def far(self) -> str:
        """The excess in words, such as "beyond by 0.4 % of the range"; empty without one."""
        if not self.beyond > 0.0:
            return ""
        times = _times(self.beyond)
        if isinstance(self.value, str):  # a law has no excess of its own
            return f"counted as {times} {self.unit}"
        return SENTENCES["excess"].format(times=times, unit=self.unit)


def distance_of(checks: Sequence[Check]) -> float:
    """`learn.validity.Domain.distance` of the poke with these checks; NaN if no range is known."""
    if all(check.inside is None for check in checks):
        return math.nan
    return math.sqrt(sum(check.beyond**2 for check in checks))


def verdict(checks: Sequence[Check], *, intervals: bool) -> str:
    """Two sentences on the domain of validity: what is outside and by how much, and what follows from it.

    `intervals` is True if the prediction has intervals.
    """
    if all(check.inside is None for check in checks):
        return SENTENCES["unknown"]
    outside = [check for check in checks if check.inside is False]
    if not outside:
        return SENTENCES["inside"]
    graded = _graded(distance_of(checks))
    return SENTENCES["outside"].format(
        grade=graded.place,
        places=", ".join(_place(check) for check in outside),
        follows=graded.follows,
        intervals=SENTENCES["intervals"].format(wider=graded.wider) if intervals else "",
    )


def grade(distance: float) -> str:
    """How far a poke that is not inside lies outside, by its `learn.validity.Domain.distance`."""
    return _graded(distance).place


def words() -> dict[str, Any]:
    """The sentences, grades and multiples as JSON, for the live page."""
    return {
        "sentences": SENTENCES,
        "grades": [row._asdict() for row in GRADES],
        "multiples": [row._asdict() for row in MULTIPLES],
    }


def _graded(distance: float) -> Grade:
    return next((row for row in GRADES if distance > row.above), GRADES[-1])


def _place(check: Check) -> str:
    template = SENTENCES["place_with_excess" if check.far else "place"]
    return template.format(name=check.name, value=check.value_text, trained=check.trained, excess=check.far)


def _times(beyond: float) -> str:
    """A multiple of a unit in words: "less than 0.1 % of", "0.4 % of", "45 % of", "25 times"."""
    row = next(row for row in MULTIPLES if beyond >= row.least)
    return row.text.format(number=f"{row.factor * beyond:.{row.digits}f}")
