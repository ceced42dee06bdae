"""The block that a rod pokes, meshed for that rod: fine under its edge, coarse far away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tisim.mesh._errors import MeshError
from tisim.mesh._layers import graded, layer_count
from tisim.mesh._mesh import Mesh, boundary_facets
from tisim.mesh._ogrid import PlaneGrid, o_grid

if TYPE_CHECKING:  # tisim.scene imports tisim.mesh
    from tisim.scene import Block, Rod, Vector

Floats = NDArray[np.float64]

TOP_LAYER = 0.0015
BOTTOM_LAYER = 0.0042
# layers thinner than this turn over under a rod's edge
THINNEST_LAYER = 0.0012
STEEPEST = np.radians(45.5)


def poke_mesh(
    *,
    block: Block,
    site: tuple[float, float],
    direction: Vector = (0.0, 0.0, -1.0),
    rod: Rod,
    refinement: float = 1.0,
) -> Mesh:
    """The block as 8-node hexahedra, made for a rod pushed along `direction` at `site` (x, y) [m].

    Node sets: "base" (all fixed nodes), "top". Facet sets: "top" (quad4, outward is +z), "surface".
    """
    half = 0.5 * np.array(block.size[:2], dtype=np.float64)
    grid = _plane_grid(half=half, site=site, direction=direction, rod=rod, refinement=refinement)
    height = float(block.size[2])
    top = max(THINNEST_LAYER, TOP_LAYER / refinement)
    n = layer_count(height=height, top=top, bottom=BOTTOM_LAYER / refinement, total=height)
    levels = height - graded(np.array(height), top, n)[::-1]
    levels[0] = 0.0
    return _extrude(grid, np.broadcast_to(levels, (len(grid.points), n + 1)))


def _plane_grid(
    *, half: Floats, site: tuple[float, float], direction: Vector, rod: Rod, refinement: float
) -> PlaneGrid:
    push = np.array(direction, dtype=np.float64)
    norm = float(np.linalg.norm(push))
    if push.shape != (3,) or not np.isfinite(norm) or norm == 0.0:
        raise MeshError(f"poke direction: expected three finite numbers, not all zero, got {direction}")
    push /= norm
    tilt = float(np.arccos(np.clip(-push[2], -1.0, 1.0)))
    if tilt > STEEPEST:
        raise MeshError(f"poke direction: {np.degrees(tilt):.0f} degrees from straight down; at most 45")
    if not 0.2 <= refinement <= 8.0:
        raise MeshError(f"refinement: expected 0.2 to 8, got {refinement}")
    if not rod.radius > 0.0:
        raise MeshError(f"rod radius: expected a length above 0 [m], got {rod.radius}")
    at = np.array(site, dtype=np.float64)
    reach = rod.radius * 1.4 / np.cos(tilt)
    if at.shape != (2,) or not np.all(np.abs(at) + reach + 0.001 <= half):
        raise MeshError(
            f"poke site {site}: expected at least {1e3 * (reach + 0.001):.1f} mm inside the block's edge "
            f"(block {2e3 * half[0]:.0f} x {2e3 * half[1]:.0f} mm around (0, 0))"
        )
    flat = rod.radius - rod.edge_radius if rod.tip == "flat" else 0.0
    flat = float(np.clip(flat, 0.5 * rod.radius, 0.8 * rod.radius))
    n_fine = max(3, round(4 * refinement))
    return o_grid(
        site=at,
        half=half,
        flat=flat,
        rings=np.linspace(flat, 1.4 * rod.radius, n_fine + 1)[1:],
        azimuth=float(np.arctan2(push[1], push[0])),
        stretch=1.0 / float(np.cos(tilt)),
        n_theta=4 * max(3, round(6 * refinement)),
        n_outer=max(5, round(10 * refinement)),
    )


def _extrude(grid: PlaneGrid, levels: Floats) -> Mesh:
    """Columns over the grid's points at the heights `levels`, shape (n, k + 1), rising [m]."""
    n, n_level = levels.shape
    nodes = np.empty((n_level, n, 3))
    nodes[:, :, :2] = grid.points
    nodes[:, :, 2] = levels.T
    bottom = (grid.cells[None] + n * np.arange(n_level - 1)[:, None, None]).reshape(-1, 4)
    elements = np.concatenate([bottom, bottom + n], axis=1).astype(np.int32)
    return Mesh(
        kind="hex8",
        nodes=nodes.reshape(-1, 3),
        elements=elements,
        node_sets={
            "base": np.arange(n, dtype=np.int32),
            "top": np.arange((n_level - 1) * n, n_level * n, dtype=np.int32),
        },
        facet_sets={
            "top": (grid.cells + (n_level - 1) * n).astype(np.int32),
            "surface": boundary_facets("hex8", elements),
        },
    )
