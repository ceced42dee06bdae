"""Numbers and lists as text: as many digits as the uncertainty justifies, and cells of tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10

NOTHING = "–"


@dataclass(frozen=True, kw_only=True)
class Cell:
    """text for people; value in SI, as the result's JSON has it; mark: a CSS class."""

    text: str
    value: float | None = None
    mark: str = ""


def significant(value: float, digits: int = 3) -> str:
    """Plain decimal notation, so many significant digits."""
    if not isfinite(value):
        return NOTHING
    if value == 0.0:
        return "0"
    places = digits - 1 - floor(log10(abs(value)))
    return f"{round(value, places):.{max(0, places)}f}"


def with_sd(value: float, sd: float) -> str:
    """`9.68 ± 0.07`: the sd to one digit (two where that is a 1), the value to the same place; four digits
    and no sd where it is not known."""
    if not isfinite(value):
        return NOTHING
    if not (isfinite(sd) and sd > 0.0):
        return significant(value, 4)
    places = -floor(log10(sd))
    if round(sd * 10.0**places) < 2:
        places += 1
    return f"{round(value, places):.{max(0, places)}f} ± {round(sd, places):.{max(0, places)}f}"


def millimetres(value: float | None) -> str:
    """A length [m] in mm, to a micrometre."""
    return NOTHING if value is None or not isfinite(value) else f"{value * 1e3:.3f}"


def seconds(value: float) -> str:
    return significant(value, 2) if value < 10.0 else f"{value:.0f}"


def listed(words: Sequence[str]) -> str:
    """`a, b and c`."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))
