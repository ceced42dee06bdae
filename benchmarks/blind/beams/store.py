"""Clean silhouettes and truths on disk, in separate files: edges.npz and truth.json in one folder."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.cases import TIMES, Case, Hidden, Trial, trial_names
from benchmarks.blind.beams.detectability import FLOOR
from benchmarks.whole import whole_file, write_whole

Array = NDArray[np.float64]
CASES = Path(__file__).parent / "data" / "cases"  # the 200 stored ones
SURVEY = Path(__file__).parent / "data" / "survey"  # each effect once, 6 to 15 sigmas
_OF_TRIALS = {"mu": 1, "density": 2, "length": 7, "radius": 7}  # name: decimals


def load_truth(folder: Path) -> dict[str, Any]:
    """Content of truth.json: {"seed", "cases": {index: ...}}; without cases if there is no file."""
    path = folder / "truth.json"
    if not path.exists():
        return {"seed": None, "cases": {}}
    truth: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return truth


def save_case(folder: Path, case: Case, edges: Array, sizes: dict[str, float]) -> None:
    """Save edges, then the truth: a case counts as made once truth.json names it."""
    folder.mkdir(parents=True, exist_ok=True)
    key = f"{case.index:03d}"
    kept = _load_edges(folder)
    # photographs of beams that do not change over time are stored once
    still = bool((edges == edges[:, :1]).all())
    kept[key] = (edges[:, :1] if still else edges).astype(np.float32)
    with whole_file(folder / "edges.npz") as file:
        np.savez(file, allow_pickle=False, **kept)
    truth = load_truth(folder)
    truth["seed"] = case.seed
    truth["cases"][key] = {
        "category": case.category,
        "per_beam": case.per_beam,
        "stated": {name: round(value, 2) for name, value in case.stated.items()},
        "hidden": [asdict(h) | {"parameters": h.parameters()} for h in case.hidden],
        "sigma": {name: round(size, 2) for name, size in sizes.items()},
        "floor": FLOOR,
    } | {
        name: [round(float(getattr(t, name)), digits) for t in case.trials]
        for name, digits in _OF_TRIALS.items()
    }
    lines = ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in sorted(truth["cases"].items()))
    text = f'{{"seed": {truth["seed"]}, "cases": {{\n{lines}\n}}}}\n'
    write_whole(folder / "truth.json", text)


def load_case(folder: Path, index: int) -> tuple[Case, Array]:
    """A case and its clean silhouettes (trials, photographs, 2, POINTS, 2) [m].

    Its `dice` are not stored (they are 0): their effect is in the silhouettes.
    """
    truth = load_truth(folder)
    entry = truth["cases"][f"{index:03d}"]
    trials = tuple(
        Trial(**names, **{name: entry[name][k] for name in _OF_TRIALS})
        for k, names in enumerate(trial_names(per_beam=entry["per_beam"]))
    )
    hidden = tuple(_hidden(h) for h in entry["hidden"])
    case = Case(
        index=index,
        seed=truth["seed"],
        category=entry["category"],
        per_beam=entry["per_beam"],
        trials=trials,
        stated=entry["stated"],
        hidden=hidden,
        dice=np.zeros((len(trials), len(TIMES))),
    )
    with np.load(folder / "edges.npz") as kept:
        edges = kept[f"{index:03d}"].astype(np.float64)
    return case, np.broadcast_to(edges, (edges.shape[0], len(TIMES), *edges.shape[2:]))


def _hidden(entry: dict[str, Any]) -> Hidden:
    own = {f.name: entry[f.name] for f in fields(Hidden)}
    return Hidden(**own | {"trials": tuple(own["trials"])})


def _load_edges(folder: Path) -> dict[str, Any]:
    path = folder / "edges.npz"
    if not path.exists():
        return {}
    with np.load(path) as kept:
        return dict(kept.items())
