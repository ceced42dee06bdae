"""Make the blind beam experiments: true silhouettes and their truths, stored compactly.

    python -m benchmarks.blind.beams.make --cases 200 --seed 2026
    python -m benchmarks.blind.beams.make --survey --seed 7 --smallest 6 --largest 15 --out FOLDER

An interrupted run resumes. Noise is drawn when an experiment is written (`experiment.py`).
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.blind.beams.cases import Case, draw, resized, solve_case, stiff_enough
from benchmarks.blind.beams.detectability import FLOOR, sigmas
from benchmarks.blind.beams.effects import EFFECTS, OUTSIDE
from benchmarks.blind.beams.ideal_beams import Table, table
from benchmarks.blind.beams.model import Resolution
from benchmarks.blind.beams.solver import NoEquilibriumError
from benchmarks.blind.beams.store import CASES, load_case, load_truth, save_case

Plan = list[tuple[str, tuple[str, ...]]]


def plan(cases: int, seed: int) -> Plan:
    """Category and effects of each case.

    A quarter are clean, a tenth have a wrong density alone, a tenth an effect outside the library, a tenth
    two effects, the rest one; effects occur about equally often.
    """
    rng = np.random.default_rng([seed, 0])
    counts = {
        "clean": round(0.25 * cases),
        "density": round(0.1 * cases),
        "outside": round(0.1 * cases),
        "two": round(0.1 * cases),
    }
    counts["single"] = cases - sum(counts.values())
    made: Plan = []
    for category, count in counts.items():
        names = list(OUTSIDE) if category == "outside" else list(EFFECTS)
        turn: list[str] = []
        while len(turn) < count:
            turn += [str(n) for n in rng.permutation(names)]
        for k in range(count):
            effects: tuple[str, ...] = ()
            if category in ("single", "outside"):
                effects = (turn[k],)
            elif category == "two":
                pair = rng.choice([n for n in names if n != "compressibility"], 2, replace=False)
                effects = (str(pair[0]), str(pair[1]))
            made.append((category, effects))
    return [made[k] for k in rng.permutation(cases)]


def survey() -> Plan:
    """One case per effect of the library, one clean, one with a wrong density, one outside the library."""
    made: Plan = [("single", (name,)) for name in EFFECTS]
    return [*made, ("clean", ()), ("density", ()), ("outside", ("shadow",))]


def make_case(
    index: int,
    seed: int,
    category: str,
    effects: tuple[str, ...],
    sizes: tuple[float, float],
    kept: Table,
    resolution: Resolution,
) -> tuple[Case, np.ndarray, dict[str, float]]:
    """A case, its edges and its sizes; amplitudes are corrected once towards their targets."""
    case = stiff_enough(draw(index, seed, category, effects, sizes))
    edges = solve_case(case, kept, resolution)
    if not effects:
        return case, edges, {}
    found = _sizes(case, edges, kept, resolution)
    wanted = tuple(
        h.amplitude * float(np.clip(h.target / max(found[h.effect], 0.1), 0.15, 6.0)) for h in case.hidden
    )
    case = stiff_enough(resized(case, wanted))
    edges = solve_case(case, kept, resolution)
    return case, edges, _sizes(case, edges, kept, resolution)


def _sizes(case: Case, edges: np.ndarray, kept: Table, resolution: Resolution) -> dict[str, float]:
    """Sizes [sigma] of each effect beside the others, and of all together ("total")."""
    total = sigmas(case, edges, kept)
    if len(case.hidden) == 1:
        return {case.hidden[0].effect: total, "total": total}
    sizes = {"total": total}
    for k, hidden in enumerate(case.hidden):
        without = replace(case, hidden=case.hidden[:k] + case.hidden[k + 1 :])
        other = solve_case(without, kept, resolution)
        sizes[hidden.effect] = sigmas(case, edges, kept, against=(without, other))
    return sizes


def recount(folder: Path, kept: Table, resolution: Resolution) -> None:
    """Compute the sizes anew of cases that were computed with another noise floor."""
    for key, entry in load_truth(folder)["cases"].items():
        if entry.get("floor") == FLOOR:
            continue
        case, edges = load_case(folder, int(key))
        sizes = _sizes(case, edges, kept, resolution) if case.hidden else {}
        save_case(folder, case, edges, sizes)
        print(f"{key} {entry['sigma']} -> {sizes}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--survey", action="store_true", help="each effect once instead of --cases")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--smallest", type=float, default=3.0, help="smallest size aimed at, in sigmas")
    parser.add_argument("--largest", type=float, default=20.0)
    parser.add_argument("--out", type=Path, default=CASES)
    parser.add_argument("--recount", action="store_true", help="count the kept cases' sigmas anew")
    given = parser.parse_args()
    wanted = survey() if given.survey else plan(given.cases, given.seed)
    truth = load_truth(given.out)
    if truth["seed"] not in (None, given.seed):
        print(f"{given.out}: expected seed {truth['seed']} to go on, got {given.seed}", file=sys.stderr)
        return 2
    resolution = Resolution()
    kept = table(given.out / "table.npz", resolution)
    if given.recount:
        recount(given.out, kept, resolution)
        return 0
    failed = 0
    for index, (category, effects) in enumerate(wanted):
        if f"{index:03d}" in truth["cases"]:
            continue
        start = time.process_time()
        try:
            case, edges, sizes = make_case(
                index, given.seed, category, effects, (given.smallest, given.largest), kept, resolution
            )
        except (NoEquilibriumError, ValueError, np.linalg.LinAlgError) as error:
            failed += 1
            print(f"{index:03d} {category} {effects}: not made: {str(error)[:160]}", flush=True)
            continue
        save_case(given.out, case, edges, sizes)
        found = ", ".join(f"{name} {size:.1f}" for name, size in sizes.items())
        print(f"{index:03d} {category} {found} ({time.process_time() - start:.1f} core-s)", flush=True)
    print(f"{failed} cases not made")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
