"""What a poke's record may be off by without a cause: the touch, and the simulation's own error."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._curve import COARSE, FINE, Curve
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes._smooth import left_over
from calibration.pokes import TOGETHER, scatter, wandering_modes

Array = NDArray[np.float64]

GRID = 120  # depths at which wandering is taken
TOUCH = 3.0  # standard deviations of the depth that a point is close to the touch by
# Where the rod's path across the surface bends, its mesh error is not known better than this part of the
# force along.
ACROSS = 0.01


def refinement(depth: Array, curve: Curve) -> Array:
    """Of the mesh that a curve's forces at depths (k,) come from."""
    return np.where(depth <= curve.finer, FINE, COARSE)


def point_sd(record: Record, curve: Curve, force: Array, slope: Array) -> Array:
    """Standard deviation [N] of each point by itself, (k,): the load cell, the depth's reading through the
    slope [N/m], and what the simulation scatters by."""
    through_depth = slope * record.depth_error
    # close to the touch a record may touch or not, which no slope tells
    near = np.abs(record.depth) < TOUCH * record.depth_sd
    kink = np.where(near, 2.0 * record.depth_sd * float(slope[near].max(initial=0.0)), 0.0)
    own = np.abs(force) * scatter(
        np.maximum(record.depth, 0.0), record.geometry.rod.radius, refinement(record.depth, curve)
    )
    return np.sqrt(record.own_sd**2 + through_depth**2 + own**2 + kink**2)


def side_sd(record: Record, force: Array) -> Array:
    """Of the forces across the rod [N], (k,)."""
    return np.hypot(record.own_sd, ACROSS * np.abs(force))


def columns_of(
    records: Sequence[Record], curves: Sequence[Curve], forces: Sequence[Array], slopes: Sequence[Array]
) -> Array:
    """(points, n) [N]: one standard deviation of each nuisance, as `calibration.pokes` has them: the mesh's
    error of all pokes together, its wandering with the width of contact (pokes of one geometry share it), and
    the touch of each record."""
    starts = np.cumsum([0, *(r.points for r in records)])
    rows = [np.arange(int(a), int(b)) for a, b in pairwise(starts)]
    whole = np.concatenate(list(forces))
    meshes = [refinement(r.depth, c) for r, c in zip(records, curves, strict=True)]
    found = [TOGETHER / np.concatenate(meshes) ** 2 * whole]
    for geometry in dict.fromkeys(r.geometry for r in records):
        mine = [k for k, r in enumerate(records) if r.geometry == geometry]
        # pokes of one geometry are of one curve, but for what a deeper one was carried on by
        curve = max((curves[k] for k in mine), key=lambda c: c.finer)
        where = np.concatenate([rows[k] for k in mine])
        depth = np.maximum(np.concatenate([records[k].depth for k in mine]), 0.0)
        for mode in _modes(depth, geometry.rod.radius, curve).T:
            column = np.zeros(whole.size)
            column[where] = mode * whole[where]
            found.append(column)
    for k, r in enumerate(records):
        if r.depth_sd > 0.0:
            column = np.zeros(whole.size)
            column[rows[k]] = r.depth_sd * slopes[k]
            found.append(column)
        for n, degree in enumerate(r.degrees):
            mine = r.phase == n
            if degree < 0 or not mine.any():
                continue
            left = r.depth_sd * left_over(r.time[mine], int(r.count[mine].sum()), degree)
            for part in left.T:
                column = np.zeros(whole.size)
                column[rows[k][mine]] = part * slopes[k][mine]
                found.append(column)
    return np.column_stack(found)


def _modes(depth: Array, radius: float, curve: Curve) -> Array:
    """Wandering modes at depths (k,), taken on a grid of depths: records are long."""
    grid = np.linspace(0.0, float(np.sqrt(depth.max())), GRID)[1:] ** 2
    modes = wandering_modes(grid, radius, refinement(grid, curve))
    return np.column_stack([np.interp(depth, grid, mode) for mode in modes.T])
