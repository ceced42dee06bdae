"""Curves without their mesh error: of two meshes whose error is known."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from calibration.measurements.indentation._curve import COARSE, FINE, Curve, extrapolated

Array = NDArray[np.float64]
RADIUS = 4e-3
DEPTH = np.linspace(0.125e-3, 2e-3, 16)
WIDTH = np.sqrt(DEPTH / RADIUS)


def force(depth: Array) -> Array:
    return np.asarray(depth**1.5)


def curve(along: Array, depth: Array = DEPTH) -> Curve:
    return Curve(
        depth=depth,
        along=along,
        across=np.zeros((depth.size, 2)),
        reached=float(depth[-1]),
        finer=float(depth[-1]),
        round_tip=True,
        status="converged",
        core_seconds=0.0,
    )


def meshed(refinement: float, waves: float = 0.0) -> Array:
    """Too stiff by 9 % near the surface at refinement 1, by 3 % at depth, and waves once a cell."""
    error = 0.03 + 0.06 * np.exp(-WIDTH / 0.3)
    wave = waves * np.sin(2.0 * np.pi * refinement * WIDTH / 0.2)
    return force(DEPTH) * np.exp((error + wave) / refinement**2)


def test_an_error_of_the_squared_cell_size_is_taken_off() -> None:
    found = extrapolated(curve(meshed(FINE)), curve(meshed(COARSE)), RADIUS)
    assert found.along == pytest.approx(force(DEPTH), rel=4e-3)
    assert meshed(FINE) != pytest.approx(force(DEPTH), rel=1.5e-2)


def test_waves_are_not_made_larger() -> None:
    """Were the difference of the meshes taken off as it is, those of the coarse one would enter."""
    found = extrapolated(curve(meshed(FINE, 0.01)), curve(meshed(COARSE, 0.01)), RADIUS)
    fine = meshed(FINE, 0.01) / meshed(FINE)
    assert np.std(found.along / force(DEPTH) / fine) < 0.003


def test_beyond_what_the_coarse_mesh_reached_the_last_error_counts() -> None:
    short = curve(meshed(COARSE)[:12], DEPTH[:12])
    found = extrapolated(curve(meshed(FINE)), short, RADIUS)
    factor = found.along / meshed(FINE)
    assert factor[12:] == pytest.approx(factor[11])
