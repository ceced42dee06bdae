"""The experiment that a diagnosis advises, made by the lab, and what the diagnosis says then."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from _blind_cases import Case
from _blind_finder import Finder, Said
from _blind_gauge import GAUGES, measure
from _blind_repeat import POSES, new_id, photograph_again
from _blind_score import Goal, Scored

# how the advice for each begins, in `next_experiment`
SENTENCES = {
    "weigh": "weigh the specimens",
    "callipers": "measure the section with callipers",
    "level": "lay a spirit level on the clamp",
    "gauge-block": "measure the free lengths and the distance of the clamps",
    "turn-over": "turn the beams by 180 degrees",
    "swap-ends": "swap the ends of the beams",
    "hang": "hang the cantilevers straight down",
    "other-length": "photograph cantilevers of 75 mm",
    "tip-mass": "hang 5 g on the free end",
    "later": "photograph the beams again 2.8 h",
    "metal-bar": "clamp a metal bar instead of a beam",
    "lens": "calibrate the camera's lens",
    "cut": "cut the beam open",
}
NOTHING = "no experiment of the catalogue"


def advised(said: Said) -> str | None:
    """The experiment that is advised first; None where the diagnosis knows of none. ValueError where the lab
    does not understand it."""
    text = said.get("next_experiment") or ""
    if text.startswith(NOTHING):
        return None
    (name,) = [n for n, begins in SENTENCES.items() if text.startswith(begins)] or [""]
    if not name:
        raise ValueError(f"advice that the lab does not understand: {text[:80]!r}")
    return name


def asked(case: Scored) -> bool:
    """Cases whose advice is tried."""
    return case.verdict == "ambiguous"


def follow(case: Case, said: Said, folder: Path, finder: Finder) -> dict[str, Any]:
    """Make the advised experiment of `case`, whose experiment is in `folder`, and diagnose all again.

    {"advice": its name or None, "entered": effects whose readings are in the experiment now, "without": what
    was taken out of the catalogue, "not_made": trials, "said": the new diagnosis, None without advice}
    """
    name = advised(said)
    told: dict[str, Any] = {"advice": name, "entered": [], "without": [], "not_made": [], "said": None}
    if name in GAUGES:
        alternatives = [tuple(names) for names in said["alternatives"]]
        entered, out = measure(case, name, alternatives, folder)
        told |= {"entered": list(entered), "without": sorted({*entered, *out})}
        told["said"] = finder(folder, without=told["without"])
    elif name in POSES:
        told["not_made"] = photograph_again(case, name, folder)
        new = {new_id(t.id, name) for t in case.trials}
        told["said"] = finder(folder, pose=_only_in(name, new))
    return told


def _only_in(name: str, trials: set[str]) -> Callable[[Any, Any], Any]:
    """What the diagnosis takes a pose to be, in the new trials only."""
    from calibration.diagnosis.beams.experiments import EXPERIMENTS, Photographs

    (design,) = [e for e in EXPERIMENTS if e.name == name]
    assert isinstance(design, Photographs)

    def posed(beam: Any, trial: Any) -> Any:
        return design.pose(beam, trial) if trial.id in trials else beam

    return posed


def settled(case: Scored, told: Mapping[str, Any]) -> bool:
    """Whether the new verdict is the truth: the hidden effects alone, but for those whose measured values are
    in the experiment now; `none` where nothing is left to be named, `unexplained` outside the library."""
    if told["said"] is None:
        return False
    now = Scored(case.truth, told["said"])
    if case.truth["category"] == "outside":
        return now.verdict == "unexplained"
    hidden = () if case.truth["category"] in ("clean", "density") else case.effects
    left = tuple(name for name in hidden if name not in told["entered"])
    return now.verdict == ("found" if left else "none") and now.named == left


def advice_goals(cases: Mapping[str, Scored], told: Mapping[str, Mapping[str, Any]]) -> list[Goal]:
    """Of the ambiguous cases whose advised experiment was made."""
    some = [(cases[k], t) for k, t in told.items() if k in cases]
    rows: list[Goal] = [_part("ambiguous, advised experiment made: settled", "90 %", some)]
    for what, categories in (
        ("one effect", ("single",)),
        ("two effects", ("two",)),
        ("outside the library: unexplained then", ("outside",)),
        ("clean, or density alone: none then", ("clean", "density")),
    ):
        rows.append(_part(f"  {what}", "-", [s for s in some if s[0].truth["category"] in categories]))
    two = [(c, t) for c, t in some if c.truth["category"] == "two" and t["said"]]
    one_of = sum(_one_of_two(Scored(c.truth, t["said"])) for c, t in two)
    rows.append(("  two effects: one of them found alone", "-", one_of, len(two)))
    here = [s for s in some if s[0].in_the_set]
    rows.append(_part("  where the truth was in the named set", "90 %", here))
    return rows


def advice_table(cases: Mapping[str, Scored], told: Mapping[str, Mapping[str, Any]]) -> str:
    """Each case, and how often each experiment settled what it was advised for."""
    lines, right, made = [], Counter[str](), Counter[str]()
    for key, t in told.items():
        if key not in cases:
            continue
        case, name = cases[key], t["advice"] or "nothing"
        made[name] += 1
        right[name] += settled(case, t)
        now = Scored(case.truth, t["said"]) if t["said"] else None
        said = f"{now.verdict} {'+'.join(now.named)}" if now else "-"
        true = "+".join(case.effects) or case.truth["category"]
        rivals = ", ".join("+".join(names) for names in case.said["alternatives"])
        lines.append(f"{key} {true}: {rivals}; {name}: {said}{', settled' if settled(case, t) else ''}")
        if t["not_made"]:
            lines.append(f"    not made: {'; '.join(t['not_made'])}")
    lines += [f"{name:20} settled {right[name]} of {count}" for name, count in made.most_common()]
    return "\n".join(lines)


def _one_of_two(now: Scored) -> bool:
    return now.verdict == "found" and len(now.named) == 1 and now.named[0] in now.effects


def _part(what: str, goal: str, some: list[tuple[Scored, Mapping[str, Any]]]) -> Goal:
    return what, goal, sum(settled(c, t) for c, t in some), len(some)
