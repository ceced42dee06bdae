"""Quantities of a poke: those that its domain of validity and its intervals depend on."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from learn.data._format import GRID, RIGID
from learn.data.setup import Setup
from learn.data.store import Store

Floats = NDArray[np.float64]
NEAR = 16e-3  # m; largest gap to what is rigid that errors depend on (studies/learning/two-fifths.md)
KINDS = ("cube", "cylinder", "sphere", "none")
COVARIATES = ("inclusion_size_mm", "gap_mm", "angle_deg")


class Quantity(NamedTuple):
    """One quantity of a poke. `sides`: checked ends of the trained range; `slack`: absolute tolerance."""

    name: str
    units: str
    sides: Literal["both", "low", "high"]
    slack: float


# The slack of cover and inclusion is the profile's resolution: a level is 0.25 mm high, a column 3.1 mm wide.
QUANTITIES: dict[str, Quantity] = {
    "depth_mm": Quantity("depth", "mm", "both", 0.01),
    "angle_deg": Quantity("angle", "degrees", "both", 0.1),
    "cover_mm": Quantity("cover over the inclusion", "mm", "both", 0.3),
    "depth_over_cover": Quantity("depth over cover", "", "high", 0.01),
    "shear_modulus_kPa": Quantity("shear modulus", "kPa", "both", 0.01),
    "rod_radius_mm": Quantity("indenter radius", "mm", "both", 1e-3),
    "rod_edge_mm": Quantity("radius of the indenter's edge", "mm", "both", 1e-3),
    "block_x_mm": Quantity("block's length in x", "mm", "both", 0.1),
    "block_y_mm": Quantity("block's length in y", "mm", "both", 0.1),
    "block_z_mm": Quantity("block's height", "mm", "both", 0.1),
    "site_to_side_mm": Quantity("distance of the contact point from the block's sides", "mm", "low", 0.1),
    "inclusion_width_mm": Quantity("inclusion's width", "mm", "both", 1.6),
    "inclusion_height_mm": Quantity("inclusion's height", "mm", "both", 0.3),
}
# further quantities in datasets with time, in the order of `Pokes.clock`
CLOCK_QUANTITIES: dict[str, Quantity] = {
    "time_s": Quantity("time since contact", "s", "both", 1e-3),
    "rod_speed_mm_per_s": Quantity("indenter speed", "mm/s", "both", 1e-2),
    "approach_speed_mm_per_s": Quantity("speed of approach", "mm/s", "both", 1e-2),
}


class Interior(NamedTuple):
    """Quantities of an interior on which those of a poke depend.

    `soft`: thickness of the soft tissue above the inclusion, or above the base, at each point (n,) [m];
    `width`, `height` of the inclusion [mm]; `size`: cube root of its volume [mm], 0 without one.
    """

    soft: Floats
    width: float
    height: float
    size: float


def interior_of(setup: Setup, profile: NDArray[np.uint8]) -> Interior:
    """Interior of a `profile`, the stored stiffness under each point, shape (n, levels)."""
    rigid = profile == RIGID
    length, breadth, height = setup.block_size
    columns = rigid.any(axis=1)
    soft = np.where(columns, rigid.argmax(axis=1), rigid.shape[1]) * (height / rigid.shape[1])
    area = columns.sum() * length * breadth / len(setup.points)
    tall = (height - float(soft.min())) * 1e3 if columns.any() else 0.0
    volume = float(rigid.mean()) * length * breadth * height
    return Interior(soft, 2e3 * math.sqrt(area / math.pi), tall, 1e3 * math.cbrt(volume))


def gap_mm(setup: Setup, interior: Interior, tip: Floats) -> float:
    """Distance from the indenter's tip (3,) [m] to what is rigid, at most `NEAR` [mm].

    Rigid is what lies below the soft tissue of each column, the base of the block as well.
    """
    x, y, z = setup.points.T
    below = np.maximum(tip[2] - (z - interior.soft), 0.0)
    square = (x - tip[0]) ** 2 + (y - tip[1]) ** 2 + below * below
    return 1e3 * min(NEAR, math.sqrt(float(square.min())))


def covariates(setup: Setup, interior: Interior, *, start: Floats, direction: Floats, depth: float) -> Floats:
    """What the errors of a prediction depend on besides the point: values of `COVARIATES`.

    The size of the inclusion (cube root of its volume) [mm], the gap between the indenter's tip and what is
    rigid [mm], and the angle between the push and the surface's normal [degrees].
    """
    gap = gap_mm(setup, interior, start + depth * direction)
    return np.array([interior.size, gap, math.degrees(math.acos(min(1.0, -float(direction[2]))))])


def cover_at(setup: Setup, interior: Interior, start: Floats, direction: Floats) -> float:
    """Least thickness of the soft tissue [m] within an indenter's radius of the contact site."""
    site = setup.contact_site(start, direction)
    x, y = setup.points[:, 0] - site[0], setup.points[:, 1] - site[1]
    square = x * x + y * y
    near = square <= max(setup.rod_radius**2, float(square.min()))
    return float(interior.soft[near].min())


