"""Mesh of a block for indentation by a rod: fine under the rod's edge, coarse far away."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Block, Rod, Vector
from tisim.mesh._columns import extrude
from tisim.mesh._elements import det_jacobian, is_sound, quadrature
from tisim.mesh._inclusion import Outline, outline_of
from tisim.mesh._mesh import ElementKind, Mesh, MeshError
from tisim.mesh._ogrid import Focus, PlaneGrid, o_grid
from tisim.mesh._snap import Snapped, snap

Floats = NDArray[np.float64]

# Version of the mesh of datasets, which is of 20-node hexahedra: raised when it changes for any poke. A
# dataset has one version only.
LAYOUT = 3
# Coefficient of friction from which the surface sticks to most of the rod's tip.
STICKS = 0.6
# Exponent, less 1, of the positions of the rings beside the rod where the surface slides.
CLOSER = 0.74
STEEPEST = np.radians(45.5)
# Least distance of an upright rod's axis from the sides, in rod radii: the outermost fine ring and a cell.
CLEARANCE = 1.8
# Grids tried until one fits the inclusion well: (factor of the spacing at the inclusion, rotation of the rays
# as a fraction of their spacing, number of additional rings).
ATTEMPTS = (
    *((1.00, 0.0, 0), (1.00, 0.5, 1), (0.85, 0.25, 0), (0.85, 0.75, 1), (0.92, 0.33, 2), (0.78, 0.0, 0)),
    *((0.78, 0.5, 1), (0.72, 0.67, 0), (0.65, 0.25, 1), (0.65, 0.75, 2), (0.78, 0.1, 3), (0.65, 0.4, 3)),
    *((0.50, 0.0, 2), (0.50, 0.5, 4), (0.55, 0.33, 3), (0.45, 0.67, 1), (0.40, 0.25, 3), (0.40, 0.75, 5)),
    *((0.35, 0.5, 2), (0.35, 0.0, 6), (0.30, 0.25, 4), (0.30, 0.8, 7), (1.00, 0.8, 2), (1.00, 0.0, 6)),
    *((0.85, 0.4, 6), (1.00, 0.6, 6), (0.25, 0.4, 7), (0.40, 0.5, 9)),
)
# size of cells at an inclusion, relative to the radius of its outline's inscribed circle: about ten nodes on
# a circle; smaller for a sphere, whose surface is approximated by facets too
CELL_AT_OUTLINE = 0.65
CELL_AT_DOME = 0.40
# factor of that size for hex20, which has nodes in the middle of its edges
COARSER_QUADRATIC = 1.5
# factor of that size if the rod is FAR [m] or more from the outline
COARSER_FAR_AWAY = 1.3
FAR = 0.020
GOOD_QUALITY = 0.12
WORST_QUALITY = 0.01
# fraction of its plan area that an inclusion may lose to the chords of its outline; curved edges of hex20
# recover it, so that their criterion is the volume
AREA_LOST, AREA_LOST_BOWED = 0.10, 0.15
# allowed ratio of meshed to true volume, of prisms and of spheroids, whose thin gap to the base is filled; of
# prisms with straight edges the plan area decides (AREA_LOST)
VOLUME = (0.95, 1.001)
VOLUME_OF_DOME, VOLUME_OF_FACETS = (0.80, 1.14), (0.70, 1.14)


def poke_mesh(
    *,
    block: Block,
    site: tuple[float, float],
    direction: Vector = (0.0, 0.0, -1.0),
    rod: Rod,
    friction: float = STICKS,
    refinement: float = 1.0,
    kind: ElementKind = "hex20",
) -> Mesh:
    """Mesh of the block for a rod pushed along `direction` at `site` (x, y) [m].

    A round inclusion is approximated by chords and facets: the corners lie on its surface, and its meshed
    volume is a few percent too small, of a small sphere in linear elements up to 30 %. If no grid is within
    the tolerance of the volume, the closest one is used. Soft material thinner than 1 mm between an inclusion
    and the base is meshed as rigid.

    Parameters
    ----------
    block : Block
    site : (float, float)
        Point at which the rod's axis meets the top, (x, y) [m].
    direction : (float, float, float)
        Direction of the push, up to 45 degrees from -z.
    rod : Rod
    friction : float
        Coefficient of friction; the rings beside the rod are closer to it where the surface slides.
    refinement : float
        Factor by which spacings become smaller, 0.5 to 6; with 1 there are about 2,900 nodes without an
        inclusion (3,500 of hex8).
    kind : "hex20", "hex8", "tet4" or "tet10"
        Type of the elements. Hexahedra include wedges (with repeated nodes) where an inclusion's outline cuts
        a cell; tetrahedra are cut from the grid of hex8.

    Returns
    -------
    Mesh
        Node sets: "base" (all fixed nodes: on z = 0 and on the inclusion), "top". Facet sets: "top" (outward
        is +z; in quad4 and quad8 a triangle repeats a node), "surface" (the whole boundary).

    Raises
    ------
    MeshError
        For arguments out of range, or an inclusion that no grid fits; the message is one sentence.
    """
    if kind not in ("hex20", "hex8", "tet4", "tet10"):
        raise MeshError(f"poke mesh: expected kind hex20, hex8, tet4 or tet10, got {kind!r}")
    size = _checked_size(block)
    grids = _Grids(
        size=size,
        site=site,
        direction=direction,
        rod=rod,
        friction=friction,
        refinement=refinement,
        kind=kind,
    )
    if block.inclusion is None:
        grid = grids.make(None)
        return extrude(points=grid.points, cells=grid.cells, size=size, refinement=refinement, kind=kind)
    outline = outline_of(block.inclusion, size=size)
    away = float(np.clip((np.hypot(*(outline.centre - grids.site)) - outline.reach) / FAR, 0.0, 1.0))
    coarser = 1.0 + away * (COARSER_FAR_AWAY - 1.0)
    cell = coarser * (CELL_AT_OUTLINE if outline.dome is None else CELL_AT_DOME) * outline.radius / refinement
    cell *= COARSER_QUADRATIC if kind == "hex20" and outline.dome is None else 1.0
    flat: list[tuple[float, PlaneGrid, Snapped]] = []
    spare: list[tuple[float, Mesh]] = []
    for spacing, turn, more in ATTEMPTS:
        focus = Focus(centre=outline.centre, reach=outline.reach, spacing=spacing * cell)
        grid = grids.make(focus, turn=turn, more=more)
        snapped = snap(points=grid.points, cells=grid.cells, border=grid.border, outline=outline)
        if snapped is None or not _meets(snapped, outline, kind):
            continue
        if snapped.quality < GOOD_QUALITY:
            flat.append((snapped.quality, grid, snapped))
            continue
        mesh = _raised(grid, snapped, size=size, refinement=refinement, kind=kind, outline=outline)
        if mesh is not None:
            off = _volume_off(mesh, outline, size)
            if off == 0.0:
                return mesh
            spare.append((off, mesh))
    if spare:
        return min(spare, key=lambda one: one[0])[1]
    met = sorted(flat, key=lambda one: -one[0])
    for _, grid, snapped in [one for one in met if one[0] >= WORST_QUALITY]:
        mesh = _raised(grid, snapped, size=size, refinement=refinement, kind=kind, outline=outline)
        if mesh is not None:
            return mesh
    raise MeshError(
        f"inclusion: no grid around the poke site {tuple(site)} meets its outline without elements that turn "
        "over; try a larger refinement, or an inclusion that is wider"
    )


def sliding(friction: float) -> float:
    """How much of the surface slides round the rod's edge while the rest sticks to its tip, 0 to 1.

    4 t (1 - t) with t = friction / STICKS: 0 without friction and where the surface sticks. In between the
    force is the more sensitive to the elements and the contact at the edge (studies/depth).
    """
    t = min(friction / STICKS, 1.0)
    return 4.0 * t * (1.0 - t)


def check_indentation(
    *, block: Block, site: tuple[float, float], direction: Vector, rod: Rod, refinement: float
) -> None:
    """Raise the MeshError of `poke_mesh` for arguments out of range, without making a mesh."""
    size = _checked_size(block)
    _Grids(size=size, site=site, direction=direction, rod=rod, refinement=refinement)
    if block.inclusion is not None:
        outline_of(block.inclusion, size=size)


def _raised(
    grid: PlaneGrid,
    snapped: Snapped,
    *,
    size: tuple[float, float, float],
    refinement: float,
    kind: ElementKind,
    outline: Outline,
) -> Mesh | None:
    """The block's mesh over a plane grid; None if elements are inverted."""
    # above the inclusion the columns return to the undisturbed grid, if the cover is thick enough
    for top_points in (grid.points, None):
        mesh = extrude(
            points=snapped.points,
            cells=snapped.cells,
            size=size,
            refinement=refinement,
            kind=kind,
            outline=outline,
            side=snapped.side,
            within=snapped.within,
            top_points=top_points,
        )
        if is_sound(kind, mesh.nodes, mesh.elements):
            return mesh
    return None


