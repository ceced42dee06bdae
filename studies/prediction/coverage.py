"""Coverage of prediction intervals on made coupons: cases of the blind laboratory, trials left out.

    python -m studies.prediction.coverage --first 1 --cases 30 --out coverage.json
    python -m studies.prediction.coverage --first 1000 --cases 90 --given --out given.json
    python -m studies.prediction.coverage --show coverage.json ...

A case is one of `benchmarks.blind.coupons` (clean, one cause, two, or one outside the catalogue, in turn). Of
its trials one is left out, drawn among those of a material that another trial has; the others are diagnosed,
and `calibration.predict` predicts it. Counted are points within their 95 % intervals, of the model that is
named (the extension where there is one), and the skill. With --given the causes are stated in place of a
search (`--extend`), and clean cases and those outside the catalogue are left out: the intervals of the right
model. Seeds below 1000 were looked at while the intervals were made.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import calibration
from benchmarks.blind.coupons.cases import make_coupon, write
from benchmarks.blind.coupons.model import LIBRARY, OUTSIDE
from calibration.errors import InputError

KINDS = ("one", "one", "one", "clean", "two", "outside")


def drawn(seed: int, *, given: bool = False) -> dict[str, Any]:
    """One case, and what came of it."""
    kind = "one" if given else KINDS[seed % len(KINDS)]
    causes = LIBRARY if kind == "one" else OUTSIDE
    name = causes[(seed // len(KINDS)) % len(causes)] if kind in ("one", "outside") else ""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "case"
        write(make_coupon(seed, kind, name), place)
        experiment = calibration.read_experiment(next(place.rglob("experiment.yaml")).parent)
        left_out = _left_out(experiment, np.random.default_rng(seed))
        row: dict[str, Any] = {"seed": seed, "kind": kind, "cause": name, "left_out": left_out}
        if left_out is None:
            return row
        others = ",".join(t.id for t in experiment.trials if t.id != left_out)
        try:
            found = calibration.predict(
                experiment,
                calibrate=others,
                predict=left_out,
                extend=(name,) if given else (),
                workers=1,
                on_progress=lambda _: None,
            )
        except InputError as error:
            return {**row, "problem": str(error)}
    p = found.prediction
    model = p.models[-1]
    z = np.concatenate([r.error(model) / r.sd(model) for r in p.records])
    return {
        **row,
        "model": p.labels[model],
        "points": len(z),
        "coverage": p.coverage(p.records, model),
        "rms_z": float(np.sqrt(np.mean(z**2))),
        "baseline_coverage": p.coverage(p.records, "baseline"),
        "skill": p.skill(p.records),
        "specimen": p.records[0].specimen != p.records[0].material,
        "seconds": round(p.seconds, 1),
    }


def _left_out(experiment: calibration.experiment.Experiment, rng: np.random.Generator) -> str | None:
    materials = [t.material for t in experiment.trials]
    some = [t.id for t in experiment.trials if materials.count(t.material) > 1]
    return str(rng.choice(some)) if some else None


def show(rows: Sequence[dict[str, Any]]) -> None:
    """A line a kind of case, and one of all."""
    done = [r for r in rows if "coverage" in r]
    print("| cases | predicted | points in 95 % intervals | median rms z | median skill |")
    print("| --- | --- | --- | --- | --- |")
    for kind in (*dict.fromkeys(KINDS), "all"):
        mine = [r for r in done if kind in (r["kind"], "all")]
        if not mine:
            continue
        inside = sum(r["coverage"] * r["points"] for r in mine) / sum(r["points"] for r in mine)
        skills = [r["skill"] for r in mine if r["skill"] is not None]
        skill = f"{np.median(skills):.2f} ({len(skills)})" if skills else "-"
        print(
            f"| {kind} | {len(mine)} | {inside:.1%} | {np.median([r['rms_z'] for r in mine]):.2f} | {skill} |"
        )
    for r in rows:
        if "problem" in r:
            print(f"seed {r['seed']}: {r['problem']}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--cases", type=int, default=12)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--given", action="store_true")
    parser.add_argument("--show", type=Path, nargs="+")
    given = parser.parse_args()
    if given.show:
        show([row for path in given.show for row in json.loads(path.read_text(encoding="utf-8"))])
        return
    rows = []
    for seed in range(given.first, given.first + given.cases):
        rows.append(drawn(seed, given=given.given))
        print(rows[-1], flush=True)
        if given.out:
            given.out.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    show(rows)


if __name__ == "__main__":
    main()
