"""Dice: how much of two bodies they share."""

from __future__ import annotations

from typing import Literal

import trimesh

from calibration.errors import InputError
from calibration.metrics._metric import Metric, check_body
from calibration.metrics._winding import shared_volume

_SLACK = 1e-5  # relative: what rounding of the boolean (single precision) can add to a volume


def dice(
    simulated: trimesh.Trimesh,
    measured: trimesh.Trimesh,
    *,
    method: Literal["boolean", "winding"] = "boolean",
    spacing: float = 0.25e-3,
) -> float:
    """Overlap 2 V(A and B) / (V(A) + V(B)) of two bodies: 1 for the same body, 0 for disjoint ones.

    method: "boolean" intersects the surfaces exactly (manifold3d); "winding" integrates the winding numbers
        along parallel lines `spacing` [m] apart, which also works where a surface crosses itself. The choice
        is the caller's: one never stands in for the other.
    Raises InputError where a surface is not closed, or the boolean fails.
    Source: L. R. Dice, Measures of the amount of ecologic association between species, Ecology 26 (1945), on
    volumes; Taha and Hanbury, BMC Medical Imaging 15:29 (2015).
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    if method == "winding":
        shared, first, second = shared_volume(simulated, measured, spacing=spacing)
        return 2 * shared / (first + second)
    if method != "boolean":
        raise ValueError(f"method: expected 'boolean' or 'winding', got {method!r}")
    first, second = float(simulated.volume), float(measured.volume)
    shared = _intersection(simulated, measured)
    if not -_SLACK * min(first, second) <= shared <= (1 + _SLACK) * min(first, second):
        raise InputError(
            f"Dice: the intersection came out as {shared:.4g} m3 for bodies of {first:.4g} and "
            f"{second:.4g} m3; does a surface cross itself? method='winding' allows that"
        )
    return min(max(2 * shared / (first + second), 0.0), 1.0)


def _intersection(first: trimesh.Trimesh, second: trimesh.Trimesh) -> float:
    """Volume [m3]; both are moved to the origin, since manifold3d is handed single precision."""
    middle = first.bounds.mean(axis=0)
    moved = [trimesh.Trimesh(m.vertices - middle, m.faces, process=False) for m in (first, second)]
    try:
        both = trimesh.boolean.intersection(moved, engine="manifold")
    except Exception as error:  # the engine raises what it likes
        raise InputError(f"Dice: the bodies could not be intersected: {error}") from error
    return float(both.volume) if len(both.faces) else 0.0


METRIC = Metric(name="dice", title="Dice", unit="1", higher_is_better=True, compute=dice)
