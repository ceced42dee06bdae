"""What a calibration says, as sentences: the verdict, blind directions, fits that came to nothing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from calibration.report._compare import ALIKE, REFUTED, Comparison, compare
from calibration.report._numbers import shear, significant
from calibration.study.calibration import Calibration

_NAMES = {
    "shear_modulus": "G",
    "bulk_ratio": "K/G",
    "second_share": "C01 / (C10 + C01)",
    "alpha": "alpha",
    "locking": "locking stretch",
}


def spoken(name: str) -> str:
    """A search coordinate's name for people; terms of a series keep their number."""
    for known, word in _NAMES.items():
        if name == known:
            return word
        if name.startswith(f"{known}_"):
            return f"{word} {name.removeprefix(f'{known}_')}"
    return name.replace("_", " ")


def listed(words: Sequence[str]) -> str:
    """`a, b and c`."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def verdict(results: Sequence[Calibration]) -> str:
    """One sentence on one material: its shear modulus, and what can be said of the laws."""
    material = results[0].material
    found = compare(results)
    if found is None:
        ways = Counter(r.status for r in results)
        counts = listed([f"{n} {status}" for status, n in ways.items()])
        return f"{material}: no result, since no law has a fit ({counts})."
    chosen = found.chosen
    parts = [f"{material}: shear modulus {shear(chosen)} kPa by {chosen.label}"]
    if chosen.status == "stopped":
        parts.append("the best so far of a search that was stopped, without error bars")
    else:
        if chosen.status == "not converged":
            parts.append("of a fit that did not converge")
        elif not chosen.estimates:
            parts.append("without error bars, since the fit was not polished")
        parts.append(_laws(found, results))
    # of a stopped search chi-square still has the coarse mesh's error in it
    if found.misses and chosen.status != "stopped":
        parts.append(
            f"{'this law misses' if len(results) == 1 else 'even this law misses'} the data by more than the"
            f" stated noise (reduced chi-square {significant(chosen.reduced_chi2)})"
        )
    return "; ".join(parts) + "."


def _laws(found: Comparison, results: Sequence[Calibration]) -> str:
    fitted = len(found.differences)
    if fitted == 1:
        others = len(results) - 1
        return f"of {others} other laws none has a fit" if others else "no other law was tried"
    alike = [n for n in found.alike if n != found.chosen.label]
    if len(alike) + 1 == fitted:
        return f"the {fitted} laws cannot be told apart by this data{_span(found, results)}"
    if alike:
        return f"this data cannot tell it from {listed(alike)}{_span(found, results)}"
    next_one, margin = min(
        ((n, d) for n, d in found.differences.items() if n != found.chosen.label), key=lambda pair: pair[1]
    )
    how = "prefer it to all others" if margin > REFUTED else "slightly prefer it to others"
    return f"the data {how} (next {next_one}, Akaike difference {significant(margin)})"


def _span(found: Comparison, results: Sequence[Calibration]) -> str:
    moduli = [r.shear_modulus / 1e3 for r in results if r.label in found.alike]
    low, high = significant(min(moduli), 4), significant(max(moduli), 4)
    return f" (G {low} to {high} kPa among them)" if low != high else ""


def rule() -> str:
    """How laws are called alike."""
    return (
        "The law with the lowest Akaike value (chi-square + 2 per constant) leads. The Akaike difference of"
        " another law is the difference of the two chi-squares, divided by the leading law's reduced"
        " chi-square where that is above 1, plus 2 for each constant more. Below"
        f" {ALIKE:g} the data cannot tell two laws apart; above {REFUTED:g} they speak clearly against"
        " the other law (Burnham and Anderson 2002). A negative difference means a law with"
        " fewer constants does as well."
    )


def blind(result: Calibration) -> list[str]:
    """Each direction that the data do not see, as a sentence."""
    return [f"{result.label}: {_direction(weights)}." for weights in result.blind]


def _direction(weights: Mapping[str, float]) -> str:
    if len(weights) == 1:
        name = spoken(next(iter(weights)))
        return f"the data do not see {name} at all: only its prior and its bounds say what it is"
    first = max(weights, key=lambda n: abs(weights[n]))
    sign = 1.0 if weights[first] > 0.0 else -1.0
    moves = [
        f"{spoken(n)} {'up' if sign * w > 0 else 'down'}"
        + ("" if n == first else f" by {significant(abs(w / weights[first]), 2)} as much of its range")
        for n, w in sorted(weights.items(), key=lambda pair: -abs(pair[1]))
    ]
    return f"the data do not see {listed(moves)} together: such moves cancel each other"


def troubles(results: Sequence[Calibration]) -> list[str]:
    """Fits that did not converge, each with what it says of itself."""
    return [
        f"{r.material}, {r.label}: {r.status}" + (f" ({r.message})" if r.message else "")
        for r in results
        if r.status != "converged"
    ]
