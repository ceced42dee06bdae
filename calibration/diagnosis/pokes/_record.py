"""A poke's record, thinned, with what its history was: phases, the deepest depth before, the cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.coupons import relative_sd, scatter_scale
from calibration.diagnosis.pokes._geometry import Geometry, geometry_of
from calibration.diagnosis.pokes._phases import Phase, phases_of
from calibration.diagnosis.pokes._smooth import smooth_depth
from calibration.diagnosis.records import bins
from calibration.experiment.model import PokeTrial
from calibration.pokes import approach, block_names

Array = NDArray[np.float64]

MOST = 50  # points that are kept of a phase: more are averaged in bins of neighbours

_ARRAYS = (
    "time",
    "depth",
    "force",
    "count",
    "own_sd",
    "depth_error",
    "phase",
    "kind",
    "peak",
    "turn",
    "cycle",
    "begun",
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """The points of one trial, in the order in which they were measured; all arrays (k,).

    blocks: names of its block, by size and with its material. depth [m]: from first touch, negative above the
    surface. force [N] along the rod. across (k, 2) [N]: the force across it, along `Geometry.across`; None
    where the lab has no vectors. own_sd [N]: of the force,
    without what the depth's error adds; count: of samples in each point. depth_sd [m]: of one sample, and of
    the touch. phase: number of the phase, labels name them; kind: +1 loading, 0 hold, -1 unloading. cycle:
    which loading, from 1. peak [m]: the deepest that this specimen was poked at this site before and up to
    the point; turn [m]: the deepest of its cycle up to there; begun: whether an unloading has happened there
    before. time [s]. estimated: the lab states no error of the force.
    """

    name: str
    material: str
    specimen: str
    blocks: tuple[str, str]
    geometry: Geometry
    time: Array
    depth: Array
    force: Array
    across: Array | None
    count: Array
    own_sd: Array
    depth_error: Array
    depth_sd: float
    phase: Array
    labels: tuple[str, ...]
    degrees: tuple[int, ...]
    kind: Array
    cycle: Array
    peak: Array
    turn: Array
    begun: Array
    estimated: bool

    @property
    def points(self) -> int:
        return self.time.size

    @property
    def rod(self) -> str:
        return f"rod {1e3 * self.geometry.rod.radius:g} mm {self.geometry.rod.tip}"

    def only(self, kept: NDArray[np.bool_]) -> Record:
        """Some of its points. The force of what relaxes needs all that came before."""
        arrays = {name: getattr(self, name)[kept] for name in _ARRAYS}
        across = None if self.across is None else self.across[kept]
        return replace(self, across=across, **arrays)


def records_of(trials: Sequence[PokeTrial]) -> list[Record]:
    """One record a trial. Pokes of one named specimen at one place were done in the order of the file, so
    that a later one remembers how deep those before went."""
    found: list[Record] = []
    seen: dict[object, float] = {}
    for t in trials:
        geometry = geometry_of(t)
        own = (t.specimen, geometry.site) if t.specimen else t.id
        record = _record(t, geometry, seen.get(own, 0.0))
        found.append(record)
        seen[own] = max(seen.get(own, 0.0), float(record.peak.max()))
    return found


def _record(trial: PokeTrial, geometry: Geometry, before: float) -> Record:
    raw = trial.record
    phases = phases_of(trial)
    depth, degrees = smooth_depth(raw.time, raw.depth, phases, trial.depth_sd)
    depth = depth - approach(trial)
    peak = np.maximum.accumulate(np.maximum(depth, before))
    begun = np.full(depth.size, float(before > 0.0))
    turn = np.empty(depth.size)
    for c in {p.cycle for p in phases}:
        mine = np.concatenate([np.arange(p.points.start, p.points.stop) for p in phases if p.cycle == c])
        turn[mine] = np.maximum.accumulate(np.maximum(depth[mine], 0.0))
    unloading = [p for p in phases if p.kind == "unloading"]
    if unloading:
        begun[unloading[0].points.start :] = 1.0
    own = (
        np.full(depth.size, trial.force_sd)
        if trial.force_sd is not None
        else relative_sd(raw.time, raw.force) * scatter_scale(raw.force)
    )
    across = None if raw.force_vector is None else raw.force_vector @ geometry.across.T
    columns: dict[str, list[Array]] = {name: [] for name in (*_ARRAYS, "across")}
    for n, p in enumerate(phases):
        first, count = bins(p.points, MOST)

        def mean(x: Array, first: NDArray[np.intp] = first, p: Phase = p) -> Array:
            size = np.diff(np.append(first, p.points.stop - p.points.start))
            total = np.add.reduceat(x[p.points], first, axis=0)
            return np.asarray(total / size.reshape(-1, *([1] * (x.ndim - 1))))

        kind = {"loading": 1.0, "hold": 0.0, "unloading": -1.0}[p.kind]
        for name, value in (
            ("time", mean(raw.time)),
            ("depth", mean(depth)),
            ("force", mean(raw.force)),
            ("count", count),
            ("own_sd", mean(own) / np.sqrt(count)),
            ("phase", np.full(count.size, float(n))),
            ("kind", np.full(count.size, kind)),
            ("peak", mean(peak)),
            ("turn", mean(turn)),
            ("depth_error", (trial.depth_sd if degrees[n] < 0 else 0.0) / np.sqrt(count)),
            ("cycle", np.full(count.size, float(p.cycle))),
            ("begun", (mean(begun) > 0.5).astype(float)),
            ("across", np.zeros((count.size, 2)) if across is None else mean(across)),
        ):
            columns[name].append(value)
    whole = {name: np.concatenate(parts) for name, parts in columns.items()}
    sides = whole.pop("across")
    return Record(
        name=trial.id,
        material=trial.material,
        specimen=trial.specimen or trial.material,
        blocks=block_names(trial),
        geometry=geometry,
        across=None if across is None else sides,
        depth_sd=trial.depth_sd,
        labels=tuple(p.label for p in phases),
        degrees=degrees,
        estimated=trial.force_sd is None,
        **whole,
    )
