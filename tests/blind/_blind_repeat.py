"""The lab does what a diagnosis advised: the same specimens, photographed once more in another pose.

Poses are physical: a specimen whose ends are swapped shows what was in the grip, one that is pushed deeper
into it shows less of its clamped end. Solved with the causes that are hidden; noise and registration anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from _blind_beam import GRAVITY, WINDOW, Beam
from _blind_cases import LENGTH_SD, Case, beam_at
from _blind_effects import IMAGE, photographed
from _blind_lab import as_traced, capture, entry_of, jittered
from _blind_sigma import traced
from _blind_solver import NoEquilibriumError, solve
from _blind_table import LENGTHS
from numpy.typing import NDArray

Array = NDArray[np.float64]
GRIP = 0.020  # of a specimen that is held [m]
OTHER = 0.075  # another free length [m]
TIP_MASS = 0.005  # [kg]
ONCE = ("lamp", "swapped-photograph")  # happened in the first session only


@dataclass(frozen=True, kw_only=True)
class Pose:
    """beam: the true beam in it, from the true one and the free length [m] of a new clamping; None where it
    cannot be. free_length [m]: another than the trial's; time [s] since release. entry: what experiment.yaml
    says of it. again: more photographs of the same trials."""

    beam: Callable[[Beam, float], Beam | None]
    free_length: float | None = None
    time: float = 100.0
    entry: dict[str, Any] = field(default_factory=dict)
    again: bool = False


def turned(beam: Beam, length: float) -> Beam:
    return replace(
        beam,
        length=length,
        curvature=-beam.curvature,
        transverse_gradient=-beam.transverse_gradient,
    )


def swapped(beam: Beam, length: float) -> Beam:
    """What was at x is at L - GRIP - x, in a bridge at L - x; a blob at the free end is in the grip now."""
    shift = 0.0 if beam.bridge else GRIP
    moved = _along(beam, shift)
    return replace(
        moved,
        length=length,
        taper=-moved.taper,
        axial_gradient=-moved.axial_gradient,
        void_at=beam.length - shift - beam.void_at,
        blob=0.0,
    )


def _along(beam: Beam, shift: float) -> Beam:
    """The beam about a middle that lies `shift` nearer to its clamped end (its length stays as it is)."""
    size, stiff = 1 - beam.taper * shift, 1 - beam.axial_gradient * shift
    return replace(
        beam,
        radius=beam.radius * size,
        taper=beam.taper / size,
        mu=beam.mu * stiff,
        axial_gradient=beam.axial_gradient / stiff,
    )


def _hung(beam: Beam, _: float) -> Beam | None:
    return None if beam.bridge else replace(beam, gravity_angle=np.pi / 2 + beam.gravity_angle)


def deeper(beam: Beam, length: float) -> Beam | None:
    """Pushed deeper into its grip, down to this free length; a beam that is shorter already cannot be."""
    in_grip = beam.length - length
    if beam.bridge or in_grip <= 0:
        return None
    moved = replace(_along(beam, -in_grip / 2), length=length)
    at = beam.void_at - in_grip
    if beam.void and at > -WINDOW / 2:
        return replace(moved, void_at=at) if at > WINDOW / 2 else None  # half of it held: not photographed
    return replace(moved, void=0.0)


def _loaded(beam: Beam, _: float) -> Beam | None:
    return None if beam.bridge else replace(beam, tip=TIP_MASS)


def _as_it_is(beam: Beam, _: float) -> Beam:
    return beam


POSES: dict[str, Pose] = {
    "turn-over": Pose(beam=turned),
    "swap-ends": Pose(beam=swapped),
    "hang": Pose(beam=_hung, entry={"gravity_m_s2": [GRAVITY, 0.0, 0.0]}),
    "other-length": Pose(beam=deeper, free_length=OTHER, entry={"free_length_mm": 1e3 * OTHER}),
    "tip-mass": Pose(beam=_loaded, entry={"tip_force_N": [0.0, 0.0, -TIP_MASS * GRAVITY]}),
    "later": Pose(beam=_as_it_is, time=1e4, again=True),
}


def new_id(trial: str, name: str) -> str:
    """Of the trial that repeats another one in a pose."""
    return f"{trial}-{name}"


def photograph_again(case: Case, name: str, folder: Path) -> list[str]:
    """Add a photograph of each beam in the pose `name` to the experiment in `folder`. Returns the trials that
    could not be made, with the reason. A specimen that is a single beam is called by its trial, so that what
    sits in one beam can be in both of its poses."""
    pose = POSES[name]
    rng = np.random.default_rng([case.seed, case.index, 3, list(POSES).index(name)])
    path = folder / "experiment.yaml"
    experiment = yaml.safe_load(path.read_text(encoding="utf-8"))
    entries = {t["id"]: t for t in experiment["trials"]}
    if case.per_beam:
        for entry in entries.values():
            entry["specimen"] = entry["id"]
    left_out = []
    for k, trial in enumerate(case.trials):
        nominal = pose.free_length or LENGTHS[trial.kind][0]
        clamped = nominal + LENGTH_SD * float(rng.standard_normal())
        beam = _true(case, k, pose, clamped, float(rng.standard_normal()))
        if beam is None:
            left_out.append(f"{trial.id}: not in this pose")
            continue
        s = jittered(traced(nominal, beam.bridge), rng)
        try:
            edges = solve(beam).edges(s)
        except NoEquilibriumError:
            left_out.append(f"{trial.id}: no equilibrium")
            continue
        for hidden in case.hidden:
            if k in hidden.trials and hidden.effect in (*IMAGE, "shadow"):
                edges = photographed(edges, nominal, hidden.effect, hidden.amplitude)
        id_ = trial.id if pose.again else new_id(trial.id, name)
        file = f"beams/{id_}-t{pose.time:.0f}.csv"
        (folder / file).write_text(as_traced(edges, rng), encoding="utf-8")
        shot = capture(file, pose.time)
        if pose.again:
            entries[trial.id]["captures"].append(shot)
        else:
            specimen = entries[trial.id]["specimen"]
            entry = entry_of(trial, [shot]) | {"id": id_, "specimen": specimen} | pose.entry
            experiment["trials"].append(entry)
    path.write_text(yaml.safe_dump(experiment, sort_keys=False), encoding="utf-8")
    return left_out


def _true(case: Case, trial: int, pose: Pose, clamped: float, dice: float) -> Beam | None:
    """The true beam in a pose; clamped [m]: free length of the new clamping, to which adds what slips out."""
    lasting = replace(case, hidden=tuple(h for h in case.hidden if h.effect not in ONCE))
    beam = beam_at(lasting, trial, time=pose.time, dice=dice)
    return pose.beam(beam, clamped + beam.length - case.trials[trial].length)
