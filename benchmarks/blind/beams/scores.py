"""Scores of verdicts on blind cases: confusion matrix, goals with their counts, scopes of the causes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from benchmarks.blind.beams.cases import trial_names
from benchmarks.blind.beams.effects import EFFECTS, OUTSIDE, PARAMETER

Truth = dict[str, Any]
Names = tuple[str, ...]


@dataclass(frozen=True)
class Scored:
    """A case: its truth (an entry of truth.json) and its diagnosis (a diagnosis.json)."""

    truth: Truth
    diagnosis: dict[str, Any]

    @property
    def effects(self) -> Names:
        return tuple(sorted(h["effect"] for h in self.truth["hidden"]))

    @property
    def sigma(self) -> float:
        """Size of the weakest hidden effect."""
        sizes = self.truth["sigma"]
        return float(min((sizes[name] for name in self.effects), default=0.0))

    @property
    def verdict(self) -> str:
        return str(self.diagnosis["verdict"])

    @property
    def named(self) -> Names:
        """Effects ranked first; () if none is named."""
        if self.verdict not in ("found", "ambiguous"):
            return ()
        return tuple(sorted(c["effect"] for c in self.diagnosis["causes"]))

    @property
    def in_the_set(self) -> bool:
        if not self.named:
            return False
        return self.effects in {self.named, *(tuple(sorted(a)) for a in self.diagnosis["alternatives"])}

    def amplitudes(self) -> list[tuple[float, float, float]]:
        """(true, found, standard deviation) of each effect; empty unless the right effects are first."""
        if not self.effects or self.named != self.effects:
            return []
        found = []
        for hidden in self.truth["hidden"]:
            name = PARAMETER[hidden["effect"]][0] if hidden["effect"] in PARAMETER else None
            cause = next(c for c in self.diagnosis["causes"] if c["effect"] == hidden["effect"])
            if name in cause["parameters"]:
                estimate = cause["parameters"][name]
                found.append((hidden["parameters"][name], estimate["value"], estimate["sd"]))
        return found

    def moduli(self) -> list[float]:
        """Relative errors of the extended model's shear moduli.

        They are compared at the density that the lab states, since a beam determines only the ratio of
        modulus and density.
        """
        moduli = (self.diagnosis.get("extended") or {}).get("shear_modulus_Pa", {})
        errors = []
        names = trial_names(per_beam=self.truth["per_beam"])
        for key, value in moduli.items():
            for level in ("specimen", "material"):
                own = [k for k, n in enumerate(names) if n[level] == key]
                if own:
                    truth = np.mean([self.truth["mu"][k] for k in own])
                    weighed = self.truth["stated"][names[own[0]]["material"]] / self.truth["density"][own[0]]
                    errors.append(float(value / (truth * weighed) - 1))
                    break
        return errors


Goal = tuple[str, str, int, int]


def goals(cases: list[Scored]) -> list[Goal]:
    """(description, goal, count, total) of each goal; sizes are those of truth.json, in sigmas."""
    one = [c for c in cases if c.truth["category"] == "single"]
    two = [c for c in cases if c.truth["category"] == "two"]
    clean = [c for c in cases if c.truth["category"] == "clean"]
    density = [c for c in cases if c.truth["category"] == "density"]
    outside = [c for c in cases if c.truth["category"] == "outside" and c.sigma >= 10]
    five, seven = ([c for c in one if c.sigma >= least] for least in (5, 7))
    found: list[Goal] = [
        _part("one effect, >= 5 sigma: noticed", "-", five, lambda c: c.verdict != "none"),
        _part("one effect, >= 5 sigma: ranked first", "95 %", five, lambda c: c.named == c.effects),
        _part("one effect, >= 7 sigma: ranked first", "98 %", seven, lambda c: c.named == c.effects),
        _part("one effect, >= 5 sigma: in the named set", "97 %", five, lambda c: c.in_the_set),
        _part(
            "one effect, >= 5 sigma, where a cause is named: in the named set",
            "97 %",
            [c for c in five if c.named],
            lambda c: c.in_the_set,
        ),
        _part("one effect, any size: unique and wrong", "<= 1 %", one, _unique_and_wrong),
        _part("two effects: both named first", "-", two, lambda c: c.named == c.effects),
        _part("two effects: in the named set", "-", two, lambda c: c.in_the_set),
        _part("two effects: one of them named", "-", two, lambda c: bool({*c.named} & {*c.effects})),
        _part("clean: false alarms (a cause named)", "<= 5 %", clean, lambda c: bool(c.named)),
        _part("clean: any verdict but none", "<= 5 %", clean, lambda c: c.verdict != "none"),
        _part("density alone: anything named", "0 %", density, lambda c: bool(c.named)),
        _part("density alone: weighing advised", "100 %", density, _weighing),
        _part(
            "outside the library, >= 10 sigma: unexplained, in part or ambiguous",
            "90 %",
            outside,
            lambda c: c.verdict in ("unexplained", "partly explained", "ambiguous"),
        ),
        _part(
            "outside the library, >= 10 sigma: one confident name",
            "<= 5 %",
            outside,
            lambda c: c.verdict == "found",
        ),
    ]
    away = [abs(found - true) / sd if sd > 0 else np.inf for c in cases for true, found, sd in c.amplitudes()]
    found.append(("amplitude within 3 standard deviations", "97 %", sum(a <= 3 for a in away), len(away)))
    found.append(("amplitude within its 95 % interval", "90 %", sum(a <= 1.96 for a in away), len(away)))
    right = [c for c in [*one, *two] if c.effects == c.named]
    errors = [e for c in right for e in c.moduli()]
    found.append(("shear moduli within 2 %", "100 %", sum(abs(e) <= 0.02 for e in errors), len(errors)))
    seconds = [c.diagnosis["seconds"] for c in cases]
    found.append(("diagnosed within 5 minutes", "100 %", sum(s <= 300 for s in seconds), len(seconds)))
    found.append(("diagnosed within 1 minute", "-", sum(s <= 60 for s in seconds), len(seconds)))
    return found


def confusion(cases: list[Scored]) -> str:
    """Table by true effect: cases, named alone, named first among several, and what was named instead."""
    order = ["clean", "density", *EFFECTS, *OUTSIDE, "two"]
    rows: dict[str, list[Scored]] = {}
    for case in cases:
        category = case.truth["category"]
        key = case.effects[0] if category in ("single", "outside") else category
        rows.setdefault(key, []).append(case)
    lines = [f"{'truth':30} {'cases':>5} {'alone':>5} {'first':>5}  named instead (* among alternatives)"]
    for key in sorted(rows, key=order.index):
        alone = sum(c.verdict == "found" and c.named == c.effects for c in rows[key])
        first = sum(c.verdict == "ambiguous" and c.named == c.effects for c in rows[key])
        other = Counter(
            ("+".join(c.named) or c.verdict) + ("*" if c.verdict == "ambiguous" else "")
            for c in rows[key]
            if not c.named or c.named != c.effects
        )
        instead = ", ".join(f"{name} {count}" for name, count in other.most_common())
        lines.append(f"{key:30} {len(rows[key]):5} {alone:5} {first:5}  {instead}")
    return "\n".join(lines)


def by_size(cases: list[Scored]) -> str:
    """Table of single effects of the library by size: noticed, first, in the named set, unique and wrong."""
    edges = [0, 3, 5, 7, 10, 15, np.inf]
    lines = [f"{'sigma':>8} {'cases':>5} {'noticed':>7} {'first':>5} {'in set':>6} {'wrong':>5}"]
    for low, high in pairwise(edges):
        some = [c for c in cases if c.truth["category"] == "single" and low <= c.sigma < high]
        counts = (
            sum(c.verdict != "none" for c in some),
            sum(c.named == c.effects for c in some),
            sum(c.in_the_set for c in some),
            sum(_unique_and_wrong(c) for c in some),
        )
        lines.append(
            f"{low:>3}-{high:<4} {len(some):5} {counts[0]:7} {counts[1]:5} {counts[2]:6} {counts[3]:5}"
        )
    return "\n".join(lines)


def _unique_and_wrong(case: Scored) -> bool:
    return case.verdict == "found" and case.named != case.effects


def _weighing(case: Scored) -> bool:
    texts = [case.diagnosis.get("next_experiment") or ""]
    texts += [
        str(e.get("instead", "")) for e in case.diagnosis.get("not_visible", []) if e["effect"] == "density"
    ]
    return any("weigh" in text.lower() for text in texts)


def _part(what: str, goal: str, cases: Iterable[Scored], holds: Callable[[Scored], bool]) -> Goal:
    kept = list(cases)
    return what, goal, sum(holds(c) for c in kept), len(kept)


# indices of `ideal_beams.LENGTHS` that an effect can act on; other effects: all
ACTS_ON = {"free-length": (0, 1), "added-mass": (0, 1), "clamp-gap": (2,)}
KINDS = {"all": "all beams", "bridges": "all beams"}


def beams_in(scope: str, effect: str, *, per_beam: bool) -> frozenset[int]:
    """Indices of the trials that an effect acts on in a scope: all, a material, a specimen or a trial.

    ValueError if the scope is none of these.
    """
    names = trial_names(per_beam=per_beam)
    there = {k for k, n in enumerate(names) if scope in ("all", n["material"], n["specimen"], n["id"])}
    if not there:
        raise ValueError(f"scope {scope}: expected all, a material, a specimen or a trial")
    return frozenset(k for k in there if names[k]["kind"] in ACTS_ON.get(effect, (0, 1, 2)))


def scopes(case: Scored) -> list[tuple[str, frozenset[int], frozenset[int]]]:
    """(carrier, true trials, named trials) of each effect; empty unless the right effects are ranked first.

    The carrier is "all beams", "one material" or "one beam".
    """
    if not case.effects or case.named != case.effects:
        return []
    found = []
    for hidden in case.truth["hidden"]:
        (cause,) = (c for c in case.diagnosis["causes"] if c["effect"] == hidden["effect"])
        kinds = ACTS_ON.get(hidden["effect"], (0, 1, 2))
        true = frozenset(k for k in hidden["trials"] if k % 3 in kinds)
        named = beams_in(cause["scope"], hidden["effect"], per_beam=case.truth["per_beam"])
        carrier = KINDS.get(hidden["scope"], "one beam" if len(hidden["trials"]) == 1 else "one material")
        found.append((carrier, true, named))
    return found


def scope_goals(cases: Sequence[Scored]) -> list[Goal]:
    """Counts of cases in which the named beams are the right ones: of all, and by carrier of the effect."""
    found = [s for c in cases for s in scopes(c)]
    rows: list[Goal] = [("named rightly: in the right beams", "-", _right(found), len(found))]
    for carrier in ("all beams", "one material", "one beam"):
        some = [s for s in found if s[0] == carrier]
        rows.append((f"  of those in {carrier}", "-", _right(some), len(some)))
    touched = sum(bool(true & named) for _, true, named in found)
    rows.append(("named rightly: in some of the right beams", "-", touched, len(found)))
    return rows


def _right(found: Sequence[tuple[str, frozenset[int], frozenset[int]]]) -> int:
    return sum(true == named for _, true, named in found)
