"""Photographed beams: simulated on their own mesh, traced, disturbed, and written as by a laboratory.

This module shares no code with calibration: the edges are splines through the mesh's corner nodes, and the
noise is drawn as the format describes it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from numpy.typing import NDArray
from photograph_errors import photographed
from scipy.interpolate import CubicSpline

import tisim

Array = NDArray[np.float64]


def made(
    folder: Path,
    material: tisim.Material,
    *,
    lengths_mm: Sequence[float] = (50.0,),
    bridges_mm: Sequence[float] = (),
    photographs: int = 1,
    seed: int = 0,
    noise: float = 1.0,
    stated_density: float | None = None,
    layer: float = 0.00175,
    rings: int = 5,
    name: str = "S0",
) -> Path:
    """Write an experiment with cantilevers and bridges of one material; `noise` scales all errors."""
    rng = np.random.default_rng(seed)
    trials, tables = [], {}
    for length, bridge in [(x, False) for x in lengths_mm] + [(x, True) for x in bridges_mm]:
        supports = "clamped-clamped" if bridge else "clamped-free"
        beam = tisim.Beam(
            material=material,
            length=length / 1e3,
            supports=supports,  # type: ignore[arg-type]
            axial_element_size=layer,
            radial_elements=rings,
        )
        result = _solved(beam)
        edges = [_edge(result, side, rng) for side in (1.0, -1.0)]
        identifier = f"{name}-{'bridge' if bridge else 'cantilever'}-{length:.0f}"
        captures = []
        for k in range(photographs):
            file = f"beams/{identifier}-{k}.csv"
            upper, lower = photographed(edges, rng, noise, _contour_error)
            tables[file] = outline_columns(upper, lower)
            captures.append(capture_entry(10.0 + k, file))
        trials.append(
            beam_entry(
                identifier,
                material=name,
                specimen=name,
                free_length_mm=length,
                supports=supports,
                captures=captures,
            )
        )
    density = material.density if stated_density is None else stated_density
    materials = {name: {"softener_ratio": 0.0, "density_kg_m3": float(density), "density_sd_kg_m3": 5.0}}
    return write_experiment(folder, trials, tables=tables, materials=materials)


def _solved(beam: tisim.Beam) -> tisim.Result:
    """Result of a beam, solved once for all seeds of a test."""
    key = repr(beam)
    if key not in _SOLVED:
        (_SOLVED[key],) = tisim.simulate([beam], workers=1)
    assert _SOLVED[key].ok
    return _SOLVED[key]


_SOLVED: dict[str, tisim.Result] = {}


def _edge(result: tisim.Result, side: float, rng: np.random.Generator) -> Array:
    """Points along one edge [mm], some 1.3 mm apart, from 1 mm off the clamp."""
    rest, now = result.mesh.nodes, result.positions[-1]
    on = (np.abs(rest[:, 1]) < 1e-12) & (np.abs(rest[:, 2] - side * rest[:, 2].max()) < 1e-9)
    on &= (rest[:, 0] >= -1e-12) & (rest[:, 0] <= result.scene.length + 1e-12)  # type: ignore[union-attr]
    order = np.argsort(rest[on, 0])
    x, line = rest[on, 0][order], now[on][order][:, [0, 2]]
    corners = slice(None, None, 2)  # mid-side nodes of the 10-node elements lie between
    curve = CubicSpline(x[corners], line[corners])
    at = np.arange(1e-3, x[-1] - 0.5e-3, 1.3e-3)
    return 1e3 * curve(at + rng.uniform(-3e-4, 3e-4, len(at)))


def _contour_error(correlations: Array, sd: float, rng: np.random.Generator) -> Array:
    values, vectors = np.linalg.eigh(correlations)
    error = sd * vectors @ (np.sqrt(np.maximum(values, 0.0)) * rng.standard_normal(len(values)))
    return np.asarray(error + 0.02 * sd * rng.standard_normal(len(values)))  # rounding by the tracer
