"""A made poke experiment as a lab writes it down: noise and all, without the truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from _blind_poke_case import Case
from _blind_poke_curve import force, table
from _blind_record_case import write_yaml


def write(case: Case, folder: Path, *, noise: float = 1.0) -> None:
    """experiment.yaml and its records, without the truth. noise: part of the stated noise that is in them."""
    rng = np.random.default_rng([case.seed, 1])
    (folder / "pokes").mkdir(parents=True)
    trials: list[dict[str, Any]] = []
    for t in case.trials:
        moved = replace(t, touch=noise * t.depth_sd * float(rng.standard_normal()))
        time, depth, _ = t.path()
        shown = depth + noise * t.depth_sd * rng.standard_normal(len(depth))
        f = force(moved, case.hidden) + noise * t.force_sd * rng.standard_normal(len(depth))
        rows = "\n".join(
            f"{a:.6g},{1e3 * b:.6g},{c:.6g}" for a, b, c in zip(time + 1.0, shown, f, strict=True)
        )
        name = f"pokes/{t.id}.csv"
        (folder / name).write_text(f"time_s,depth_mm,force_N\n{rows}\n")
        setup = table()[t.base]["setup"]
        entry: dict[str, Any] = {
            "id": t.id,
            "kind": "poke",
            "material": t.material,
            "block_mm": [100.0, 100.0, setup["height"]],
            "rod": {"radius_mm": setup["rod"], "tip": setup["tip"]},
            "start_mm": [0.0, 0.0, setup["height"]],
            "direction": [0.0, 0.0, -1.0],
            "record": name,
            "force_sd_N": t.force_sd,
            "depth_sd_mm": 1e3 * t.depth_sd,
        }
        if setup["cylinder"]:
            radius, below, above = setup["cylinder"]
            centre = [0.0, 0.0, 0.5 * (below + above)]
            shape = {"radius_mm": radius, "height_mm": above - below, "centre_mm": centre}
            entry["inclusion"] = {"cylinder": shape}
        trials.append(entry)
    write_yaml(folder, f"pokes {case.seed}", [t.material for t in case.trials], trials)
