"""Where a named cause is said to sit, against where it was put: compared as the beams that it acts on."""

from __future__ import annotations

from collections.abc import Sequence

from _blind_cases import trial_names
from _blind_score import Goal, Scored

# indices of `_blind_table.LENGTHS` that an effect has anything to act on; others: all
ACTS_ON = {"free-length": (0, 1), "added-mass": (0, 1), "clamp-gap": (2,)}
KINDS = {"all": "all beams", "bridges": "all beams"}


def beams_in(scope: str, effect: str, *, per_beam: bool) -> frozenset[int]:
    """Trials (by index) that an effect acts on in a scope: all, a material, a specimen or a trial."""
    names = trial_names(per_beam=per_beam)
    there = {k for k, n in enumerate(names) if scope in ("all", n["material"], n["specimen"], n["id"])}
    if not there:
        raise ValueError(f"scope {scope}: expected all, a material, a specimen or a trial")
    return frozenset(k for k in there if names[k]["kind"] in ACTS_ON.get(effect, (0, 1, 2)))


def scopes(case: Scored) -> list[tuple[str, frozenset[int], frozenset[int]]]:
    """(what carries it: all beams, a material or a beam; true trials; named ones) of each effect, where the
    right effects come first."""
    if not case.effects or case.named != case.effects:
        return []
    found = []
    for hidden in case.truth["hidden"]:
        (cause,) = (c for c in case.said["causes"] if c["effect"] == hidden["effect"])
        kinds = ACTS_ON.get(hidden["effect"], (0, 1, 2))
        true = frozenset(k for k in hidden["trials"] if k % 3 in kinds)
        said = beams_in(cause["scope"], hidden["effect"], per_beam=case.truth["per_beam"])
        carrier = KINDS.get(hidden["scope"], "one beam" if len(hidden["trials"]) == 1 else "one material")
        found.append((carrier, true, said))
    return found


def scope_goals(cases: Sequence[Scored]) -> list[Goal]:
    """How often the beams are the right ones: all together, and by what carries the fault."""
    found = [s for c in cases for s in scopes(c)]
    rows: list[Goal] = [("named rightly: in the right beams", "-", _right(found), len(found))]
    for carrier in ("all beams", "one material", "one beam"):
        some = [s for s in found if s[0] == carrier]
        rows.append((f"  of those in {carrier}", "-", _right(some), len(some)))
    touched = sum(bool(true & said) for _, true, said in found)
    rows.append(("named rightly: in some of the right beams", "-", touched, len(found)))
    return rows


def _right(found: Sequence[tuple[str, frozenset[int], frozenset[int]]]) -> int:
    return sum(true == said for _, true, said in found)
