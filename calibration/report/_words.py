"""Numbers and sentences of the page: as many digits as they are worth, kPa and mm."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Mapping, Sequence

from calibration.experiment.model import Experiment
from calibration.inference import Estimate
from calibration.pages import listed, significant, with_sd
from calibration.report._compare import ALIKE, REFUTED, Comparison, compare
from calibration.study.assessment import display_name
from calibration.study.calibration import Calibration

HELD_WIDE = 1.2  # ends of an interval: further apart, it is the prior's and not that of a hold to 1 %


def shear(result: Calibration) -> str:
    """The shear modulus with its sd, in kPa, without the unit."""
    return with_sd(result.shear_modulus / 1e3, result.shear_modulus_sd / 1e3)


def interval(estimate: Estimate) -> str:
    """A value with its 95 % interval, moduli in kPa; words where the data do not determine it."""
    if estimate.seen == "not identified":
        return "not identified"
    if estimate.seen == "held":
        return f"held at {significant(estimate.value)}, not measured"
    part = 1e-3 if estimate.unit == "Pa" else 1.0
    unit = " kPa" if estimate.unit == "Pa" else ""
    text = significant(part * estimate.value)
    if estimate.seen == "at a bound":
        return f"{text}{unit}, at a bound"
    low, high = significant(part * estimate.low), significant(part * estimate.high)
    weak = ", weak" if estimate.seen == "weak" else ""
    return f"{text} [{low}, {high}]{unit}{weak}"


def headline(results: Sequence[Calibration], experiment: Experiment) -> str:
    """One sentence on one material: its lack of fit and the command that finds the cause, or the verdict."""
    found = compare(results)
    if found is None or not found.chosen.lacking or found.chosen.status == "stopped":
        return verdict(results)
    chosen = found.chosen
    fitted = [r for r in results if r.parameters]
    laws = "every law tried" if len(fitted) > 1 and all(r.lacking for r in fitted) else chosen.label
    return (
        f"{chosen.material}: no calibration: the data ask for something that {laws} lacks"
        f" ({'; '.join(chosen.lacking)}). Find the cause with: python -m calibration.diagnose"
        f" {shlex.quote(str(experiment.folder))}. Until then: {shear(chosen)} kPa by {chosen.label}."
    )


def verdict(results: Sequence[Calibration]) -> str:
    """One sentence on one material: its shear modulus, and the comparison of the laws."""
    material = results[0].material
    found = compare(results)
    if found is None:
        ways = Counter(r.status for r in results)
        counts = listed([f"{n} {status}" for status, n in ways.items()])
        return f"{material}: no result, since no law has a fit ({counts})."
    chosen = found.chosen
    parts = [f"{material}: shear modulus {shear(chosen)} kPa by {chosen.label}"]
    if any(
        e.name == "shear_modulus" and e.seen in ("not identified", "at a bound") for e in chosen.estimates
    ):
        parts.append("the data do not determine it: its bounds in the search do")
    if chosen.status == "stopped":
        parts.append("the best so far of a search that was stopped, without error bars")
    else:
        if chosen.status == "not converged":
            parts.append("of a fit that did not converge")
        elif not chosen.estimates:
            parts.append("without error bars, since the fit was not polished")
        parts.append(_laws(found, results))
    # of a stopped search chi-square still has the coarse mesh's error in it
    if found.misses and chosen.status != "stopped" and not chosen.lacking:
        parts.append(
            f"{'this law misses' if len(results) == 1 else 'even this law misses'} the data by more than the"
            f" stated noise (reduced chi-square {significant(chosen.reduced_chi2)})"
        )
    return "; ".join(parts) + "."


def _laws(found: Comparison, results: Sequence[Calibration]) -> str:
    own = found.chosen.mean_dice
    if own is not None:
        others = [f"{r.label} {r.mean_dice:.4f}" for r in results if r is not found.chosen and r.mean_dice]
        more = f", of {listed(others)}" if others else ""
        return f"fitted to overlaps, mean Dice {own:.4f} of {found.chosen.points} photographs{more}"
    said = _compared(found, results)
    for label, difference in found.better.items():
        said += (
            f"; {label} fits better (Akaike difference {significant(difference)}), but a constant of it is at"
            " a bound of the search"
        )
    return said


def _compared(found: Comparison, results: Sequence[Calibration]) -> str:
    fitted = len(found.compared)
    if fitted == 1:
        others = len(results) - 1
        if found.passed_over:
            return f"of {others} other laws none has a fit with all constants inside their bounds"
        return f"of {others} other laws none has a fit" if others else "no other law was tried"
    alike = [n for n in found.alike if n != found.chosen.label]
    if len(alike) + 1 == fitted:
        return f"the {fitted} laws cannot be told apart by this data{_span(found, results)}"
    if alike:
        return f"this data cannot tell it from {listed(alike)}{_span(found, results)}"
    next_one, margin = min(
        ((n, d) for n, d in found.compared.items() if n != found.chosen.label), key=lambda pair: pair[1]
    )
    how = "prefer it to all others" if margin > REFUTED else "slightly prefer it to others"
    return f"the data {how} (next {next_one}, Akaike difference {significant(margin)})"


def _span(found: Comparison, results: Sequence[Calibration]) -> str:
    moduli = [r.shear_modulus / 1e3 for r in results if r.label in found.alike]
    low, high = significant(min(moduli), 4), significant(max(moduli), 4)
    return f" (G {low} to {high} kPa among them)" if low != high else ""


def rule() -> str:
    """Explanation of how laws are compared, by their Akaike values."""
    return (
        "The law with the lowest Akaike value (chi-square + 2 per constant) leads; a law with a constant at a"
        " bound of the search leads only where all have one. The Akaike difference of"
        " another law is the difference of the two chi-squares plus 2 for each constant more. Where the least"
        " reduced chi-square is above 1, chi-squares are divided by it. Below"
        f" {ALIKE:g} the data cannot tell two laws apart; above {REFUTED:g} they speak clearly against"
        " the other law (Burnham and Anderson 2002). A negative difference belongs to a law that fits better"
        " but ends at a bound."
    )


def blind(result: Calibration) -> list[str]:
    """Each direction that the data do not determine, as a sentence; without constants that were held."""
    held = {e.name for e in result.estimates if e.seen == "held"}
    return [f"{result.label}: {_direction(weights)}." for weights in result.blind if not set(weights) <= held]


def unidentified(result: Calibration) -> list[str]:
    """Each constant whose value is its prior's, a bound's or a hold's, as a sentence; without those of
    `blind`."""
    alone = {name for weights in result.blind if len(weights) == 1 for name in weights}
    found = []
    for e in result.estimates:
        if e.seen == "held":
            why = ": its interval is the hold's, not measured"
            if e.high > HELD_WIDE * e.low:
                why = (
                    f", not measured; what is known of it beforehand, {significant(e.low)} to"
                    f" {significant(e.high)}, is in the other constants' intervals"
                )
            found.append(f"{result.label}: {display_name(e.name)} was held at {significant(e.value)}{why}.")
        elif e.name not in alone and e.seen in ("not identified", "at a bound"):
            why = "its bound decides" if e.seen == "at a bound" else "its prior or its bounds decide"
            found.append(f"{result.label}: the data do not determine {display_name(e.name)}: {why}.")
    return found


def _direction(weights: Mapping[str, float]) -> str:
    if len(weights) == 1:
        name = display_name(next(iter(weights)))
        return f"the data do not determine {name}: its prior and its bounds do"
    first = max(weights, key=lambda n: abs(weights[n]))
    sign = 1.0 if weights[first] > 0.0 else -1.0
    moves = [
        f"{display_name(n)} {'up' if sign * w > 0 else 'down'}"
        + ("" if n == first else f" by {significant(abs(w / weights[first]), 2)} as much of its range")
        for n, w in sorted(weights.items(), key=lambda pair: -abs(pair[1]))
    ]
    return f"the data do not determine {listed(moves)} together: these changes cancel each other"


def troubles(results: Sequence[Calibration]) -> list[str]:
    """Fits that are no calibration, each with its message."""
    return [
        f"{r.material}, {r.label}: {r.status}" + (f" ({r.reason})" if r.reason else "")
        for r in results
        if r.status != "converged"
    ]
