"""Check that the rod of each frame is outside of the inclusion and of the base.

The contact of the solver keeps the rod out of the surface of the tissue, not out of what is rigid. Inclusion
and base do not move, so this is a question of geometry: points on the rod's surface are moved to the tip and
the axis that the store states for a frame, and their distances from the inclusion and the base are computed.
The code shares nothing with that by which the solver refuses a step into a rigid body.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory.cli import counted
from factory.reader import Dataset

Array = NDArray[np.float64]

SPACING = 0.2e-3  # m: between sampled points; a corner of an inclusion can lie between them to half of it
_UNIT = 1e-6  # by which the length of an axis may differ from 1


def clearance(data: Dataset) -> list[str]:
    """Check that in every frame some tissue is left between the rod and the inclusion, or the base."""
    faults = []
    for index in np.unique(data.table["frame_poke"]).tolist():
        rows = data.rows(index, "frame")
        depths = data.table["depth"][rows]
        if not _poses(data.table["rod_tip"][rows], data.table["rod_axis"][rows]):
            faults.append(f"poke {index}: rod_tip and rod_axis: expected finite positions and unit vectors")
            continue
        for body, gaps in gaps_of(data, index).items():
            inside = np.flatnonzero(gaps <= 0.0)
            if not len(inside):
                continue
            first, worst = inside[0], float(gaps[inside].min())
            fault = (
                f"poke {index}, frame {first} at {depths[first] * 1e3:.4g} mm: "
                f"the indenter is {_mm(gaps[first])} mm inside the {body}"
            )
            if len(inside) > 1:
                fault += f", as in {counted(len(inside) - 1, 'more frame')}, up to {_mm(worst)} mm"
            faults.append(fault)
    return faults


def _poses(tips: Array, axes: Array) -> bool:
    """True if tips and axes (frames, 3) are finite and the axes of unit length."""
    return bool(np.isfinite(tips).all()) and np.allclose(
        np.linalg.norm(axes, axis=1), 1.0, rtol=0.0, atol=_UNIT
    )


def _mm(gap: float) -> str:
    """How far inside a gap that is not above 0 is [mm], as text."""
    return f"{abs(gap) * 1e3:.2g}"


def gaps_of(data: Dataset, index: int) -> dict[str, Array]:
    """Smallest signed distance [m] of the rod from the inclusion and from the base in a poke's frames.

    Parameters
    ----------
    data : Dataset
    index : int
        Index of the poke.

    Returns
    -------
    dict of str to ndarray, shape (frames,)
        By "inclusion" and "base", negative where the rod is inside.
    """
    table, rows = data.table, data.rows(index, "frame")
    inclusion = data.inclusion(int(table["poke_geometry"][index]))
    rod = data.attributes["identity"]["recipe"]["rod"]
    tips, axes = table["rod_tip"][rows], table["rod_axis"][rows]
    # the whole tip, and so much of the shaft as comes below the inclusion's top at the flattest of its angles
    steepness = max(float(np.abs(axes[:, 2]).min()), 0.1)
    below = max(inclusion.bounds[1][2] - float(tips[:, 2].min()), 0.0)
    surface = rod_points(rod, below / steepness + 2e-3 * rod["radius_mm"])
    found = {"inclusion": np.empty(len(tips)), "base": np.empty(len(tips))}
    for frame, (tip, axis) in enumerate(zip(tips, axes, strict=True)):
        points = tip + surface @ _frame_along(axis)
        found["inclusion"][frame] = inclusion.signed_distance(points).min()
        found["base"][frame] = points[:, 2].min()
    return found


def rod_points(rod: Mapping[str, Any], length: float, *, spacing: float = SPACING) -> Array:
    """Points on a rod's tip and shaft.

    Parameters
    ----------
    rod : mapping
        The rod of a recipe: `radius_mm`, `tip`, `edge_radius_mm`.
    length : float
        Length of the shaft, from the tip's centre [m].
    spacing : float
        Largest distance between neighbours along the rod and around it [m].

    Returns
    -------
    ndarray, shape (n, 3)
        Positions [m] from the tip's centre; the rod points along z, and its shaft is at negative z.
    """
    radius = rod["radius_mm"] * 1e-3
    edge = radius if rod["tip"] == "hemisphere" else min(rod["edge_radius_mm"] * 1e-3, radius)
    flat = radius - edge
    # the profile, as distance from the axis and height behind the tip's centre: flat end, rounded edge, shaft
    turn = np.linspace(0.0, 0.5 * math.pi, _pieces(0.5 * math.pi * edge, spacing) + 1)
    inner = np.linspace(0.0, flat, _pieces(flat, spacing) + 1)
    shaft = np.linspace(edge, max(length, edge), _pieces(length - edge, spacing) + 1)
    away = np.concatenate([inner, flat + edge * np.sin(turn[1:]), np.full(len(shaft) - 1, radius)])
    behind = np.concatenate([0.0 * inner, edge * (1.0 - np.cos(turn[1:])), shaft[1:]])
    rings = []
    for ring, height in zip(away, behind, strict=True):
        around = np.linspace(0.0, 2.0 * math.pi, _pieces(2.0 * math.pi * ring, spacing), endpoint=False)
        rings.append(
            np.column_stack([ring * np.cos(around), ring * np.sin(around), np.full(len(around), -height)])
        )
    return np.concatenate(rings)


def _pieces(length: float, spacing: float) -> int:
    return max(1, math.ceil(length / spacing))


def _frame_along(axis: Array) -> Array:
    """Rotation (3, 3) whose last row is `axis`: `points @ rotation` turns points from z to it."""
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    return np.stack([np.cross(across, axis), across, axis])
