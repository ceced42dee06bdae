"""Figures for people: as many digits as they are worth, kPa and mm."""

from __future__ import annotations

from math import floor, isfinite, log10

from calibration.search import Estimate
from calibration.study.calibration import Calibration

NOTHING = "–"


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


def shear(result: Calibration) -> str:
    """The shear modulus with its sd, in kPa, without the unit."""
    return with_sd(result.shear_modulus / 1e3, result.shear_modulus_sd / 1e3)


def seconds(value: float) -> str:
    return significant(value, 2) if value < 10.0 else f"{value:.0f}"


def interval(estimate: Estimate) -> str:
    """A value with its 95 % interval, moduli in kPa; words in place of digits where the data are blind."""
    if estimate.seen == "not identified":
        return "not identified"
    part = 1e-3 if estimate.unit == "Pa" else 1.0
    unit = " kPa" if estimate.unit == "Pa" else ""
    text = significant(part * estimate.value)
    if estimate.seen == "at a bound":
        return f"{text}{unit}, at a bound"
    low, high = significant(part * estimate.low), significant(part * estimate.high)
    weak = ", weak" if estimate.seen == "weak" else ""
    return f"{text} [{low}, {high}]{unit}{weak}"