class Obstacle(NamedTuple):
    """Where the indenter's tip meets the inclusion: the travel until there, and the cover above it [m]."""

    depth: float
    cover: float


def obstacle(setup: Setup, interior: Interior, start: Floats, direction: Floats) -> Obstacle | None:
    """What a push comes to before the base: no tip can be there or beyond; None if nothing is in its way.

    The tip is a level of the profile below the top of what is rigid in its column, the profile's resolution.
    `start` is the tip at first contact [m], `direction` the unit vector of the push.
    """
    (length, breadth, height), levels = setup.block_size, len(setup.level_depth)
    depth = np.arange(1, 2 * levels + 1) * (height / (2 * levels) / -float(direction[2]))
    x, y = ((start[k] + depth * direction[k] - setup.middle[k]) for k in (0, 1))
    column, row = (
        np.clip(np.floor((at / side + 0.5) * GRID), 0, GRID - 1).astype(np.intp)
        for at, side in ((x, length), (y, breadth))
    )
    soft = interior.soft[row * GRID + column]
    level = np.floor((setup.top - start[2] - depth * direction[2]) * (levels / height) + 1e-9)
    # the base is no inclusion: a tip comes as near to it as the height of the block allows
    met = (level > np.rint(soft * (levels / height))) & (level <= levels)
    first = int(met.argmax())
    return Obstacle(float(depth[first]), float(soft[first])) if met[first] else None


def poke_values(
    setup: Setup,
    interior: Interior,
    *,
    start: Floats,
    direction: Floats,
    depth: float,
    modulus: float,
    clock: Floats | None = None,
    cover: float | None = None,
) -> dict[str, float]:
    """Values of `QUANTITIES` for one poke, in their order, and of `CLOCK_QUANTITIES` if it has a clock.

    Parameters
    ----------
    interior : from `interior_of`.
    start, direction, depth, modulus, clock : the poke in SI units, as in `learn.models.Pokes`.
    cover : `cover_at` of this contact, if it is already known.
    """
    length, width, height = setup.block_size
    site = setup.contact_site(start, direction)
    level = height / len(setup.level_depth)
    cover = cover_at(setup, interior, start, direction) if cover is None else cover
    cosine = min(1.0, float(-direction[2]))
    to_side = float((np.array([length, width]) / 2 - np.abs(site - setup.middle)).min())
    timed = {}
    if clock is not None and len(clock):
        timed = dict(zip(CLOCK_QUANTITIES, (clock * np.array([1.0, 1e3, 1e3])).tolist(), strict=True))
    return {
        "depth_mm": depth * 1e3,
        "angle_deg": math.degrees(math.acos(cosine)),
        "cover_mm": cover * 1e3,
        "depth_over_cover": depth * cosine / max(cover, level),
        "shear_modulus_kPa": modulus * 1e-3,
        "rod_radius_mm": setup.rod_radius * 1e3,
        "rod_edge_mm": setup.rod_edge * 1e3,
        "block_x_mm": length * 1e3,
        "block_y_mm": width * 1e3,
        "block_z_mm": height * 1e3,
        "site_to_side_mm": to_side * 1e3,
        "inclusion_width_mm": interior.width,
        "inclusion_height_mm": interior.height,
        **timed,
    }


def shape_kind(store: Store, name: str) -> str | None:
    """Kind of inclusion of a shape of the dataset; None if it is not known."""
    try:
        shapes = store.attributes["identity"]["recipe"]["shapes"]
        return next(str(shape["kind"]) for shape in shapes if shape["id"] == name)
    except (KeyError, TypeError, StopIteration):
        kind = name.partition("-")[0]
        return kind if kind in KINDS else None
