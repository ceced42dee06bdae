"""Negative controls, and follow-up experiments that a diagnosis advises.

Controls: the true cause is removed from the catalogue, or the outlines are exchanged among the materials. A
diagnosis that names causes on grounds other than the data fails them. Advice: the advised experiment is
simulated and diagnosed together with the first.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from benchmarks.blind.beams.cases import Case
from benchmarks.blind.beams.follow_up import GAUGES, POSES, measure, new_id, photograph_again
from benchmarks.blind.beams.scores import Goal, Scored
from benchmarks.blind.under_test import Diagnoser, Verdict, pose_of

LEAST = 5.0  # sigmas: smaller effects too often remain undetected
LENGTHS = 3


def without_truth(case: Scored) -> bool:
    """True for cases of the first control: one effect of at least LEAST sigmas, in the named set."""
    return case.truth["category"] == "single" and case.sigma >= LEAST and case.in_the_set


def shuffled(case: Scored) -> bool:
    """True for cases of the second control: those of the first whose true effect was ranked first."""
    return without_truth(case) and case.named == case.effects


def shuffle_materials(folder: Path) -> None:
    """Exchange the outlines among the materials in an experiment's folder.

    Outlines of the first length stay, those of the second move to the next material, those of the third to
    the one after that. No material then has its own outlines of all lengths, under any permutation of the
    names.
    """
    path = folder / "experiment.yaml"
    experiment = yaml.safe_load(path.read_text(encoding="utf-8"))
    trials = experiment["trials"]
    captures = [t["captures"] for t in trials]
    for k, trial in enumerate(trials):
        material, length = divmod(k, LENGTHS)
        source = LENGTHS * ((material + length) % (len(trials) // LENGTHS)) + length
        assert trials[source]["free_length_mm"] == trial["free_length_mm"]
        trial["captures"] = captures[source]
    path.write_text(yaml.safe_dump(experiment, sort_keys=False), encoding="utf-8")


def control_goals(
    cases: Mapping[str, Scored], without: Mapping[str, Verdict], mixed: Mapping[str, Verdict]
) -> list[Goal]:
    """Goals of both controls.

    `without` holds verdicts with the true effect removed from the catalogue, `mixed` with the materials
    shuffled.
    """
    first = {k: Scored(cases[k].truth, diagnosis) for k, diagnosis in without.items() if k in cases}
    second = {k: Scored(cases[k].truth, diagnosis) for k, diagnosis in mixed.items() if k in cases}
    unnamed = sum(c.verdict == "unexplained" for c in first.values())
    held = sum(excused(cases[k], c) for k, c in first.items())
    alone = sum(c.verdict == "found" and not excused(cases[k], c) for k, c in first.items())
    kept = sum(c.named == cases[k].named for k, c in second.items())
    return [
        ("truth not in the library: unexplained or a listed alternative", "100 %", held, len(first)),
        ("truth not in the library: unexplained", "-", unnamed, len(first)),
        ("truth not in the library: another name, alone", "0 %", alone, len(first)),
        ("materials shuffled: the old name comes first", "0 %", kept, len(second)),
    ]


def excused(full: Scored, now: Scored) -> bool:
    """True if the diagnosis without the true cause is acceptable.

    It is if it is `unexplained` or `partly explained`, or names what the full diagnosis listed as an
    alternative.
    """
    if now.verdict in ("unexplained", "partly explained"):
        return True
    listed = {tuple(sorted(names)) for names in full.diagnosis["alternatives"]}
    return bool(now.named) and now.named in listed


def control_table(
    cases: Mapping[str, Scored], without: Mapping[str, Verdict], mixed: Mapping[str, Verdict]
) -> str:
    """Counts of the diagnoses by control and true cause."""
    lines = []
    for what, verdicts in (("truth not in the library", without), ("materials shuffled", mixed)):
        rows: dict[str, Counter[str]] = {}
        for key, diagnosis in verdicts.items():
            if key not in cases:
                continue
            now = Scored(cases[key].truth, diagnosis)
            name = "+".join(now.named) + ("*" if now.verdict == "ambiguous" else "") or now.verdict
            rows.setdefault("+".join(cases[key].effects), Counter())[name] += 1
        lines += [f"{what}:"] if rows else []
        for effect, counts in sorted(rows.items()):
            shown = ", ".join(f"{name} {count}" for name, count in counts.most_common())
            lines.append(f"  {effect:30} {shown}")
    return "\n".join(lines)


# first words of the advice in `next_experiment`, by experiment
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


def advised(diagnosis: Verdict) -> str | None:
    """Name of the experiment advised first; None if the diagnosis states that the catalogue has none.

    ValueError if the advice is not one of SENTENCES.
    """
    text = diagnosis.get("next_experiment") or ""
    if text.startswith(NOTHING):
        return None
    (name,) = [n for n, begins in SENTENCES.items() if text.startswith(begins)] or [""]
    if not name:
        raise ValueError(f"advice that the lab does not understand: {text[:80]!r}")
    return name


def asked(case: Scored) -> bool:
    """True for cases whose advice is followed: the ambiguous ones."""
    return case.verdict == "ambiguous"


def follow(case: Case, diagnosis: Verdict, folder: Path, finder: Diagnoser) -> dict[str, Any]:
    """Simulate the experiment advised for `case`, add it to that in `folder`, and diagnose again.

    Returns {"advice": its name or None, "entered": effects whose readings were entered in the experiment,
    "without": effects removed from the catalogue, "not_made": trials that could not be made, "diagnosis": the
    new one, None without advice}.
    """
    name = advised(diagnosis)
    answer: dict[str, Any] = {"advice": name, "entered": [], "without": [], "not_made": [], "diagnosis": None}
    if name in GAUGES:
        alternatives = [tuple(names) for names in diagnosis["alternatives"]]
        entered, out = measure(case, name, alternatives, folder)
        answer |= {"entered": list(entered), "without": sorted({*entered, *out})}
        answer["diagnosis"] = finder(folder, without=answer["without"])
    elif name in POSES:
        answer["not_made"] = photograph_again(case, name, folder)
        new = {new_id(t.id, name) for t in case.trials}
        answer["diagnosis"] = finder(folder, pose=pose_of(name, new))
    return answer


def settled(case: Scored, answer: Mapping[str, Any]) -> bool:
    """True if the new verdict agrees with the truth.

    It must name exactly the hidden effects without those whose measured values were entered, or be `none` if
    no effect is left, or `unexplained` for a cause outside the library.
    """
    if answer["diagnosis"] is None:
        return False
    now = Scored(case.truth, answer["diagnosis"])
    if case.truth["category"] == "outside":
        return now.verdict == "unexplained"
    hidden = () if case.truth["category"] in ("clean", "density") else case.effects
    left = tuple(name for name in hidden if name not in answer["entered"])
    return now.verdict == ("found" if left else "none") and now.named == left


def advice_goals(cases: Mapping[str, Scored], answers: Mapping[str, Mapping[str, Any]]) -> list[Goal]:
    """Goals of the ambiguous cases whose advised experiment was simulated."""
    some = [(cases[k], t) for k, t in answers.items() if k in cases]
    rows: list[Goal] = [_part("ambiguous, advised experiment made: settled", "90 %", some)]
    for what, categories in (
        ("one effect", ("single",)),
        ("two effects", ("two",)),
        ("outside the library: unexplained then", ("outside",)),
        ("clean, or density alone: none then", ("clean", "density")),
    ):
        rows.append(_part(f"  {what}", "-", [s for s in some if s[0].truth["category"] in categories]))
    two = [(c, t) for c, t in some if c.truth["category"] == "two" and t["diagnosis"]]
    one_of = sum(_one_of_two(Scored(c.truth, t["diagnosis"])) for c, t in two)
    rows.append(("  two effects: one of them found alone", "-", one_of, len(two)))
    here = [s for s in some if s[0].in_the_set]
    rows.append(_part("  where the truth was in the named set", "90 %", here))
    return rows


def advice_table(cases: Mapping[str, Scored], answers: Mapping[str, Mapping[str, Any]]) -> str:
    """One line per case, and how often each experiment settled the case that it was advised for."""
    lines, right, made = [], Counter[str](), Counter[str]()
    for key, t in answers.items():
        if key not in cases:
            continue
        case, name = cases[key], t["advice"] or "nothing"
        made[name] += 1
        right[name] += settled(case, t)
        now = Scored(case.truth, t["diagnosis"]) if t["diagnosis"] else None
        new = f"{now.verdict} {'+'.join(now.named)}" if now else "-"
        true = "+".join(case.effects) or case.truth["category"]
        alternatives = ", ".join("+".join(names) for names in case.diagnosis["alternatives"])
        lines.append(f"{key} {true}: {alternatives}; {name}: {new}{', settled' if settled(case, t) else ''}")
        if t["not_made"]:
            lines.append(f"    not made: {'; '.join(t['not_made'])}")
    lines += [f"{name:20} settled {right[name]} of {count}" for name, count in made.most_common()]
    return "\n".join(lines)


def _one_of_two(now: Scored) -> bool:
    return now.verdict == "found" and len(now.named) == 1 and now.named[0] in now.effects


def _part(what: str, goal: str, some: list[tuple[Scored, Mapping[str, Any]]]) -> Goal:
    return what, goal, sum(settled(c, t) for c, t in some), len(some)
