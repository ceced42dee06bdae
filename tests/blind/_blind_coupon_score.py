"""What a set of verdicts on made coupons is worth: the confusion matrix, and the goals that it bears on.

verdicts: `diagnosis.json` of each case; truths: as `Case.truth` tells them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

# the parameter that diagnosis.json writes for an effect, and how many of its units make one SI unit
UNITS = {
    "rate-dependence": ("per_decade", 1.0),
    "hysteresis": ("unloading_loss", 1.0),
    "mullins": ("softening", 1.0),
    "anisotropy": ("fibre_excess", 1.0),
    "strain-offset": ("offset_percent", 100.0),
    "machine-compliance": ("strain_per_MPa", 1e6),
    "platen-friction": ("mu_d_over_3h", 1.0),
    "strain-stiffening": ("c2_over_c1", 1.0),
    "second-invariant": ("c01_share", 1.0),
    "limited-extensibility": ("one_over_locking_stretch_squared", 1.0),
}
# what these amplitudes mean differs with the shape of a loop, which a name does not settle
SHAPED = ("hysteresis", "mullins")
Pair = tuple[dict[str, Any], dict[str, Any]]


def true_names(truth: dict[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(e["effect"] for e in truth["effects"]))


def named(verdict: dict[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(c["effect"] for c in verdict["causes"]))


def named_set(verdict: dict[str, Any]) -> list[tuple[str, ...]]:
    return [tuple(sorted(a)) for a in verdict["alternatives"]] or [named(verdict)]


def sigma(truth: dict[str, Any]) -> float:
    return min((float(e["sigma"]) for e in truth["effects"]), default=0.0)


def part(hits: Sequence[bool]) -> str:
    """hits of all, as text."""
    return f"{sum(hits)} of {len(hits)}" + (f" ({100 * sum(hits) / len(hits):.0f} %)" if hits else "")


def goals(pairs: Sequence[Pair]) -> Iterator[tuple[str, str, str]]:
    """(what, goal, reached)."""
    single = [p for p in pairs if p[0]["kind"] == "one"]
    for least, goal in ((5.0, "95 %"), (7.0, "98 %")):
        some = [p for p in single if sigma(p[0]) >= least]
        yield (
            f"ranked first, {least:g} sigmas and above",
            goal,
            part([named(v) == true_names(t) for t, v in some]),
        )
    some = [p for p in single if sigma(p[0]) >= 5.0]
    yield (
        "truth in the named set, 5 sigmas and above",
        "97 %",
        part([true_names(t) in named_set(v) for t, v in some]),
    )
    seen = [p for p in single if p[1]["causes"]]
    yield (
        "truth in the named set, of those named",
        "97 %",
        part([true_names(t) in named_set(v) for t, v in seen]),
    )
    wrong = [v["verdict"] == "found" and named(v) != true_names(t) for t, v in single]
    yield "a unique and wrong name", "at most 1 %", part(wrong)
    clean = [v["verdict"] != "none" for t, v in pairs if t["kind"] == "clean"]
    yield "false alarms on clean data", "at most 5 %", part(clean)
    out = [p for p in pairs if p[0]["kind"] == "outside" and sigma(p[0]) >= 10.0]
    yield (
        "outside the library, 10 sigmas: unexplained or ambiguous",
        "90 %",
        part([v["verdict"] in ("unexplained", "ambiguous") for _, v in out]),
    )
    yield (
        "outside the library, 10 sigmas: one name",
        "at most 5 %",
        part([v["verdict"] == "found" for _, v in out]),
    )
    two = [p for p in pairs if p[0]["kind"] == "two"]
    yield "two at once: both first", "-", part([named(v) == true_names(t) for t, v in two])
    yield "two at once: both in the named set", "-", part([true_names(t) in named_set(v) for t, v in two])
    off = list(_deviations(single))
    yield "amplitude within 3 of its sd", "97 %", part([abs(d) <= 3.0 for d in off])
    yield "95 % interval covers", "90 %", part([abs(d) <= 1.96 for d in off])
    right = [p for p in single if named(p[1]) == true_names(p[0])]
    yield "shear modulus within 2 % after extension", "all", part([_modulus(t, v) for t, v in right])
    gained = [p[1]["gain"] for p in right if sigma(p[0]) >= 10.0 and p[1]["gain"]["held_out"] != "none"]
    yield (
        "held-out rms falls by 30 %, 10 sigmas and above",
        "all",
        part([g["rms_after"] < 0.7 * g["rms_before"] for g in gained]),
    )
    yield (
        "the same beyond the noise",
        "all",
        part([_beyond(g, "rms_after") < 0.7 * _beyond(g, "rms_before") for g in gained]),
    )
    yield (
        "held-out likelihood grows, 10 sigmas and above",
        "-",
        part([g["log_likelihood"] > 0.0 for g in gained]),
    )


def _deviations(single: Sequence[Pair]) -> Iterator[float]:
    """(amplitude - truth) / sd of rightly named causes whose scope is right."""
    for t, v in single:
        name = t["effects"][0]["effect"]
        if named(v) != (name,) or name in SHAPED:
            continue
        cause = v["causes"][0]
        parameter, per_si = UNITS[name]
        estimate = cause["parameters"][parameter]
        yield (estimate["value"] - per_si * t["effects"][0]["amplitude"]) / estimate["sd"]


def _modulus(truth: dict[str, Any], verdict: dict[str, Any]) -> bool:
    known = truth["shear_modulus_Pa"]
    found = verdict["extended"]["shear_modulus_Pa"]
    return all(abs(math.log(found[m] / g)) < 0.02 for m, g in known.items())


def _beyond(gain: dict[str, Any], which: str) -> float:
    """What a held-out rms has beyond that of the noise."""
    return math.sqrt(max(gain[which] ** 2 - gain["rms_noise"] ** 2, 0.0))


def confusion(pairs: Sequence[Pair]) -> str:
    """One line a true cause: how often it was named what."""
    lines: dict[str, Counter[str]] = {}
    for t, v in pairs:
        truth = "two at once" if t["kind"] == "two" else "+".join(true_names(t)) or "(clean)"
        if v["verdict"] in ("none", "unexplained"):
            said = v["verdict"]
        else:
            said = "right" if named(v) == true_names(t) else "+".join(named(v))
            said += " (ambiguous)" if v["verdict"] == "ambiguous" else ""
        lines.setdefault(truth, Counter())[said] += 1
    width = max(len(n) for n in lines)
    return "\n".join(
        f"{truth:{width}}  " + ", ".join(f"{said} {n}" for said, n in counts.most_common())
        for truth, counts in sorted(lines.items())
    )
