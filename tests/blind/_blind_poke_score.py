"""What a set of verdicts on made pokes is worth: the confusion matrix, and the goals that it bears on.

verdicts: `diagnosis.json` of each case; truths: as `Case.truth` tells them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from _blind_coupon_score import Pair, confusion, named, named_set, part, sigma, true_names

__all__ = ["Pair", "confusion", "goals", "named", "named_set", "true_names"]

# the parameter that diagnosis.json writes for an effect, and how many of its units make one SI unit
UNITS = {
    "depth-offset": ("offset_mm", 1e3),
    "force-gain": ("excess_percent", 100.0),
    "force-offset": ("offset_N", 1.0),
    "force-drift": ("drift_mN_per_s", 1e3),
    "adhesion": ("pull_mN", 1e3),
    "inclusion-debonded": ("loose_part", 1.0),
}


def goals(pairs: Sequence[Pair]) -> Iterator[tuple[str, str, str]]:
    """(what, goal, reached)."""
    single = [p for p in pairs if p[0]["kind"] == "one"]
    for least, goal in ((5.0, "95 %"), (7.0, "98 %")):
        some = [p for p in single if sigma(p[0]) >= least]
        right = [named(v) == true_names(t) for t, v in some]
        yield f"ranked first, {least:g} sigmas and above", goal, part(right)
    seen = [p for p in single if p[1]["causes"]]
    yield (
        "truth in the named set, of those named",
        "97 %",
        part([true_names(t) in named_set(v) for t, v in seen]),
    )
    wrong = [v["verdict"] == "found" and named(v) != true_names(t) for t, v in single]
    yield "a unique and wrong name", "at most 1 %", part(wrong)
    for kind, goal in (("clean", "at most 5 %"), ("trap", "0")):
        alarms = [v["verdict"] != "none" for t, v in pairs if t["kind"] == kind]
        yield f"something named or unexplained: {kind}", goal, part(alarms)
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
    rightly = [p for p in single if named(p[1]) == true_names(p[0])]
    within = []
    for t, v in rightly:
        moduli = v["extended"]["shear_modulus_Pa"]
        within += [abs(math.log(moduli[m] / g)) for m, g in t["shear_modulus_Pa"].items()]
    yield "shear modulus within 2 % after extension", "all", part([w < 0.02 for w in within])
    yield "  within 5 %: twice the mesh error that is stated", "-", part([w < 0.05 for w in within])
    gained = [v["gain"] for t, v in rightly if sigma(t) >= 10.0 and v["gain"]["held_out"] != "none"]
    yield (
        "held-out rms falls by 30 %, 10 sigmas and above",
        "all",
        part([g["rms_after"] < 0.7 * g["rms_before"] for g in gained]),
    )
    yield (
        "held-out likelihood grows, 10 sigmas and above",
        "-",
        part([g["log_likelihood"] > 0.0 for g in gained]),
    )


def _deviations(single: Sequence[Pair]) -> Iterator[float]:
    """(amplitude - truth) / sd of rightly named causes whose amplitude means the same on both sides."""
    for t, v in single:
        name = t["effects"][0]["effect"]
        if named(v) != (name,) or name not in UNITS:
            continue
        parameter, per_si = UNITS[name]
        estimate = v["causes"][0]["parameters"][parameter]
        yield (estimate["value"] - per_si * t["effects"][0]["amplitude"]) / estimate["sd"]
