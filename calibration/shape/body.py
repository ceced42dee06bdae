"""Bodies as closed surfaces: a section swept along a mid line, a simulated beam's skin, and their files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

import tisim
from calibration.errors import InputError
from calibration.shape._edges import section_angle
from calibration.shape.centreline import Centreline
from tisim import frame_index
from tisim.mesh import MeshError, boundary_facets, checked_surface, unfold

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]


def sweep(
    centreline: Centreline,
    section: tisim.Circle | tisim.Rectangle,
    *,
    grip_length: float = 0.0,
    segments: int = 64,
    spacing: float = 1e-3,
    true_area: bool = True,
) -> trimesh.Trimesh:
    """Watertight body of the undeformed section swept along a mid line [m], y = 0 its plane, with end caps.

    Sections stand across the line and turn into the plane of a clamp's face within one section height of it,
    so that a clamped end is cut at x = constant; each is centred on the line, so the volume is area times
    length (Pappus).
    grip_length: straight pieces along x added behind each clamp face [m]; 0 for none, as in tisim's beams.
    segments: straight sides of a circle (rectangles take as many points, corners among them).
    spacing: longest step between sections along the line [m].
    true_area: the polygon of a circle has the circle's area (its corners lie outside the circle by 0.08 %
        of the radius at 64 sides); False inscribes it, as CAD export does, and loses 0.73 % of the area at
        30 sides.
    Raises InputError where the line bends so sharply that neighbouring sections would meet.
    """
    if segments < 3:
        raise ValueError(f"segments: expected at least 3, got {segments}")
    if not spacing > 0 or grip_length < 0:
        raise ValueError("sweep: expected a positive spacing and no negative grip length")
    ring = _section_ring(section, segments, true_area)
    both = centreline.supports == "clamped-clamped"
    height = float(np.ptp(ring[:, 1]))
    s = np.linspace(0.0, centreline.length, max(int(np.ceil(centreline.length / spacing)), 2) + 1)
    points, angle = centreline.at(s)
    turn = section_angle(s, angle, height=height, start=0.0, end=s[-1] if both else None)
    # the section that lies aslant to the line is longer, as a cylinder cut aslant is
    stretch = 1.0 / np.cos(angle - turn)
    _check_bend(s, points, turn, stretch, height)
    if grip_length > 0:
        points, turn, stretch = _with_grip(points, turn, stretch, step=-grip_length)
        if both:
            points, turn, stretch = (a[::-1] for a in (points, turn, stretch))
            points, turn, stretch = _with_grip(points, turn, stretch, step=grip_length)
            points, turn, stretch = (a[::-1] for a in (points, turn, stretch))
    return _skin(ring, points, turn, stretch)


def _section_ring(section: tisim.Circle | tisim.Rectangle, segments: int, true_area: bool) -> Array:
    """Polygon of the section, (n, 2) as y, z [m], counter-clockwise seen against +x."""
    if isinstance(section, tisim.Circle):
        radius = section.radius
        if true_area:
            radius *= np.sqrt(2 * np.pi / (segments * np.sin(2 * np.pi / segments)))
        phase = 2 * np.pi * np.arange(segments) / segments
        return np.asarray(radius * np.column_stack([np.cos(phase), np.sin(phase)]))
    y, z = section.half_width, section.half_height
    corners = np.array([[y, -z], [y, z], [-y, z], [-y, -z]])
    side = np.linspace(0.0, 1.0, max(segments // 4, 1), endpoint=False)[:, None]
    return np.concatenate([(1 - side) * corners[i] + side * corners[(i + 1) % 4] for i in range(4)])


def _check_bend(s: Array, points: Array, turn: Array, stretch: Array, height: float) -> None:
    """Neighbouring sections must not meet: their top and bottom ends move on along the line."""
    across = np.column_stack([-np.sin(turn), np.cos(turn)]) * (stretch * height / 2)[:, None]
    forward = np.column_stack([np.cos(turn), np.sin(turn)])
    for side in (1.0, -1.0):
        moved = (np.diff(points + side * across, axis=0) * (forward[1:] + forward[:-1])).sum(axis=1)
        if (moved <= 0).any():
            where = s[int(np.argmax(moved <= 0))]
            raise InputError(
                f"mid line: it bends too sharply at {where * 1e3:.1f} mm for a section "
                f"{height * 1e3:.1f} mm high"
            )


def _with_grip(points: Array, turn: Array, stretch: Array, *, step: float) -> tuple[Array, Array, Array]:
    """A straight piece before the first section: the undeformed section between x + step and the face."""
    first = points[0]
    extra = [first + np.array([step, 0.0])]
    if abs(stretch[0] - 1.0) > 1e-6:  # the free part's section in the clamp face is the larger one
        extra.append(first)
    n = len(extra)
    return (
        np.concatenate([extra, points]),
        np.concatenate([np.zeros(n), turn]),
        np.concatenate([np.ones(n), stretch]),
    )


def _skin(ring: Array, points: Array, turn: Array, stretch: Array) -> trimesh.Trimesh:
    import trimesh  # an extra: only bodies need it

    k, n = len(points), len(ring)
    across = np.column_stack([-np.sin(turn), np.zeros(k), np.cos(turn)]) * stretch[:, None]
    centres = np.column_stack([points[:, 0], np.zeros(k), points[:, 1]])
    rings = centres[:, None] + ring[None, :, 1:] * across[:, None]
    rings[:, :, 1] += ring[:, 0]
    a = (np.arange(k - 1)[:, None] * n + np.arange(n)).ravel()
    b = (np.arange(k - 1)[:, None] * n + np.roll(np.arange(n), -1)).ravel()
    sides = np.concatenate([np.column_stack([a, b, b + n]), np.column_stack([a, b + n, a + n])])
    around = np.arange(n)
    caps = np.concatenate(
        [
            np.column_stack([np.full(n, k * n), np.roll(around, -1), around]),
            np.column_stack([np.full(n, k * n + 1), (k - 1) * n + around, (k - 1) * n + np.roll(around, -1)]),
        ]
    )
    vertices = np.concatenate([rings.reshape(-1, 3), centres[[0, -1]]])
    body = trimesh.Trimesh(vertices, np.concatenate([sides, caps]), process=False)
    if not body.is_watertight or body.volume <= 0:
        raise InputError("mid line: the swept body does not close or is inside-out")
    return body


def body_mesh(result: tisim.Result, *, frame: int = -1, subdivide: int = 8) -> trimesh.Trimesh:
    """Watertight surface of a simulated body at one of its frames [m], faces outward.

    Half models are mirrored to the whole body. Curved six-node facets are cut into subdivide**2 flat
    triangles whose corners lie on the quadratic surface: of the area of a section of 12 such sides (tisim's
    default beam) 2 would lose 1.1 %, 4 0.28 % and 8 0.07 %. Facets of 3 and 4 nodes are taken as they are.
    What the grips hold is not part of tisim's beams, and so not of the body.
    Raises InputError where the result has no such frame or its surface does not close.
    """
    import trimesh  # an extra: only bodies need it

    if subdivide < 1:
        raise ValueError(f"subdivide: expected at least 1, got {subdivide}")
    try:
        frame = frame_index(result, frame)
    except ValueError as error:
        raise InputError(f"simulated body: {error}") from error
    mesh, x = unfold(result.mesh, result.positions[frame])
    if mesh.kind == "tet10":
        facets = mesh.facet_sets.get("surface")
        facets = boundary_facets(mesh.kind, mesh.elements) if facets is None else facets
        vertices, faces = _cut_quadratic(x, np.asarray(facets, dtype=np.int64), subdivide)
    else:
        vertices, faces = x, np.asarray(tisim.surface_triangles(mesh), dtype=np.int64)
    used, place = np.unique(faces, return_inverse=True)
    body = trimesh.Trimesh(vertices[used], place.reshape(-1, 3), process=False)
    if not body.is_watertight or not body.is_winding_consistent or body.volume <= 0:
        raise InputError(
            "simulated body: its surface does not close; does its mesh have holes or loose parts?"
        )
    return body


def body_between(body: trimesh.Trimesh, first: float, last: float) -> trimesh.Trimesh:
    """The part of a body at x from `first` to `last` [m], closed by flat faces; either may be infinite.

    InputError where the body cannot be cut.
    """
    import trimesh  # an extra: only bodies need it

    low, high = body.bounds
    margin = float((high - low).max())
    low, high = low - margin, high + margin
    low[0], high[0] = max(low[0], first), min(high[0], last)
    # at the origin, since manifold3d is handed single precision
    middle = body.bounds.mean(axis=0)
    whole = trimesh.Trimesh(body.vertices - middle, body.faces, process=False)
    box = trimesh.creation.box(bounds=[low - middle, high - middle])
    try:
        part = trimesh.boolean.intersection([whole, box], engine="manifold")
    except Exception as error:  # the engine raises what it likes
        raise InputError(f"body: it could not be cut at the grips: {error}") from error
    if not len(part.faces):
        raise InputError(f"body: nothing of it lies at x from {1e3 * first:g} to {1e3 * last:g} mm")
    return trimesh.Trimesh(part.vertices + middle, part.faces, process=False)


def _cut_quadratic(x: Array, facets: NDArray[np.int64], n: int) -> tuple[Array, NDArray[np.int64]]:
    """Facets of six nodes (f, 6) as n*n triangles each: vertices (v, 3) and faces (t, 3).

    Points on an edge are computed from the edge's own three nodes in one order, and named by them, so that
    neighbours share them to the last bit.
    """
    lattice = [(i, j, n - i - j) for i in range(n + 1) for j in range(n + 1 - i)]
    place = {key: index for index, key in enumerate(lattice)}
    keys = np.empty((len(facets), len(lattice), 4), dtype=np.int64)
    points = np.empty((len(facets), len(lattice), 3))
    a, b, c, ab, bc, ca = facets.T
    edges = {2: (a, b, ab), 0: (b, c, bc), 1: (c, a, ca)}  # by the corner that is not on it
    corners = (a, b, c)
    for index, lam in enumerate(lattice):
        zeros = [m for m in range(3) if lam[m] == 0]
        if len(zeros) == 2:
            node = corners[next(m for m in range(3) if lam[m])]
            keys[:, index] = np.column_stack([node, node, node * 0, node * 0])
            points[:, index] = x[node]
        elif len(zeros) == 1:
            first, second, middle = edges[zeros[0]]
            step = np.full(len(facets), lam[(zeros[0] + 2) % 3])  # how far from first to second, of n
            turned = first > second
            low, high = np.where(turned, second, first), np.where(turned, first, second)
            step = np.where(turned, n - step, step)
            keys[:, index] = np.column_stack([low, high, step, step * 0])
            t = (step / n)[:, None]
            points[:, index] = (
                (1 - t) * (1 - 2 * t) * x[low] + t * (2 * t - 1) * x[high] + 4 * t * (1 - t) * x[middle]
            )
        else:
            u, v, w = (q / n for q in lam)
            weights = (u * (2 * u - 1), v * (2 * v - 1), w * (2 * w - 1), 4 * u * v, 4 * v * w, 4 * w * u)
            points[:, index] = sum(weight * x[facets[:, m]] for m, weight in enumerate(weights))
            number = np.arange(len(facets))
            keys[:, index] = np.column_stack([number * 0 - 1, number, number * 0 + index, number * 0])
    _, first_seen, inverse = np.unique(keys.reshape(-1, 4), axis=0, return_index=True, return_inverse=True)
    local = []
    for i, j, k in lattice:
        if k > 0:
            local.append((place[i + 1, j, k - 1], place[i, j + 1, k - 1], place[i, j, k]))
        if j > 0 and k > 0:
            local.append((place[i + 1, j, k - 1], place[i + 1, j - 1, k], place[i, j, k])[::-1])
    faces = inverse.reshape(len(facets), -1)[:, np.array(local)].reshape(-1, 3)
    return points.reshape(-1, 3)[first_seen], faces.astype(np.int64)


Units = Literal["mm", "m"]

_ENDINGS = (".stl", ".ply")


def read_mesh(path: str | Path, *, units: Units) -> trimesh.Trimesh:
    """A closed body from an STL or PLY file, in metres, its faces turned outwards.

    units: of the file's coordinates; neither format says.
    Raises InputError (one sentence) for another ending, a file that cannot be read, a surface that is open,
    crosses itself or is in several pieces, or a size that belies the units.
    """
    path = Path(path)
    if units not in ("mm", "m"):
        raise InputError(f"{path}: units: expected 'mm' or 'm', got {units!r}")
    if path.suffix.lower() not in _ENDINGS:
        raise InputError(f"{path}: expected a name that ends in .stl or .ply")
    try:
        return checked_surface(path, units=units)
    except MeshError as error:
        raise InputError(f"{error}") from error
