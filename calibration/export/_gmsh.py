"""A scene's mesh as a Gmsh 2.2 text file, which SOFA and MuJoCo read, and tisim.read."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tisim.mesh import Mesh


def write_msh(mesh: Mesh, path: Path) -> Path:
    """Linear tetrahedra, metres, one physical group "beam"; nodes and elements in the mesh's order."""
    nodes = np.round(mesh.nodes, 12) + 0.0
    out = [
        "$MeshFormat",
        "2.2 0 8",
        "$EndMeshFormat",
        "$PhysicalNames",
        "1",
        '3 1 "beam"',
        "$EndPhysicalNames",
    ]
    out += ["$Nodes", str(len(nodes))]
    out += [f"{n} " + " ".join(f"{x:.10g}" for x in p) for n, p in enumerate(nodes, 1)]
    out += ["$EndNodes", "$Elements", str(mesh.n_elements)]
    out += [f"{e} 4 2 1 1 " + " ".join(map(str, c + 1)) for e, c in enumerate(mesh.elements, 1)]
    path.write_text("\n".join([*out, "$EndElements", ""]), encoding="ascii")
    return path