def _meets(snapped: Snapped, outline: Outline, kind: ElementKind) -> bool:
    lost = 1.0 - snapped.area / outline.area
    most = AREA_LOST_BOWED if kind == "hex20" else AREA_LOST
    return -1e-9 < lost < (1e-9 if len(outline.corners) else most)


def _volume_off(mesh: Mesh, outline: Outline, size: tuple[float, float, float]) -> float:
    """Distance of the ratio of the inclusion's meshed and true volume from its allowed range; 0 within it."""
    curved = mesh.kind == "hex20"
    if outline.dome is None and not curved:
        return 0.0
    places, weights = quadrature(mesh.kind)
    soft = float(np.sum(det_jacobian(mesh.kind, mesh.nodes, mesh.elements, places) * weights))
    ratio = (size[0] * size[1] * size[2] - soft) / outline.volume
    least, most = VOLUME if outline.dome is None else VOLUME_OF_DOME if curved else VOLUME_OF_FACETS
    return max(least - ratio, ratio - most, 0.0)


def _checked_size(block: Block) -> tuple[float, float, float]:
    size = np.array(block.size, dtype=np.float64)
    if size.shape != (3,) or not np.all(np.isfinite(size) & (size > 0.0)):
        raise MeshError(f"block size: expected three lengths above 0 [m], got {block.size}")
    return float(size[0]), float(size[1]), float(size[2])


