"""Two photographs each of two cantilevers with residual curvature from casting, by a planar elastica."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from scipy.integrate import solve_bvp

RADIUS = 0.010


def elastica(length: float, shear_modulus: float, curvature: float) -> tuple[np.ndarray, np.ndarray]:
    """Upper and lower edge [mm], (40, 2) each, of a round, inextensible cantilever of E = 3 G.

    The density is 1000 kg/m3; the stress-free shape is an arc of `curvature` [1/m], positive upwards.
    """
    stiffness = 3.0 * shear_modulus * np.pi * RADIUS**4 / 4.0
    weight = 1000.0 * 9.81 * np.pi * RADIUS**2

    def slopes(at: np.ndarray, y: np.ndarray) -> np.ndarray:
        pull = -weight * (length - at) * np.cos(y[0]) / stiffness
        return np.vstack([y[1], pull, np.cos(y[0]), -np.sin(y[0])])

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], b[1] + curvature, a[2], a[3]])

    s = np.linspace(0.0, length, 201)
    found = solve_bvp(slopes, ends, s, np.zeros((4, len(s))), tol=1e-8)
    assert found.success
    theta, _, x, z = found.sol(np.linspace(0.03, 0.995, 40) * length)
    middle, across = np.column_stack([x, z]), np.column_stack([np.sin(theta), np.cos(theta)])
    return 1e3 * (middle + RADIUS * across), 1e3 * (middle - RADIUS * across)


def bent_folder(folder: Path, *, curvature: float, name: str = "long") -> Path:
    draws = np.random.default_rng(2)
    tables, trials = {}, []
    for trial, length in (("short", 0.06), (name, 0.1)):
        captures = []
        for time in (10.0, 100.0):
            edges = [e + 0.05 * draws.standard_normal(e.shape) for e in elastica(length, 25e3, curvature)]
            file = f"beams/{len(tables)}.csv"
            tables[file] = outline_columns(*edges)
            captures.append(capture_entry(time, file))
        trials.append(beam_entry(trial, free_length_mm=1e3 * length, captures=captures))
    return write_experiment(folder, trials, tables=tables)
