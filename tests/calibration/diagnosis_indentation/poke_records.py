"""Indentation trials with given forces, and their model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.catalogue import effects_of
from calibration.experiment.model import Experiment, PokeRecord, PokeTrial
from calibration.measurements.indentation.model import IndentationModel
from tisim import Block

Array = NDArray[np.float64]
SIZE = (0.1, 0.1, 0.03)


def path(*, deep: float = 2e-3, back: bool = True, hold: float = 0.0, cycles: int = 1) -> tuple[Array, Array]:
    """Time [s] and depth [m] at 1 mm/s for the default depth, sampled every 0.05 s."""
    legs = []
    for _ in range(cycles):
        legs.append(np.linspace(0.0, deep, 41))
        if hold:
            legs.append(np.full(int(hold / 0.05), deep))
        if back:
            legs.append(np.linspace(deep, 0.0, 41))
    depth = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
    return np.asarray(0.05 * np.arange(depth.size)), np.asarray(depth)


def trial(
    name: str,
    time: Array,
    depth: Array,
    force: Array,
    *,
    material: str = "S",
    radius: float = 2.5e-3,
    depth_sd: float = 0.0,
    force_sd: float | None = 1e-3,
    specimen: str | None = None,
) -> PokeTrial:
    return PokeTrial(
        id=name,
        material=material,
        block=Block(size=SIZE),
        rod_radius=radius,
        rod_tip="flat",
        start=(0.0, 0.0, SIZE[2]),
        direction=(0.0, 0.0, -1.0),
        record=PokeRecord(time=time, depth=depth, force=force),
        force_sd=force_sd,
        depth_sd=depth_sd,
        specimen=specimen,
    )


def experiment(*trials: PokeTrial) -> Experiment:
    from pathlib import Path

    return Experiment(name="pokes", folder=Path(), notes="", materials={}, trials=trials, digest="")


def indentation_model(*trials: PokeTrial) -> IndentationModel:
    """Model with the catalogue's effects."""
    return IndentationModel(experiment(*trials), effects=effects_of("indentation"))  # type: ignore[arg-type]
