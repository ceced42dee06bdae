"""What three dimensions add to the reduced bar: taken from FEM where each trial's bar settles, and swings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from calibration.diagnosis.bars._bar import Reduced, carried, swing
from calibration.diagnosis.bars._record import Record
from calibration.diagnosis.bars._setting import Setting
from calibration.motion import marker_displacements, ringdown
from tisim import Beam, Result, Solver, material_from_moduli, simulate

Array = NDArray[np.float64]

BULK = 300.0  # over the shear modulus
LAYERS, RINGS = (5, 10), (1, 2)  # coarse and fine
USUAL = 0.06  # of the height: how much of a bar the clamp keeps from bending, before FEM says
SWINGS, STEPS = 4.0, 64  # periods that FEM swings for, and its steps in one
_WIDEST = 0.25  # of the height


@dataclass(frozen=True, eq=False, kw_only=True)
class Correction:
    """stiff_root [m] that makes the reduced bar settle as FEM does; inertia: relative excess that makes it
    swing so; left (m, 2): of the markers, FEM less reduced [m] where they settle; drop: of the tip there
    [m]."""

    stiff_root: float
    inertia: float
    left: Array
    drop: float


def beam_of(record: Record, shear: float, *, fine: bool) -> Beam:
    """The trial's bar for FEM."""
    t = record.trial
    return Beam(
        material=material_from_moduli(
            "neo-hookean", shear=shear, bulk=BULK * shear, density=record.setting.density
        ),
        length=t.free_length,
        section=t.section,
        supports=t.supports,
        grip_length=t.grip_length,
        gravity=t.gravity,
        tip_force=t.tip_force,
        tip_mass=record.setting.tip_mass,
        layer=t.free_length / LAYERS[fine],
        rings=RINGS[fine],
        solver=Solver(tolerance=1e-6),
    )


def corrections(
    records: Sequence[Record], shears: Sequence[float], viscous: Sequence[float], *, workers: int | None
) -> tuple[list[Correction], list[str]]:
    """One a record, and what went wrong; where FEM or its match has no answer the usual one.

    shears [Pa], viscous [s]: of each record. Bars of one form, markers and load are asked about once.
    """
    kinds: dict[object, list[int]] = {}
    for k, r in enumerate(records):
        s = r.setting
        form = (s.section, s.length, s.density, round(s.tip_mass, 6), r.trial.grip_length, r.specimen)
        kinds.setdefault((form, r.places, r.names), []).append(k)
    beams = []
    for members in kinds.values():
        k = members[0]
        still = [beam_of(records[k], shears[k], fine=fine) for fine in (False, True)]
        beams += [*still, replace(still[0], solver=_released(records[k], viscous[k]))]
    results = simulate(beams, workers=workers)
    found, wrong = [uncorrected(r) for r in records], []
    for n, members in enumerate(kinds.values()):
        k = members[0]
        try:
            one = _matched(records[k], shears[k], viscous[k], *results[3 * n : 3 * n + 3])
        except ValueError as problem:
            names = ", ".join(records[j].name for j in members)
            wrong.append(f"{names}: not corrected by FEM: {problem}")
            continue
        for j in members:
            found[j] = one
    return found, wrong


def uncorrected(record: Record, *, usual: bool = True) -> Correction:
    """Beam theory, with the root that clamps usually have, or none."""
    return Correction(
        stiff_root=USUAL * _height(record) if usual else 0.0,
        inertia=0.0,
        left=np.zeros((len(record.places), 2)),
        drop=float(-record.settled[record.tips, 1].mean()),
    )


def _released(record: Record, viscous: float) -> Solver:
    return Solver(
        method="implicit",
        duration=SWINGS * record.period,
        time_step=record.period / STEPS,
        stiffness_damping=viscous,
        tolerance=1e-4,
    )


def _matched(
    record: Record, shear: float, viscous: float, coarse: Result, fine: Result, moving: Result
) -> Correction:
    positions = np.array([m.position for m in record.trial.markers])
    for result in (coarse, fine, moving):
        if not result.ok:
            raise ValueError(f"{result.status}: {result.message}")
    setting = replace(record.setting, shear=shear, viscous=viscous)
    rough = _as_it_settles(record, setting, _plane(coarse, positions)[:, -1])
    tips = _plane(moving, positions)[record.tips, :, 1].mean(axis=0)
    q = swing(rough).coordinates(moving.load)
    reduced = carried(rough, q, record.places).displacement[record.tips, :, 1].mean(axis=0)
    first, last = 0.75 * record.period, SWINGS * record.period
    rates = [ringdown(moving.load, z, first=first, last=last).frequency for z in (tips, reduced)]
    # BDF2 of a step dt lowers an angular frequency w by the part (w dt)^2 / 3
    slowed = (2.0 * np.pi * rates[0] * record.period / STEPS) ** 2 / 3.0
    aim = _plane(fine, positions)[:, -1]
    exact = _as_it_settles(record, setting, aim)
    return Correction(
        stiff_root=exact.stiff_root,
        inertia=(rates[1] / (rates[0] * (1.0 + slowed))) ** 2 - 1.0,
        left=aim - _settled(exact, record)[0],
        drop=float(-aim[record.tips, 1].mean()),
    )


def _plane(result: Result, positions: Array) -> Array:
    """(m, f, 2)."""
    return marker_displacements(result, positions)[:, :, [0, 2]]


def _as_it_settles(record: Record, setting: Setting, aim: Array) -> Setting:
    """The setting with the root that brings the reduced bar's tip where FEM's is, of markers (m, 2)."""
    drop = float(-aim[record.tips, 1].mean())
    widest = _WIDEST * _height(record)

    def off(root: float) -> float:
        return _settled(replace(setting, stiff_root=root), record)[1] - drop

    if off(-widest) * off(widest) > 0.0:
        raise ValueError("no stiffness of the root makes the reduced bar settle there")
    return replace(setting, stiff_root=float(brentq(off, -widest, widest, xtol=1e-8)))


def _settled(setting: Setting, record: Record) -> tuple[Array, float]:
    """Markers where the reduced bar settles (m, 2), and the drop of its tip."""
    q = Reduced(setting).settled()
    moved = carried(setting, q[None], record.places).displacement[:, 0]
    return moved, float(-moved[record.tips, 1].mean())


def _height(record: Record) -> float:
    section = record.setting.section
    return float(getattr(section, "height", 2.0 * getattr(section, "radius", 0.0)))
