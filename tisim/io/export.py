"""Results as files for other programs: VTU (the body) and PLY or STL (its surface)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tisim.mesh import Mesh, boundary_facets, unfold
from tisim.mesh.quality import volumes
from tisim.result import Result

# Facets as triangles; those of six or eight nodes are cut at their middle nodes.
_TRIANGLES = {
    3: ((0, 1, 2),),
    4: ((0, 1, 2), (0, 2, 3)),
    6: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    8: ((0, 4, 7), (4, 1, 5), (5, 2, 6), (6, 3, 7), (4, 5, 6), (4, 6, 7)),
}
_VTK = {"tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20"}


def surface_triangles(mesh: Mesh) -> NDArray[np.int32]:
    """Triangles of a mesh's boundary, node indices (t, 3), outward.

    A half model is open at its mirror plane; `tisim.mesh.unfold` gives the whole body.
    """
    facets = mesh.facet_sets.get("surface")
    return triangles(boundary_facets(mesh.kind, mesh.elements) if facets is None else facets)


def triangles(facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Facets of 3, 4, 6 or 8 nodes as triangles (t, 3); collapsed ones (of wedges) are left out."""
    cut = facets[:, _TRIANGLES[facets.shape[1]]].reshape(-1, 3)
    a, b, c = cut.T
    return np.ascontiguousarray(cut[(a != b) & (b != c) & (c != a)])


def frame_index(result: Result, frame: int) -> int:
    """The frame counted from the start; ValueError where there is none."""
    count = len(result.positions)
    if not count:
        why = f": {result.message}" if result.message else ""
        raise ValueError(f"the result has no frame{why}")
    if not -count <= frame < count:
        raise ValueError(f"frame {frame}: expected one from {-count} to {count - 1}")
    return frame % count


def checked_path(path: str | Path) -> Path:
    """The path, in a folder that is there; FileNotFoundError otherwise."""
    path = Path(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: expected a folder that exists, {path.parent} does not")
    return path


def write(result: Result, path: str | Path, frame: int = -1) -> Path:
    """Write one frame for other programs.

    Parameters
    ----------
    result : Result
    path : path
        Its ending chooses the format. .vtu: the whole body at its deformed positions [m] (half models are
        unfolded), with point data `displacement` [m], `rest_position` [m] and one 0/1 mask a node set, and
        cell data `volume_ratio` (element volume over rest volume) and, constant over the body, `load`,
        `support_force` and, of a poke, `rod_force` of the frame (see `Result`). .ply, .stl: the deformed
        surface as triangles [m].
    frame : int
        Negative ones count from the end.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        For another ending, or a frame that the result does not have.
    FileNotFoundError
        If the folder does not exist.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".vtu", ".ply", ".stl"):
        raise ValueError(f"{path.name}: expected a name that ends in .vtu, .ply or .stl")
    checked_path(path)
    frame = frame_index(result, frame)
    mesh, x = unfold(result.mesh, result.positions[frame])
    if ending == ".vtu":
        _write_vtu(result, frame, mesh, x, path)
    else:
        import trimesh

        faces = surface_triangles(mesh)
        used, place = np.unique(faces, return_inverse=True)
        trimesh.Trimesh(x[used], place.reshape(-1, 3), process=False).export(path)
    return path


def _write_vtu(result: Result, frame: int, mesh: Mesh, x: NDArray[np.float64], path: Path) -> None:
    import meshio

    moved = Mesh(kind=mesh.kind, nodes=x, elements=mesh.elements)
    point_data: dict[str, NDArray] = {"displacement": x - mesh.nodes, "rest_position": mesh.nodes}
    for name, nodes in mesh.node_sets.items():
        mask = np.zeros(mesh.n_nodes, dtype=np.int8)
        mask[nodes] = 1
        point_data[f"set_{name}"] = mask
    m = mesh.n_elements
    cell_data = {
        "volume_ratio": [volumes(moved) / volumes(mesh)],
        "load": [np.full(m, result.load[frame])],
        "support_force": [np.tile(result.support_force[frame], (m, 1))],
    }
    if result.rod_force is not None:
        cell_data["rod_force"] = [np.tile(result.rod_force[frame], (m, 1))]
    meshio.Mesh(
        x, [(_VTK[mesh.kind], mesh.elements.astype(np.int64))], point_data=point_data, cell_data=cell_data
    ).write(path)
