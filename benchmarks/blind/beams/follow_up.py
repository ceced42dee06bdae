"""Follow-up experiments that a diagnosis advises: the same specimens in another pose, or measured directly.

Poses are physical: a specimen with swapped ends shows what was in the grip, one that is pushed deeper into
the grip shows less of its clamped end. They are solved with the hidden effects; noise and registration are
drawn anew.

Direct measurements (scales, callipers, a level, ...) are entered in experiment.yaml if it has a key with a
standard deviation for them. For the others, an effect counts as present from three standard deviations of the
gauge, and effects that the readings refute are removed from the catalogue.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.beams.cases import LENGTH_SD, TIMES, Case, beam_at, true_beam
from benchmarks.blind.beams.detectability import traced
from benchmarks.blind.beams.effects import DEGREE, IMAGE, photographed
from benchmarks.blind.beams.experiment import as_traced, capture, entry_of, jittered
from benchmarks.blind.beams.ideal_beams import LENGTHS
from benchmarks.blind.beams.model import GRAVITY, WINDOW, Beam
from benchmarks.blind.beams.solver import NoEquilibriumError, solve

Array = NDArray[np.float64]
GRIP = 0.020  # clamped length of a specimen [m]
OTHER = 0.075  # another free length [m]
TIP_MASS = 0.005  # [kg]
ONCE = ("lamp", "swapped-photograph")  # occur in the first session only


@dataclass(frozen=True, kw_only=True)
class Pose:
    """Another arrangement of the specimens.

    Attributes
    ----------
    beam : function of the true beam and the free length [m] of the new clamping that returns the true beam in
        this pose; None if the pose is impossible.
    free_length : new nominal free length [m]; None: that of the trial.
    time : time since release [s].
    entry : keys of the trial in experiment.yaml that change.
    again : True if the photographs are added to the same trials.
    """

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
    """Beam with swapped ends.

    Material at x moves to L - GRIP - x, in a bridge to L - x; an added mass at the free end is then in the
    grip.
    """
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
    """Beam whose radius and modulus refer to a middle `shift` nearer to its clamped end; same length."""
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
    """Beam pushed deeper into its grip, to this free length; None if it is not longer than that.

    Also None for a bridge and for a void that would be partly in the grip.
    """
    in_grip = beam.length - length
    if beam.bridge or in_grip <= 0:
        return None
    moved = replace(_along(beam, -in_grip / 2), length=length)
    at = beam.void_at - in_grip
    if beam.void and at > -WINDOW / 2:
        return replace(moved, void_at=at) if at > WINDOW / 2 else None  # partly clamped: not photographed
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
    """Id of the trial that repeats another one in a pose."""
    return f"{trial}-{name}"


def photograph_again(case: Case, name: str, folder: Path) -> list[str]:
    """Add a photograph of each beam in the pose `name` to the experiment in `folder`.

    Returns the trials that could not be made, with the reason. If each beam is a specimen, the specimens are
    renamed to the trials' ids, so that an effect in one beam can be in both of its poses.
    """
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
    """True beam in a pose; `clamped` [m]: free length of the new clamping, without slip."""
    lasting = replace(case, hidden=tuple(h for h in case.hidden if h.effect not in ONCE))
    beam = beam_at(lasting, trial, time=pose.time, dice=dice)
    return pose.beam(beam, clamped + beam.length - case.trials[trial].length)


Names = tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Gauge:
    """A direct measurement.

    Attributes
    ----------
    sds : standard deviations [SI] of its readings of amplitudes.
    enters : effects whose readings have keys in experiment.yaml.
    """

    sds: dict[str, float] = field(default_factory=dict)
    enters: Names = ()


GAUGES: dict[str, Gauge] = {
    "weigh": Gauge(sds={"added-mass": 2e-5}, enters=("density",)),
    "callipers": Gauge(sds={"taper": 0.03, "grip-squeeze": 5e-3}, enters=("radius",)),
    "level": Gauge(
        sds={"clamp-tilt": 0.1 * DEGREE, "gravity-tilt": 0.1 * DEGREE, "camera-roll": 0.1 * DEGREE}
    ),
    "gauge-block": Gauge(sds={"clamp-gap": 5e-5, "image-scale": 1e-3}, enters=("free-length",)),
    "metal-bar": Gauge(sds={"grip-length": 1e-4, "clamp-compliance": 0.2}),
    "lens": Gauge(sds={"lens-distortion": 0.2, "image-scale": 1e-3}),
    "cut": Gauge(sds={"void": 0.03, "skin": 0.05}),
}
GAUGE_DENSITY_SD, GAUGE_RADIUS_SD, GAUGE_LENGTH_SD = 2.0, 2e-5, 5e-5  # [kg/m3], [m], [m]
PRESENT = 3.0


def measure(case: Case, name: str, alternatives: Iterable[Names], folder: Path) -> tuple[Names, Names]:
    """Read the gauge, and enter the readings in the experiment in `folder` if it has keys for them.

    Returns the effects that were entered, and the ones that the readings refute: see `refuted`.
    """
    gauge = GAUGES[name]
    rng = np.random.default_rng([case.seed, case.index, 4, list(GAUGES).index(name)])
    _enter(case, gauge.enters, folder, rng)
    true = {h.effect: abs(h.amplitude) for h in case.hidden}
    there = {
        effect: abs(true.get(effect, 0.0) + sd * rng.standard_normal()) > PRESENT * sd
        for effect, sd in gauge.sds.items()
    }
    return gauge.enters, refuted(there, alternatives)


def refuted(there: dict[str, bool], alternatives: Iterable[Names]) -> Names:
    """Effects that the readings refute; `there`: True for each effect that the gauge found present.

    These are the effects read to be absent, and those that occur only in `alternatives` (sets of effects)
    that disagree with the readings; never an effect read to be present.
    """
    sets = [set(names) for names in alternatives]
    standing = [s for s in sets if all((effect in s) == seen for effect, seen in there.items())]
    kept = set().union(*standing)
    fallen = set().union(*sets) - kept
    absent = {effect for effect, seen in there.items() if not seen}
    present = {effect for effect, seen in there.items() if seen}
    return tuple(sorted((fallen | absent) - present))


def _enter(case: Case, effects: Names, folder: Path, rng: np.random.Generator) -> None:
    path = folder / "experiment.yaml"
    experiment = yaml.safe_load(path.read_text(encoding="utf-8"))
    if "density" in effects:
        for material, entry in experiment["materials"].items():
            true = next(t.density for t in case.trials if t.material == material)
            entry["density_kg_m3"] = round(float(true + GAUGE_DENSITY_SD * rng.standard_normal()), 1)
            entry["density_sd_kg_m3"] = GAUGE_DENSITY_SD
    radii: dict[str, float] = {}  # by specimen, measured once
    for k, (trial, entry) in enumerate(zip(case.trials, experiment["trials"], strict=True)):
        beam = true_beam(case, k, len(TIMES) - 1)
        if "radius" in effects:
            if trial.specimen not in radii:
                radii[trial.specimen] = beam.radius + GAUGE_RADIUS_SD * float(rng.standard_normal())
            entry["section"]["circle"] = {
                "radius_mm": round(1e3 * radii[trial.specimen], 4),
                "radius_sd_mm": 1e3 * GAUGE_RADIUS_SD,
            }
        if "free-length" in effects:
            read = beam.length + GAUGE_LENGTH_SD * float(rng.standard_normal())
            entry["free_length_mm"] = round(1e3 * read, 4)
            entry["free_length_sd_mm"] = 1e3 * GAUGE_LENGTH_SD
        assert entry["id"] == trial.id
    path.write_text(yaml.safe_dump(experiment, sort_keys=False), encoding="utf-8")
