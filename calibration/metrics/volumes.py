"""Volumes of two bodies: the Dice coefficient of what they share, and the difference of their volumes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.metrics._metric import Metric, check_body

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]

# The lines are put off the round coordinates on which bodies have their edges.
_OFFSET = (0.381966, 0.276393)


def shared_volume(
    first: trimesh.Trimesh, second: trimesh.Trimesh, *, spacing: float
) -> tuple[float, float, float]:
    """Volumes [m3] of the intersection, of the first and of the second body.

    Lines along z on a square grid of `spacing` [m]; along each line the winding number of a body changes by
    one where it passes the surface, and space with a positive number is inside.
    """
    if not spacing > 0:
        raise ValueError(f"spacing: expected a positive length, got {spacing}")
    low = np.minimum(first.bounds[0], second.bounds[0])[:2]
    events = [_crossings(np.asarray(m.triangles), low, spacing) for m in (first, second)]
    column = np.concatenate([e[0] for e in events])
    z = np.concatenate([e[1] for e in events])
    change = np.zeros((len(z), 2))
    n = len(events[0][0])
    change[:n, 0], change[n:, 1] = events[0][2], events[1][2]
    order = np.lexsort((z, column))
    column, z, change = column[order], z[order], change[order]
    # the changes along a whole line sum to zero, so one running sum serves all lines
    inside = np.cumsum(change, axis=0)[:-1] > 0.5
    step = np.where(np.diff(column) == 0, np.diff(z), 0.0) * spacing**2
    return (
        float(step[inside.all(axis=1)].sum()),
        float(step[inside[:, 0]].sum()),
        float(step[inside[:, 1]].sum()),
    )


def _crossings(triangles: Array, low: Array, spacing: float) -> tuple[NDArray[np.int64], Array, Array]:
    """Intersections of the grid's lines with a surface: line number, z [m], and +1 inwards, -1 outwards."""
    flat = (triangles[:, :, :2] - low) / spacing - np.array(_OFFSET)
    lowest, highest = np.ceil(flat.min(axis=1)), np.floor(flat.max(axis=1))
    size = np.maximum(highest - lowest + 1, 0).astype(np.int64)
    count = size.prod(axis=1)
    which = np.repeat(np.arange(len(flat)), count)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    i = lowest[which, 0] + rank // size[which, 1]
    j = lowest[which, 1] + rank % size[which, 1]
    a, b, c = (flat[which, m] for m in range(3))
    p = np.column_stack([i, j])
    area = _cross(b - a, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):  # triangles that stand upright meet no line
        u, v, w = (_cross(c - b, p - b) / area, _cross(a - c, p - c) / area, _cross(b - a, p - a) / area)
    hit = (area != 0) & (u > 0) & (v > 0) & (w > 0)
    weights = np.column_stack([u, v, w])[hit]
    z = (weights * triangles[which[hit], :, 2]).sum(axis=1)
    number = (i[hit] + 2**20).astype(np.int64) * 2**22 + (j[hit] + 2**20).astype(np.int64)
    # a face that looks upwards (area > 0) is where a line going up leaves the body
    return number, z, -np.sign(area[hit])


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


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
    import trimesh  # an extra: only bodies need it

    middle = first.bounds.mean(axis=0)
    moved = [trimesh.Trimesh(m.vertices - middle, m.faces, process=False) for m in (first, second)]
    try:
        both = trimesh.boolean.intersection(moved, engine="manifold")
    except Exception as error:  # the engine raises what it likes
        raise InputError(f"Dice: the bodies could not be intersected: {error}") from error
    return float(both.volume) if len(both.faces) else 0.0


DICE = Metric(name="dice", title="Dice", unit="1", higher_is_better=True, compute=dice)


def volume_difference(simulated: trimesh.Trimesh, measured: trimesh.Trimesh) -> float:
    """``|V(simulated) - V(measured)| / V(measured)``, a ratio (0.01 is 1 %); the order of the bodies matters.

    It says whether the bodies are of one size, not whether they lie at one place: for a beam it is a matter
    of the reference geometry (section, facets, stretch of the mid line) more than of the material law.
    Raises InputError where a surface is not closed.
    Source: relative absolute volume difference, Heimann et al., IEEE Trans. Med. Imaging 28 (2009) 1251-1265.
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    return abs(float(simulated.volume) - float(measured.volume)) / float(measured.volume)


VOLUME_DIFFERENCE = Metric(
    name="volume_difference",
    title="volume difference",
    unit="1",
    higher_is_better=False,
    compute=volume_difference,
)
