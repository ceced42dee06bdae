"""Synthetic indentation trials from given curves, shared by the tests of this folder."""

from __future__ import annotations

from typing import Any

import numpy as np
from made_experiment import experiment as experiment
from numpy.typing import NDArray

import tisim
from calibration.experiment.model import PokeRecord, PokeTrial

Array = NDArray[np.float64]
SHEAR = 30e3
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300 * SHEAR)


def trial(depth: Array, force: Array, *, time: Array | None = None, **changes: Any) -> PokeTrial:
    """Vertical indentation of a block of 60 x 60 x 30 mm; by default one sample every 0.1 s."""
    given = {
        "id": "p1",
        "material": "S1",
        "block": tisim.Block(size=(0.06, 0.06, 0.03)),
        "rod_radius": 0.0025,
        "rod_tip": "flat",
        "start": (0.0, 0.0, 0.03),
        "direction": (0.0, 0.0, -1.0),
        "force_sd": 1e-3,
    }
    time = 0.1 * np.arange(len(depth)) if time is None else time
    record = PokeRecord(time=time, depth=np.asarray(depth), force=np.asarray(force))
    return PokeTrial(record=record, **(given | changes))  # type: ignore[arg-type]


def hertz(depth: Array, radius: float, material: tisim.Material) -> Array:
    """Force [N] of a frictionless sphere on a half space: 4/3 E/(1 - nu^2) sqrt(R) d^1.5."""
    mu, lam = (float(np.asarray(material.parameters[n])) for n in ("mu", "lam"))
    poisson = lam / (2 * (lam + mu))
    plane = 2 * mu * (1 + poisson) / (1 - poisson**2)
    return np.asarray(4 / 3 * plane * np.sqrt(radius) * depth**1.5)
