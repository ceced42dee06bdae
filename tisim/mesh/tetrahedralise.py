"""A tetrahedral mesh of the body inside a closed surface, by fTetWild (Hu et al. 2020, pytetwild).

fTetWild is not deterministic, not even in one thread (wildmeshing/fTetWild issue 72). If a result must be
repeatable to the byte, make the mesh once and keep it.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np

from tisim.mesh._mesh import Mesh, MeshError, boundary_facets
from tisim.mesh.refine import to_quadratic
from tisim.mesh.surface import Units, checked_surface

# More elements than this are refused (the volume of a regular tetrahedron is 0.118 edge lengths cubed).
_MOST_ELEMENTS = 5_000_000


def body_from_surface(
    surface: Any,
    *,
    edge_length: float,
    units: Units = "m",
    kind: Literal["tet4", "tet10"] = "tet4",
    tolerance: float | None = None,
    stop_energy: float = 10.0,
    time_limit: float = 600.0,
    allow_cavities: bool = False,
) -> Mesh:
    """Tetrahedral mesh of the body inside a closed surface; each call may give a different mesh.

    Parameters
    ----------
    surface : path or trimesh.Trimesh
        A file that trimesh reads (STL, PLY, OBJ, OFF), or a surface.
    edge_length : float
        Target length of the edges [m].
    units : "m" or "mm"
        Unit of the surface's coordinates.
    kind : "tet4" or "tet10"
        Type of the elements; "tet10" has a node in the middle of each (straight) edge.
    tolerance : float, optional
        Largest distance of the mesh's surface from the given one [m]; edge_length / 50 by default. Smaller
        values take longer.
    stop_energy : float
        Shape energy at which the optimisation stops; that of a regular tetrahedron is 3. Values below the
        default of 10 give better shapes and take longer.
    time_limit : float
        Time after which meshing is aborted [s].
    allow_cavities : bool
        Allow inner pieces with inward normals.

    Returns
    -------
    Mesh
        Its node set and facet set "surface" are the boundary.

    Raises
    ------
    MeshError
        If the surface or the edge length does not result in a body; the message is one sentence.
    """
    if kind not in ("tet4", "tet10"):
        raise MeshError(f"kind: expected tet4 or tet10, got {kind!r}")
    if tolerance is not None and not (np.isfinite(tolerance) and tolerance > 0):
        raise MeshError(f"tolerance: expected a length above 0 [m], or None, got {tolerance!r}")
    shell = checked_surface(surface, units=units, allow_cavities=allow_cavities)
    extent = float(np.linalg.norm(shell.extents))
    if not (np.isfinite(edge_length) and 0 < edge_length <= extent):
        raise MeshError(
            f"edge length must lie between 0 and the body's size of {extent:.3g} m, got {edge_length!r} m"
        )
    expected = shell.volume / (0.118 * edge_length**3)
    if expected > _MOST_ELEMENTS:
        raise MeshError(
            f"edges of {edge_length:.3g} m would give about {expected:.1g} tetrahedra: ask for a longer one"
        )
    if tolerance is None:
        tolerance = edge_length / 50
    nodes, elements = _run(
        vertices=np.asarray(shell.vertices, dtype=np.float64),
        faces=np.asarray(shell.faces, dtype=np.int32),
        edge_length=edge_length,
        epsilon=tolerance / extent,
        stop_energy=stop_energy,
        time_limit=time_limit,
    )
    used, place = np.unique(elements, return_inverse=True)
    nodes, elements = nodes[used], place.reshape(-1, 4).astype(np.int32)
    corner = nodes[elements]
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6
    if abs(np.abs(volume).sum() / shell.volume - 1) > 0.05:
        raise MeshError(
            f"the mesh holds {np.abs(volume).sum() / shell.volume:.2f} times the surface's volume: "
            "ask for a smaller edge length or tolerance"
        )
    turned = volume < 0  # fTetWild uses the opposite node order
    elements[turned] = elements[turned][:, [0, 2, 1, 3]]
    boundary = boundary_facets("tet4", elements)
    mesh = Mesh(
        kind="tet4",
        nodes=nodes,
        elements=elements,
        node_sets={"surface": np.unique(boundary)},
        facet_sets={"surface": boundary},
    )
    return to_quadratic(mesh) if kind == "tet10" else mesh


def _run(*, time_limit: float, **data: Any) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    with TemporaryDirectory(prefix="tisim-mesh-") as folder:
        source, target = Path(folder) / "surface.npz", Path(folder) / "mesh.npz"
        np.savez(source, **data)
        script = Path(__file__).with_name("_ftetwild.py")
        try:
            # -P: this folder's modules must not shadow others of the same name
            done = subprocess.run(
                [sys.executable, "-P", str(script.resolve()), source.name, target.name],
                cwd=folder,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=time_limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise MeshError(
                f"fTetWild was not done after {time_limit:g} s: ask for a larger edge length or tolerance"
            ) from None
        if done.returncode or not target.exists():
            last = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
            raise MeshError(f"fTetWild could not mesh the surface: {last}")
        with np.load(target) as result:
            return result["vertices"], result["tetrahedra"]
