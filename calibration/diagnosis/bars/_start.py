"""Coordinates to begin a bar's baseline from: as fast, as damped and let go when the measured swing was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._bar import swing
from calibration.diagnosis.bars._coordinates import RELEASE, RELEASE_SD
from calibration.diagnosis.bars._record import Record
from calibration.diagnosis.bars._simulation import Simulation
from calibration.diagnosis.nested import State

Array = NDArray[np.float64]


def start_of(simulation: Simulation) -> Array:
    """The modulus whose swing is as fast as the measured one, the damping of its ratio, and the release
    nearest to the data. ValueError where the bar has no equilibrium."""
    records, coordinates = simulation.records, simulation.coordinates
    u = coordinates.centre.copy()
    for n, name in enumerate(coordinates.specimens):
        mine = [r for r in records if r.specimen == name]
        u[n] = np.mean([np.log(_modulus(r, simulation.fixes[0].stiff_root)) for r in mine])
    for name in coordinates.materials:
        mine = [r for r in records if r.trial.material == name]
        u[coordinates.of_material(name)] = np.mean([np.log(r.ratio * r.period / np.pi) for r in mine])
    for k, r in enumerate(records):
        state = State(u=u)
        setting, (_, start, share) = simulation.setting(k, state), simulation.own(k, state)
        there = np.isfinite(r.deviations())
        tries = np.linspace(-RELEASE_SD, RELEASE_SD, 61)
        costs = [
            float(np.sum(((simulation.rows(k, setting, (t, start, share)) - r.measured())[there]) ** 2))
            for t in r.released + tries
        ]
        u[coordinates.of_trial(r)] = tries[int(np.argmin(costs))] / RELEASE
    return u


def _modulus(record: Record, stiff_root: float) -> float:
    """Whose reduced bar swings as fast as the record [Pa]."""
    shear = 1e5
    usual = replace(record.setting, stiff_root=stiff_root)
    for _ in range(40):
        try:
            found = float(swing(replace(usual, shear=shear)).frequencies[0])
        except ValueError:  # too soft to stand its load
            shear *= 4.0
            continue
        if abs(found * record.period - 1.0) < 1e-4:
            break
        shear *= float(np.clip((1.0 / (found * record.period)) ** 2, 0.3, 4.0))
    return shear
