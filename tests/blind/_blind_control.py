"""Negative controls: the true cause taken out of the catalogue, and outlines handed to other materials.

A finder that names by more than the data would fail them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import yaml
from _blind_finder import Said
from _blind_score import Goal, Scored

LEAST = 5.0  # sigmas: smaller effects are too often not seen at all
LENGTHS = 3


def without_truth(case: Scored) -> bool:
    """Cases of the first control: one effect of the library, in the set that was named."""
    return case.truth["category"] == "single" and case.sigma >= LEAST and case.in_the_set


def shuffled(case: Scored) -> bool:
    """Cases of the second: the right name came first."""
    return without_truth(case) and case.named == case.effects


def shuffle_materials(folder: Path) -> None:
    """Hand the outlines on among the materials in an experiment's folder: those of the first length stay,
    those of the second go to the next material, those of the third to the one after that. Then no material
    has its own outlines of all lengths, under any renaming."""
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
    cases: Mapping[str, Scored], without: Mapping[str, Said], mixed: Mapping[str, Said]
) -> list[Goal]:
    """without: verdicts with the true effect out of the catalogue; mixed: with the materials shuffled."""
    first = {k: Scored(cases[k].truth, said) for k, said in without.items() if k in cases}
    second = {k: Scored(cases[k].truth, said) for k, said in mixed.items() if k in cases}
    unnamed = sum(c.verdict == "unexplained" for c in first.values())
    held = sum(excused(cases[k], c) for k, c in first.items())
    alone = sum(c.verdict == "found" and not excused(cases[k], c) for k, c in first.items())
    kept = sum(c.named == cases[k].named for k, c in second.items())
    return [
        ("truth not in the library: unexplained or a listed rival", "100 %", held, len(first)),
        ("truth not in the library: unexplained", "-", unnamed, len(first)),
        ("truth not in the library: another name, alone", "0 %", alone, len(first)),
        ("materials shuffled: the old name comes first", "0 %", kept, len(second)),
    ]


def excused(full: Scored, now: Scored) -> bool:
    """Whether what is said without the truth was a rival of it already, or is `unexplained`."""
    if now.verdict == "unexplained":
        return True
    listed = {tuple(sorted(names)) for names in full.said["alternatives"]}
    return bool(now.named) and now.named in listed


def control_table(cases: Mapping[str, Scored], without: Mapping[str, Said], mixed: Mapping[str, Said]) -> str:
    """How often what was said, by control and true cause."""
    lines = []
    for what, verdicts in (("truth not in the library", without), ("materials shuffled", mixed)):
        rows: dict[str, Counter[str]] = {}
        for key, said in verdicts.items():
            if key not in cases:
                continue
            now = Scored(cases[key].truth, said)
            name = "+".join(now.named) + ("*" if now.verdict == "ambiguous" else "") or now.verdict
            rows.setdefault("+".join(cases[key].effects), Counter())[name] += 1
        lines += [f"{what}:"] if rows else []
        for effect, counts in sorted(rows.items()):
            told = ", ".join(f"{name} {count}" for name, count in counts.most_common())
            lines.append(f"  {effect:30} {told}")
    return "\n".join(lines)
