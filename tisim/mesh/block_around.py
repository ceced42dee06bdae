"""An unstructured block with a rigid inclusion of any shape cut out of it."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from tisim.mesh._mesh import Mesh, MeshError, boundary_facets
from tisim.mesh.quality import scaled_jacobian
from tisim.mesh.refine import to_quadratic
from tisim.mesh.surface import Units, checked_surface
from tisim.mesh.tetrahedralise import body_from_surface

# fTetWild makes a different mesh each time. A mesh in which moving nodes onto the planes inverts or flattens
# an element is made again, with half of the tolerance if none was asked for (with blocks of 6 to 8 edges the
# first one often has nodes within the tolerance of one another).
_ATTEMPTS = 5
_LEAST_SHAPE = 0.02


def block_around(
    surface: Any,
    *,
    size: tuple[float, float, float],
    edge_length: float,
    units: Units = "m",
    kind: Literal["tet4", "tet10"] = "tet4",
    tolerance: float | None = None,
) -> Mesh:
    """A block, x and y centred on 0 and z from 0 to size[2], without the inclusion inside `surface`.

    Parameters
    ----------
    surface : path, trimesh.Trimesh or None
        Closed surface of the rigid inclusion in the block's coordinates; None for a plain block. Parts below
        z = 0 are ignored; the top and the sides must not be reached.
    size : (float, float, float)
        Size of the block [m].
    edge_length, tolerance : float
        As in `body_from_surface` [m].
    units : "m" or "mm"
        Unit of the surface's coordinates.
    kind : "tet4" or "tet10"
        Type of the elements.

    Returns
    -------
    Mesh
        Node sets: "base" (the plane z = 0 and the inclusion's surface, which a poke holds fixed) and
        "inclusion" (its surface only). Facet sets: "surface", "top", "base", "inclusion".

    Raises
    ------
    MeshError
        If the surface or the lengths do not result in a mesh; the message is one sentence.
    """
    import trimesh  # takes longer to import than tisim itself

    if min(size) <= 0 or not np.isfinite(size).all():
        raise MeshError(f"the block's size must be three positive lengths in metres, got {size!r}")
    block = trimesh.creation.box(extents=size)
    block.apply_translation((0.0, 0.0, size[2] / 2))
    reach = edge_length / 50 if tolerance is None else tolerance
    if surface is not None:
        block = _cut_out(block, checked_surface(surface, units=units), size, 2 * reach)
    for attempt in range(_ATTEMPTS):
        own = reach if tolerance is not None else reach / 2**attempt
        body = body_from_surface(block, edge_length=edge_length, tolerance=own, allow_cavities=True)
        mesh = _onto_planes(body, size, 2 * own)
        if scaled_jacobian(mesh).min() > _LEAST_SHAPE:
            break
        if attempt == _ATTEMPTS - 1:
            raise MeshError(
                "the planes of the block turn an element over or flatten it: ask for a smaller tolerance"
            )
    if surface is not None and "inclusion" not in mesh.facet_sets:
        raise MeshError("the inclusion got lost in the mesh: ask for a smaller edge length or tolerance")
    return to_quadratic(mesh) if kind == "tet10" else mesh


def _onto_planes(body: Mesh, size: tuple[float, float, float], reach: float) -> Mesh:
    """The mesh with the nodes of its plane faces exactly on the planes, and with named sets.

    fTetWild keeps these nodes only within its tolerance. Slivers whose nodes all lie in a plane are removed.
    """
    width, depth, height = size
    planes = ((2, 0.0), (2, height), (0, -width / 2), (0, width / 2), (1, -depth / 2), (1, depth / 2))
    elements = body.elements
    while True:
        facets = boundary_facets("tet4", elements)
        on = [(np.abs(body.nodes[facets, axis] - value) <= reach).all(axis=1) for axis, value in planes]
        flat = np.zeros(len(elements), dtype=bool)
        for chosen in on:
            flat |= np.isin(elements, facets[chosen]).all(axis=1)
        if not flat.any():
            break
        elements = elements[~flat]
    nodes = body.nodes.copy()
    for (axis, value), chosen in zip(planes, on, strict=True):
        nodes[np.unique(facets[chosen]), axis] = value
    used, place = np.unique(elements, return_inverse=True)
    facets = np.searchsorted(used, facets).astype(np.int32)
    base, top, inclusion = on[0], on[1], ~np.logical_or.reduce(on)
    node_sets = {"surface": np.unique(facets), "base": np.unique(facets[base | inclusion])}
    facet_sets = {"surface": facets, "top": facets[top], "base": facets[base]}
    if inclusion.any():
        node_sets["inclusion"] = np.unique(facets[inclusion])
        facet_sets["inclusion"] = facets[inclusion]
    return Mesh(
        kind="tet4",
        nodes=nodes[used],
        elements=place.reshape(-1, 4).astype(np.int32),
        node_sets=node_sets,
        facet_sets=facet_sets,
    )


def _cut_out(block: Any, inclusion: Any, size: tuple[float, float, float], thinnest: float) -> Any:
    """The block without the inclusion; MeshError unless it is further than `thinnest` [m] from the planes.

    Thinner tissue would be taken for a part of a plane. The inclusion may stand on the base, or reach below
    it.
    """
    low, high = inclusion.bounds
    if high[2] <= 0:
        raise MeshError("the inclusion lies below the block, whose base is z = 0")
    if high[2] >= size[2]:
        raise MeshError(f"the inclusion reaches z = {high[2]:.4g} m, the block's top is at {size[2]:.4g} m")
    if (np.maximum(np.abs(low[:2]), np.abs(high[:2])) >= np.array(size[:2]) / 2).any():
        raise MeshError("the inclusion reaches the block's sides: move it inwards, or take a larger block")
    gaps = {"top": size[2] - high[2], "base": low[2] if low[2] > 0 else np.inf}
    gaps["sides"] = (np.array(size[:2]) / 2 - np.maximum(np.abs(low[:2]), np.abs(high[:2]))).min()
    plane = min(gaps, key=lambda name: gaps[name])
    if gaps[plane] <= thinnest:
        raise MeshError(
            f"the inclusion comes within {gaps[plane]:.2g} m of the block's {plane}, which the mesh's"
            f" tolerance does not resolve: ask for a tolerance below {gaps[plane] / 2:.2g} m"
        )
    import trimesh

    try:
        rest = trimesh.boolean.difference([block, inclusion], engine="manifold")
    except ImportError as error:
        raise MeshError(
            "cutting an inclusion out needs the package manifold3d: pip install manifold3d"
        ) from error
    return rest
