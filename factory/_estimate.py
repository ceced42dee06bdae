"""What a build will take: from the ledger of the run so far, else from measured defaults."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from factory._parts import building_folder, read_ledger
from factory.plan import Plan

# Measured with Ogden on 2 cores: 12 core-s a poke to 10 mm (recipe quick), 55 s to the end, which came at
# 24 mm on average (recipe sample, asked for 30 mm). What lies deep is dear.
NODES = 5_500
SECONDS_TO_10_MM = 12.0
GROWTH = 1.4  # the power of the depth asked for that joins the two
FRAMES_PER_MM = 0.65  # frames kept a millimetre asked for: most pokes end before the whole depth
SURFACE_NODES = 1_700
_COMPRESSED = 0.85


@dataclass(frozen=True)
class Estimate:
    """nodes: of a mesh; poke_seconds: core time of one poke; seconds: wall time of what is missing;
    size: bytes of the store; missing: pokes still to do; measured: poke_seconds came from this build."""

    nodes: int
    poke_seconds: float
    seconds: float
    size: float
    missing: int
    measured: bool


def estimate(plan: Plan, target: Path, workers: int) -> Estimate:
    """Time and size to expect; a rough guess, said to be one."""
    folder = building_folder(target)
    ledger = read_ledger(folder / "ledger.jsonl")
    walls = [float(entry["wall_seconds"]) for entry in ledger.values() if not entry.get("error")]
    asked = plan.recipe.protocol.depth_mm / 10.0
    each = fmean(walls) if walls else SECONDS_TO_10_MM * asked**GROWTH
    done = len(list((folder / "parts").glob("poke-*.npz")))
    missing = max(len(plan.pokes) - done, 0)
    frames = FRAMES_PER_MM * plan.recipe.protocol.depth_mm / plan.recipe.protocol.frame_spacing_mm
    frame_bytes = 12 * (1024 + SURFACE_NODES) + 200
    return Estimate(
        nodes=NODES,
        poke_seconds=each,
        seconds=missing * each / min(workers, max(missing, 1)),
        size=len(plan.pokes) * (frames * frame_bytes * _COMPRESSED + 60e3),
        missing=missing,
        measured=bool(walls),
    )
