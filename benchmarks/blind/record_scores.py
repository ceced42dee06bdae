"""Scores of verdicts on synthetic homogeneous tests and indentations: confusion matrix, goals, and the runs.

Verdicts are those of `under_test.diagnose_*`, truths those of `records.truth_of`.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

from benchmarks.blind.records import SEVERAL
from benchmarks.whole import write_whole

# parameter of an effect in diagnosis.json, and number of its units in one SI unit; only for
# effects whose amplitude is defined alike on both sides (not the size of a loop of undetermined shape)
UNITS = {
    "rate-dependence": ("per_decade", 1.0),
    "anisotropy": ("fibre_excess", 1.0),
    "strain-offset": ("offset_percent", 100.0),
    "machine-compliance": ("strain_per_MPa", 1e6),
    "platen-friction": ("mu_d_over_3h", 1.0),
    "strain-stiffening": ("c2_over_c1", 1.0),
    "second-invariant": ("c01_share", 1.0),
    "limited-extensibility": ("one_over_locking_stretch_squared", 1.0),
    "depth-offset": ("offset_mm", 1e3),
    "force-gain": ("excess_percent", 100.0),
    "force-offset": ("offset_N", 1.0),
    "force-drift": ("drift_mN_per_s", 1e3),
    "adhesion": ("pull_mN", 1e3),
    "inclusion-debonded": ("loose_part", 1.0),
}
# kinds of cases without an identifiable cause, and the accepted rate of named causes
ALARMS = {"clean": "at most 5 %", "trap": "0"}
Pair = tuple[dict[str, Any], dict[str, Any]]
Row = tuple[str, str, str]


def true_names(truth: dict[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(e["effect"] for e in truth["effects"]))


def named(verdict: dict[str, Any]) -> tuple[str, ...]:
    return tuple(sorted(c["effect"] for c in verdict["causes"]))


def named_set(verdict: dict[str, Any]) -> list[tuple[str, ...]]:
    return [tuple(sorted(a)) for a in verdict["alternatives"]] or [named(verdict)]


def sigma(truth: dict[str, Any]) -> float:
    return min((float(e["sigma"]) for e in truth["effects"]), default=0.0)


def part(hits: Sequence[bool]) -> str:
    """Count of hits of the total, as text."""
    return f"{sum(hits)} of {len(hits)}" + (f" ({100 * sum(hits) / len(hits):.0f} %)" if hits else "")


def goals(pairs: Sequence[Pair]) -> Iterator[Row]:
    """(description, goal, reached) of each goal."""
    yield from _naming(pairs)
    yield from _numbers([p for p in pairs if p[0]["kind"] == "one"])


def _naming(pairs: Sequence[Pair]) -> Iterator[Row]:
    single = [p for p in pairs if p[0]["kind"] == "one"]
    for least, goal in ((5.0, "95 %"), (7.0, "98 %")):
        some = [p for p in single if sigma(p[0]) >= least]
        right = [named(v) == true_names(t) for t, v in some]
        yield f"ranked first, {least:g} sigmas and above", goal, part(right)
    for what, some in (
        ("5 sigmas and above", [p for p in single if sigma(p[0]) >= 5.0]),
        ("of those named", [p for p in single if p[1]["causes"]]),
    ):
        held = [true_names(t) in named_set(v) for t, v in some]
        yield f"truth in the named set, {what}", "97 %", part(held)
    wrong = [v["verdict"] == "found" and named(v) != true_names(t) for t, v in single]
    yield "a unique and wrong name", "at most 1 %", part(wrong)
    for kind, goal in ALARMS.items():
        alarms = [v["verdict"] != "none" for t, v in pairs if t["kind"] == kind]
        if alarms:
            yield f"something named or unexplained: {kind}", goal, part(alarms)
    out = [v["verdict"] for t, v in pairs if t["kind"] == "outside" and sigma(t) >= 10.0]
    unsure = [verdict in ("unexplained", "partly explained", "ambiguous") for verdict in out]
    yield "outside the library, 10 sigmas: unexplained, in part or ambiguous", "90 %", part(unsure)
    alone = [verdict == "found" for verdict in out]
    yield "outside the library, 10 sigmas: one name", "at most 5 %", part(alone)
    for kind in SEVERAL:
        some = [p for p in pairs if p[0]["kind"] == kind]
        if some:
            yield f"{kind} at once: all first", "-", part([named(v) == true_names(t) for t, v in some])
            held = [true_names(t) in named_set(v) for t, v in some]
            yield f"{kind} at once: all in the named set", "-", part(held)
            only = [set(named(v)) <= set(true_names(t)) for t, v in some if v["verdict"] == "found"]
            yield f"{kind} at once: of those found, no wrong name among them", "-", part(only)


def _numbers(single: Sequence[Pair]) -> Iterator[Row]:
    """Goals of rightly named causes: amplitudes, moduli, held-out gain."""
    right = [p for p in single if named(p[1]) == true_names(p[0])]
    off = list(_deviations(right))
    yield "amplitude within 3 of its sd", "97 %", part([abs(d) <= 3.0 for d in off])
    yield "95 % interval covers", "90 %", part([abs(d) <= 1.96 for d in off])
    wrong = [
        abs(math.log(v["extended"]["shear_modulus_Pa"][m] / g))
        for t, v in right
        for m, g in t["shear_modulus_Pa"].items()
    ]
    yield "shear moduli within 2 % after extension", "all", part([w < 0.02 for w in wrong])
    yield "  within 5 %: twice the mesh error that pokes state", "-", part([w < 0.05 for w in wrong])
    gained = [v["gain"] for t, v in right if sigma(t) >= 10.0 and v["gain"]["held_out"] != "none"]
    fell = [g["rms_after"] < 0.7 * g["rms_before"] for g in gained]
    yield "held-out rms falls by 30 %, 10 sigmas and above", "all", part(fell)
    beyond = [_beyond(g, "rms_after") < 0.7 * _beyond(g, "rms_before") for g in gained]
    yield "the same beyond the noise", "all", part(beyond)
    likelier = [g["log_likelihood"] > 0.0 for g in gained]
    yield "held-out likelihood grows, 10 sigmas and above", "-", part(likelier)


def _deviations(right: Sequence[Pair]) -> Iterator[float]:
    """(amplitude - truth) / sd of each cause in UNITS."""
    for t, v in right:
        (effect,) = t["effects"]
        if effect["effect"] in UNITS:
            parameter, per_si = UNITS[effect["effect"]]
            estimate = v["causes"][0]["parameters"][parameter]
            yield (estimate["value"] - per_si * effect["amplitude"]) / estimate["sd"]


def _beyond(gain: dict[str, Any], which: str) -> float:
    """Excess of a held-out rms over that of the noise."""
    return math.sqrt(max(gain[which] ** 2 - gain["rms_noise"] ** 2, 0.0))


def confusion(pairs: Sequence[Pair]) -> str:
    """One line per true cause, with the counts of the diagnoses."""
    lines: dict[str, Counter[str]] = {}
    for t, v in pairs:
        truth = f"{t['kind']} at once" if t["kind"] in SEVERAL else "+".join(true_names(t)) or "(clean)"
        if v["verdict"] in ("none", "unexplained"):
            answer = v["verdict"]
        else:
            answer = "right" if named(v) == true_names(t) else "+".join(named(v))
            answer += "" if v["verdict"] == "found" else f" ({v['verdict']})"
        lines.setdefault(truth, Counter())[answer] += 1
    width = max(len(n) for n in lines)
    return "\n".join(
        f"{truth:{width}}  " + ", ".join(f"{answer} {n}" for answer, n in counts.most_common())
        for truth, counts in sorted(lines.items())
    )


class Made(Protocol):
    """A case with its truth."""

    def truth(self) -> dict[str, Any]: ...


C = TypeVar("C", bound=Made)


def diagnosed(
    cases: Iterable[tuple[int, C]],
    write: Callable[[C, Path], None],
    verdict_on: Callable[[Path], dict[str, Any]],
    *,
    show_each: bool,
) -> list[Pair]:
    """(truth, verdict) of each numbered case; only `write` has access to the case."""
    pairs: list[Pair] = []
    for n, case in cases:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place) / "experiment"
            write(case, folder)
            began = time.process_time()
            diagnosis = verdict_on(folder)
            seconds = time.process_time() - began
        truth = case.truth()
        pairs.append((truth, diagnosis))
        if show_each:
            _print_case(n, truth, diagnosis, seconds)
    return pairs


def _print_case(n: int, truth: dict[str, Any], diagnosis: dict[str, Any], seconds: float) -> None:
    sizes = ", ".join(f"{e['sigma']:.1f} {e['scope']}" for e in truth["effects"])
    cost = f", {diagnosis['simulated']} pokes simulated" if "simulated" in diagnosis else ""
    print(
        f"{n:3d} {truth['kind']} {'+'.join(true_names(truth)) or '-'} [{sizes}]: {diagnosis['verdict']}"
        f" {'+'.join(c['label'] for c in diagnosis['causes'])} {diagnosis['alternatives'][1:]}"
        f" {seconds:.1f} core-s{cost}",
        flush=True,
    )
    if named(diagnosis) != true_names(truth):
        print(f"      lack of fit {diagnosis['lack_of_fit']}, tried {diagnosis['tried'][:4]}", flush=True)


def parser(about: str | None) -> argparse.ArgumentParser:
    found = argparse.ArgumentParser(description=about)
    found.add_argument("--cases", type=int, default=40)
    found.add_argument("--seed", type=int, default=1)
    found.add_argument("--out", type=Path, help="JSON file for truths and verdicts")
    found.add_argument("--together", choices=list(SEVERAL), help="so many causes at once, in all cases")
    return found


def show(pairs: list[Pair], out: Path | None) -> None:
    """Print the confusion matrix and the goals; write the pairs to `out` if given."""
    if out:
        write_whole(out, json.dumps([{"truth": t, "verdict": v} for t, v in pairs], indent=1))
    print()
    print(confusion(pairs))
    print()
    for what, goal, reached in goals(pairs):
        print(f"{what:60} goal {goal:12} {reached}")
