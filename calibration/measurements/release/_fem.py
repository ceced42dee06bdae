"""Corrections of the reduced beam by FEM: static equilibrium and frequency of each trial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from calibration.experiment.model import beam_as_stated
from calibration.measurements.release._beam import BeamParameters, ReducedBeam
from calibration.measurements.release._record import Record
from calibration.measurements.release._vibration import beam_markers, free_vibration
from calibration.measurements.release.kinematics import marker_displacements
from calibration.measurements.release.ringdown import ringdown
from tisim import Beam, Material, Result, Solver, simulate

Array = NDArray[np.float64]

BULK_RATIO = 300.0  # K/G
LAYERS, RINGS = (5, 10), (1, 2)  # axial and radial elements of the coarse and the fine mesh
USUAL = 0.06  # stiff root over the height of the section, before FEM is run
PERIODS, STEPS = 4.0, 64  # periods that FEM simulates, and time steps per period
_WIDEST = 0.25  # largest |stiff root| over the height of the section


@dataclass(frozen=True, eq=False, kw_only=True)
class Correction:
    """Correction of the reduced beam by FEM.

    Attributes
    ----------
    stiff_root : value for which the tip of the reduced beam has FEM's equilibrium [m].
    extra_inertia : relative value for which the reduced beam has FEM's frequency.
    markers : displacement at equilibrium, FEM minus reduced beam [m], shape (m, 2).
    drop : drop of the tip at equilibrium [m].
    """

    stiff_root: float
    extra_inertia: float
    markers: Array
    drop: float


def beam_of(record: Record, material: Material, *, fine: bool) -> Beam:
    """FEM scene of a record's trial; fine : use the fine mesh."""
    return beam_as_stated(
        record.trial,
        material,
        tip_mass=record.parameters.tip_mass,
        axial_element_size=record.trial.free_length / LAYERS[fine],
        radial_elements=RINGS[fine],
        solver=Solver(tolerance=1e-6),
    )


def corrections(
    records: Sequence[Record],
    materials: Sequence[Material],
    shears: Sequence[float],
    relaxation_times: Sequence[float],
    *,
    workers: int | None,
) -> tuple[list[Correction], list[str]]:
    """Corrections, one per record, and a sentence for each failure.

    If FEM or the match fails, the correction is that of `uncorrected`. Records of one specimen with equal
    geometry, markers and load are simulated once.

    Parameters
    ----------
    records : the records.
    materials, shears, relaxation_times : elastic material, its shear modulus [Pa] and the relaxation time [s]
        of each record.
    workers : number of processes; None for all cores.
    """
    kinds: dict[object, list[int]] = {}
    for k, r in enumerate(records):
        s = r.parameters
        form = (s.section, s.length, s.density, round(s.tip_mass, 6), r.trial.grip_length, r.specimen)
        kinds.setdefault((form, r.positions, r.names), []).append(k)
    beams = []
    for members in kinds.values():
        k = members[0]
        still = [beam_of(records[k], materials[k], fine=fine) for fine in (False, True)]
        beams += [*still, replace(still[0], solver=_released(records[k], relaxation_times[k]))]
    results = simulate(beams, workers=workers)
    found, wrong = [uncorrected(r) for r in records], []
    for n, members in enumerate(kinds.values()):
        k = members[0]
        try:
            one = _matched(records[k], shears[k], relaxation_times[k], *results[3 * n : 3 * n + 3])
        except ValueError as problem:
            names = ", ".join(records[j].name for j in members)
            wrong.append(f"{names}: not corrected by FEM: {problem}")
            continue
        for j in members:
            found[j] = one
    return found, wrong


def uncorrected(record: Record, *, usual: bool = True) -> Correction:
    """Correction of a record without FEM: the usual stiff root, or with `usual` False plain beam theory."""
    return Correction(
        stiff_root=USUAL * 2.0 * record.parameters.section.half_height if usual else 0.0,
        extra_inertia=0.0,
        markers=np.zeros((len(record.positions), 2)),
        drop=float(-record.equilibrium[record.outer, 1].mean()),
    )


def _released(record: Record, relaxation_time: float) -> Solver:
    return Solver(
        method="implicit",
        duration=PERIODS * record.period,
        time_step=record.period / STEPS,
        stiffness_damping=relaxation_time,
        tolerance=1e-4,
    )


def _matched(
    record: Record, shear: float, relaxation_time: float, coarse: Result, fine: Result, moving: Result
) -> Correction:
    positions = np.array([m.position for m in record.trial.markers])
    for result in (coarse, fine, moving):
        if not result.ok:
            raise ValueError(f"{result.status}: {result.message}")
    # FEM distributes the load over the face: the effect of its height is in the reduced beam only
    parameters = replace(
        record.parameters, shear_modulus=shear, relaxation_time=relaxation_time, load_height=0.0
    )
    rough = _with_root(record, parameters, _plane(coarse, positions)[:, -1])
    tips = _plane(moving, positions)[record.outer, :, 1].mean(axis=0)
    q = free_vibration(rough).coordinates(moving.load)
    reduced = beam_markers(rough, q, record.positions).displacement[record.outer, :, 1].mean(axis=0)
    first, last = 0.75 * record.period, PERIODS * record.period
    rates = [ringdown(moving.load, z, first=first, last=last).frequency for z in (tips, reduced)]
    # BDF2 with a step dt lowers an angular frequency w by the fraction (w dt)^2 / 3
    slowed = (2.0 * np.pi * rates[0] * record.period / STEPS) ** 2 / 3.0
    aim = _plane(fine, positions)[:, -1]
    exact = _with_root(record, parameters, aim)
    return Correction(
        stiff_root=exact.stiff_root,
        extra_inertia=(rates[1] / (rates[0] * (1.0 + slowed))) ** 2 - 1.0,
        markers=aim - _equilibrium(exact, record)[0],
        drop=float(-aim[record.outer, 1].mean()),
    )


def _plane(result: Result, positions: Array) -> Array:
    """Displacement of markers in x and z [m], shape (m, f, 2)."""
    return marker_displacements(result, positions)[:, :, [0, 2]]


def _with_root(record: Record, parameters: BeamParameters, aim: Array) -> BeamParameters:
    """Parameters with the stiff root for which the reduced beam's tip agrees with FEM.

    aim : displacement of the markers by FEM [m], shape (m, 2). ValueError if there is no such stiff root.
    """
    drop = float(-aim[record.outer, 1].mean())
    widest = _WIDEST * 2.0 * record.parameters.section.half_height

    def off(root: float) -> float:
        return _equilibrium(replace(parameters, stiff_root=root), record)[1] - drop

    if off(-widest) * off(widest) > 0.0:
        raise ValueError("no stiffness of the root gives the reduced beam that equilibrium")
    return replace(parameters, stiff_root=float(brentq(off, -widest, widest, xtol=1e-8)))


def _equilibrium(parameters: BeamParameters, record: Record) -> tuple[Array, float]:
    """Displacement of markers at the equilibrium of the reduced beam (m, 2), and the drop of its tip [m]."""
    q = ReducedBeam(parameters).equilibrium()
    moved = beam_markers(parameters, q[None], record.positions).displacement[:, 0]
    return moved, float(-moved[record.outer, 1].mean())