class _Grids:
    """Checks the arguments of a poke, with a MeshError if one is out of range, and makes plane grids."""

    def __init__(
        self,
        *,
        size: tuple[float, float, float],
        site: tuple[float, float],
        direction: Vector,
        rod: Rod,
        friction: float = STICKS,
        refinement: float,
        kind: ElementKind = "hex8",
    ) -> None:
        push = np.array(direction, dtype=np.float64)
        norm = float(np.linalg.norm(push))
        if push.shape != (3,) or not np.isfinite(norm) or norm == 0.0:
            raise MeshError(f"poke direction: expected three finite numbers, not all zero, got {direction}")
        push /= norm
        tilt = float(np.arccos(np.clip(-push[2], -1.0, 1.0)))
        if tilt > STEEPEST:
            raise MeshError(f"poke direction: {np.degrees(tilt):.0f} degrees from straight down; at most 45")
        if not 0.5 <= refinement <= 6.0:
            raise MeshError(f"refinement: expected 0.5 to 6, got {refinement}")
        if not friction >= 0.0:
            raise MeshError(f"friction: expected a coefficient of 0 or more, got {friction}")
        if not (np.isfinite(rod.radius) and rod.radius > 0.0):
            raise MeshError(f"rod radius: expected a length above 0 [m], got {rod.radius}")
        self.half = 0.5 * np.array(size[:2])
        self.site = np.array(site, dtype=np.float64)
        reach = CLEARANCE * rod.radius / float(np.cos(tilt))
        if self.site.shape != (2,) or not np.all(np.abs(self.site) + reach <= self.half):
            raise MeshError(
                f"poke site {tuple(site)}: expected two coordinates [m] at least {1e3 * reach:.1f} mm inside "
                f"the edge of the block ({1e3 * size[0]:.0f} x {1e3 * size[1]:.0f} mm around (0, 0))"
            )
        flat = rod.radius - rod.edge_radius if rod.tip == "flat" else 0.0
        self.flat = float(np.clip(flat, 0.5 * rod.radius, 0.8 * rod.radius))
        self.rings = np.linspace(self.flat, 1.4 * rod.radius, max(3, round(4 * refinement)) + 1)[1:]
        slides = sliding(friction)
        if slides > 0.0:
            beside = np.maximum(self.rings / rod.radius - 1.0, 0.0) / 0.4
            closer = rod.radius * (1.0 + 0.4 * beside ** (1.0 + CLOSER * slides))
            self.rings = np.where(beside > 0.0, closer, self.rings)
        self.azimuth = float(np.arctan2(push[1], push[0]))
        self.stretch = 1.0 / float(np.cos(tilt))
        self.quadratic = kind == "hex20"
        if self.quadratic:  # about half as many rays and rings, since there are nodes between them
            self.n_theta, self.n_outer = 4 * max(2, round(2 * refinement)), max(5, round(10 * refinement))
        else:
            self.n_theta, self.n_outer = 4 * max(3, round(5 * refinement)), max(5, round(9 * refinement))

    def make(self, focus: Focus | None, *, turn: float = 0.0, more: int = 0) -> PlaneGrid:
        """A grid that is also fine at the focus.

        Its rays are rotated by the fraction `turn` of their spacing, and it has `more` additional rings.
        """
        return o_grid(
            site=self.site,
            half=self.half,
            flat=self.flat,
            rings=self.rings,
            azimuth=self.azimuth,
            stretch=self.stretch,
            # an inclusion's outline needs more rays than the rod
            n_theta=self.n_theta + 4 * (more // 3 + (self.quadratic and focus is not None)),
            n_outer=self.n_outer + more,
            focus=focus,
            turn=turn,
        )
