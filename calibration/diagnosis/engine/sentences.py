"""The verdict in sentences, for readers who have not read the documentation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.held_out import HeldOut
from calibration.diagnosis.engine.partly import Assessed
from calibration.diagnosis.engine.remainder import Remainder
from calibration.diagnosis.engine.search import Finding
from calibration.diagnosis.engine.shares import Interval
from calibration.measurements._effect import Candidate


def sentence(
    finding: Finding,
    chosen: Explanation | None,
    effects: Mapping[str, Any],
    *,
    unit: tuple[str, float],
    shares: Mapping[Candidate, Interval],
    share: Interval | None = None,
    held_out: HeldOut | None = None,
    nearest: Assessed | None = None,
    remainder: Remainder | None = None,
) -> str:
    """The verdict, in one or several sentences; the parameters are the attributes of `Diagnosis`."""
    if finding.verdict == "none":
        return "The simulation agrees with the measurements to within their noise: no cause to name."
    if finding.verdict == "unexplained":
        return _unexplained(nearest)
    assert chosen is not None
    named, short = _named(chosen, effects), " + ".join(chosen.names)
    if finding.verdict == "found":
        them = "it" if len(chosen.candidates) == 1 else "them"
        return (
            f"Found: {named} ({short}). With {them} the simulation agrees with the measurements to within"
            f" their noise{_skill(held_out, 'it explains ')}."
        )
    if finding.verdict == "partly explained":
        text = _partly(finding, chosen, effects, share, held_out)
        if finding.doubt:
            return f"{text} Only noise remains, but the cause is not called found, since {finding.doubt}."
        return f"{text} {what_remains(remainder, unit)}" if remainder is not None else text
    sets, common = finding.equivalent, finding.certain
    if common:
        first = " and ".join(effects[n].sentence for n in common)
        rest = _or([" + ".join(n for n in s if n not in common) for s in sets])
        takes = _takes(shares, common)
        other = (
            "There is another, smaller cause" if _most(shares, common) else "There is another, larger cause"
        )
        return (
            f"Found in part: {first} ({' + '.join(common)}{takes}). {other}, which these data cannot"
            f" identify: {rest}."
        )
    others = "; or ".join(" + ".join(names) for names in sets[1:])
    return f"There is a cause, but these data cannot identify it: most likely {named} ({short}); or {others}."


def _takes(shares: Mapping[Candidate, Interval], names: Sequence[str]) -> str:
    """Clause with the explained fraction of one cause; "" if `names` are several candidates."""
    own = [s for c, s in shares.items() if c.effect in names]
    return f", {percent(own[0])} of the misfit beyond noise" if len(own) == 1 else ""


def _most(shares: Mapping[Candidate, Interval], names: Sequence[str]) -> bool:
    """True if these causes remove at least half of what all named causes remove."""
    own = sum(s.value for c, s in shares.items() if c.effect in names)
    return 2.0 * own >= sum(s.value for s in shares.values())


def _partly(
    finding: Finding,
    chosen: Explanation,
    effects: Mapping[str, Any],
    share: Interval | None,
    held_out: HeldOut | None,
) -> str:
    sets, common = finding.equivalent, finding.certain
    fraction = "" if share is None else percent(share)
    takes = f"which explains {fraction} of the misfit beyond noise{_skill(held_out)}."
    if len(sets) == 1:
        text = f"Partly explained: {_named(chosen, effects)} ({' + '.join(chosen.names)}), {takes}"
    elif common:
        # what all explanations share comes first: it is what these data do tell
        first = " and ".join(effects[n].sentence for n in common)
        rest = [" + ".join(n for n in s if n not in common) for s in sets]
        text = (
            f"Partly explained: {first} ({' + '.join(common)}), together with {_or(rest)}, which these data"
            f" cannot separate; with {rest[0]} it explains {takes.removeprefix('which explains ')}"
        )
    else:
        others = _or([" + ".join(s) for s in sets[1:]])
        text = (
            f"Partly explained, by one of several causes that these data cannot separate: most likely"
            f" {_named(chosen, effects)} ({' + '.join(chosen.names)}), {takes} The others: {others}."
        )
    return text


def _or(names: Sequence[str]) -> str:
    known = [n for n in dict.fromkeys(names) if n]
    return known[0] if len(known) == 1 else f"{', '.join(known[:-1])} or {known[-1]}"


def _unexplained(nearest: Assessed | None) -> str:
    text = (
        "The measurements differ from the simulation by more than noise, and no cause in the library can be"
        " named."
    )
    if nearest is None:
        return f"{text} Inspect the residuals."
    names = " + ".join(nearest.explanation.names)
    skill = _skill(nearest.held_out)
    why = f" It is not named, because {'; and '.join(nearest.against)}." if nearest.against else ""
    return (
        f"{text} The nearest is {names}, which would explain {percent(nearest.share)} of the misfit beyond"
        f" noise{skill}.{why}"
    )


def what_remains(left: Remainder, unit: tuple[str, float]) -> str:
    """Size, location and repeatability of the unexplained misfit; `unit` is that of `Diagnosis.unit`."""
    if left.rms == 0.0:
        return "Only noise remains."
    size = f"{unit[1] * left.rms:.3g} {unit[0]}"
    if left.of_full_scale is not None:
        size += f" rms, {100.0 * left.of_full_scale:.2g} % of full scale"
    parts = []
    if left.place:
        parts.append(f"most of it at {left.place}")
    if left.records:
        parts.append(f"more than half of it in {_few(left.records)}")
    where = f" ({'; '.join(parts)})" if parts else ""
    again = {
        "everywhere": "repeats in all of them",
        "within a material": "repeats within each material",
        "within a specimen": "repeats within a specimen, but not between specimens",
        "nowhere": "differs from test to test",
        "not known": "may or may not repeat, since no test was repeated",
    }[left.repeats]
    small = " This is negligible in practice." if left.negligible else ""
    return f"The remaining misfit, {size}{where}, {again}.{small}"


def percent(share: Interval) -> str:
    """Explained fraction in percent, clipped to 0 to 100, with its interval if that is finite.

    100 is written only of a fraction of 1: beside it stands the misfit that is left.
    """

    def part(x: float) -> str:
        value = 100.0 * min(max(x, 0.0), 1.0)
        return f"{value:.0f}" if value == 100.0 or value < 99.5 else f"{min(value, 99.9):.1f}"

    if not (math.isfinite(share.low) and math.isfinite(share.high)):
        return f"{part(share.value)} %"
    return f"{part(share.value)} % [{part(share.low)}, {part(share.high)}]"


def _skill(held_out: HeldOut | None, takes: str = "") -> str:
    """Final clause of a sentence with the held-out skill, introduced by `takes`; "" if there is no skill."""
    if held_out is None or not held_out.held_out or not math.isfinite(held_out.skill):
        return ""
    if held_out.skill <= 0.0:
        return f", and {takes}nothing in held-out measurements"
    whole = " of the misfit beyond noise" if takes else ""
    part = f"{100.0 * min(held_out.skill, 1.0):.0f} %{whole}"
    worse = len(held_out.worse)
    but = f" (though {worse} of {len(held_out.parts)} parts no better)" if worse else ""
    return f", and {takes}{part} in held-out measurements{but}"


def _named(chosen: Explanation, effects: Mapping[str, Any]) -> str:
    parts = [
        f"{effects[c.effect].sentence}{'' if c.at == 'all' else f' ({c.at})'}" for c in chosen.candidates
    ]
    return " and ".join(parts) if len(parts) < 3 else f"{'; '.join(parts[:-1])}; and {parts[-1]}"


def _few(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) < 4 else f"{', '.join(names[:3])} and {len(names) - 3} more"
