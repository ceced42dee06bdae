"""The stated mesh error of indentations against the true one, from another solver's forces."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

import tisim
from calibration.measurements.indentation import TOGETHER, scatter, wandering_modes

TABLE = json.loads(
    (Path(__file__).parents[3] / "benchmarks" / "blind" / "indentation" / "forces.json").read_text(
        encoding="utf-8"
    )
)
SHEAR = 1e4
REFINEMENT = 0.8


@pytest.mark.parametrize("name", ["ball", "thin"])
def test_the_stated_error_holds_what_another_solver_says(name: str) -> None:
    """The mean squared deviation per depth is at most 1.5 times the stated one."""
    entry = TABLE[name]
    setup = entry["setup"]
    tip, radius = setup["tip"], 1e-3 * setup["rod"]
    poke = tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR),
        block=tisim.Block(size=(0.1, 0.1, 1e-3 * setup["height"])),
        rod=tisim.Rod(radius=radius, edge_radius=0.4 * radius, tip=tip),
        depth=0.99e-3 * entry["depth"][-1],
        frame_spacing=0.24e-3,
        refinement=REFINEMENT,
    )
    (result,) = tisim.simulate([poke], workers=1)
    assert result.status is tisim.Status.CONVERGED
    power = 1.5 if tip == "hemisphere" else 1.0
    root = (np.array(entry["in"]) * np.array(entry["rigid"])) ** (1.0 / power)
    theirs = PchipInterpolator(np.r_[0.0, entry["depth"]], np.r_[0.0, root])
    depth = result.load[1:]
    off = 1e6 * np.abs(result.rod_force[1:, 2]) / SHEAR / theirs(1e3 * depth) ** power - 1.0
    modes = wandering_modes(depth, radius, REFINEMENT)
    stated = (
        modes @ modes.T + np.diag(scatter(depth, radius, REFINEMENT) ** 2) + (TOGETHER / REFINEMENT**2) ** 2
    )
    assert off @ np.linalg.solve(stated, off) / off.size < 1.5
