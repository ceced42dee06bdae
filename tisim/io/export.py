"""Results as files for other programs: VTU and PVD (the body), PLY or STL (its surface)."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tisim.fields import Fields, Quantities, fields, fields_of_frames, unfold_quantities
from tisim.io.whole import whole_file, write_whole
from tisim.mesh import Mesh, surface_triangles, unfold
from tisim.mesh.quality import volumes
from tisim.problems.indentation.turning import axis_at
from tisim.result import Result, frame_index

# Names of fields in files, with their units, and attributes of `tisim.Quantities`.
FIELDS = {
    "cauchy_stress_Pa": "cauchy",
    "first_piola_stress_Pa": "first_piola",
    "von_mises_stress_Pa": "von_mises",
    "pressure_Pa": "pressure",
    "principal_stresses_Pa": "principal_stresses",
    "green_lagrange_strain": "green_lagrange",
    "principal_stretches": "principal_stretches",
    "strain_energy_density_J_per_m3": "energy_density",
}
_VTK = {"tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20"}


def checked_path(path: str | Path) -> Path:
    """The path; FileNotFoundError if its folder does not exist."""
    path = Path(path)
    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path}: expected a folder that exists, {path.parent} does not")
    return path


def write(result: Result, path: str | Path, frame: int = -1) -> Path:
    """Write one frame, or the whole series, for other programs and for `tisim.view`.

    Parameters
    ----------
    result : Result
    path : path
        The extension determines the format. .vtu: the whole body at its deformed positions [m] (half models
        are unfolded). Point data: `displacement` [m], `rest_position` [m] and one 0/1 mask per node set. Cell
        data: `volume_ratio` (element volume over rest volume) and, constant over the body, `load` and
        `support_force` (see `Result`), `time` [s] if the result has one, `nominal_stress` [Pa] of a coupon or
        a press and, for a poke, `rod_force` [N], `rod_tip` [m], `rod_axis` and `rod_shape` (radius, length,
        radius of the tip's edge [m]). Both have the `FIELDS` (`tisim.fields`), whose names end in their
        units; tensors have nine components, row by row. A result without a scene has no fields.
        .pvd: all frames, one .vtu each in a folder of the same name next to it, as ParaView reads them.
        .ply, .stl: the deformed surface as triangles [m].
    frame : int
        Index of the frame; negative ones count from the end. Ignored for a .pvd.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        For another extension, or if the result does not have the frame.
    FileNotFoundError
        If the folder does not exist.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".vtu", ".pvd", ".ply", ".stl"):
        raise ValueError(f"{path.name}: expected a name that ends in .vtu, .pvd, .ply or .stl")
    checked_path(path)
    frame = frame_index(result, frame)
    if ending == ".pvd":
        _write_series(result, path)
    elif ending == ".vtu":
        _write_vtu(result, frame, None if result.scene is None else fields(result, frame), path)
    else:
        import trimesh

        mesh, x = unfold(result.mesh, result.positions[frame])
        faces = surface_triangles(mesh)
        used, place = np.unique(faces, return_inverse=True)
        with whole_file(path) as part:
            trimesh.Trimesh(x[used], place.reshape(-1, 3), process=False).export(part, file_type=ending[1:])
    return path


def _write_series(result: Result, path: Path) -> None:
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    moments = result.load if result.time is None else result.time
    if not (np.diff(moments) > 0.0).all():  # loading and unloading have the same load
        moments = np.arange(len(moments), dtype=float)
    series = [None] * len(moments) if result.scene is None else fields_of_frames(result)
    rows = []
    for frame, (found, moment) in enumerate(zip(series, moments, strict=True)):
        name = f"{path.stem}-{frame:03d}.vtu"
        _write_vtu(result, frame, found, folder / name)
        rows.append(
            f'    <DataSet timestep="{moment:.9g}" part="0" file="{escape(f"{folder.name}/{name}")}"/>'
        )
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>"]
    write_whole(path, "\n".join([*lines, *rows, "  </Collection>", "</VTKFile>", ""]))


def _write_vtu(result: Result, frame: int, found: Fields | None, path: Path) -> None:
    import meshio

    half = result.mesh
    mesh, x = unfold(half, result.positions[frame])
    rest = unfold(half, result.rest_positions)[1]
    before, after = (Mesh(kind=mesh.kind, nodes=nodes, elements=mesh.elements) for nodes in (rest, x))
    point_data: dict[str, NDArray] = {"displacement": x - rest, "rest_position": rest}
    for name, nodes in mesh.node_sets.items():
        mask = np.zeros(mesh.n_nodes, dtype=np.int8)
        mask[nodes] = 1
        point_data[f"set_{name}"] = mask
    m = mesh.n_elements
    constant = {"load": result.load[frame], "support_force": result.support_force[frame]}
    if result.time is not None:
        constant["time"] = result.time[frame]
    if result.nominal_stress is not None:
        constant["nominal_stress"] = result.nominal_stress[frame]
    if result.rod_force is not None and result.rod_tip is not None:
        rod = result.scene.rod
        time = 0.0 if result.time is None else float(result.time[frame])
        constant["rod_force"], constant["rod_tip"] = result.rod_force[frame], result.rod_tip[frame]
        constant["rod_axis"] = axis_at(result.scene, time)
        constant["rod_shape"] = np.array([rod.radius, rod.length, rod.edge])
    cell_data = {"volume_ratio": volumes(after) / volumes(before)}
    cell_data |= {
        name: np.tile(value, (m, 1)) if value.ndim else np.full(m, value) for name, value in constant.items()
    }
    if found is not None:
        point_data |= _flat(unfold_quantities(half, found.nodes, nodes=True))
        cell_data |= _flat(unfold_quantities(half, found.elements, nodes=False))
    made = meshio.Mesh(
        x,
        [(_VTK[mesh.kind], mesh.elements.astype(np.int64))],
        point_data=point_data,
        cell_data={name: [values] for name, values in cell_data.items()},
    )
    with whole_file(path) as part:
        made.write(part, file_format="vtu")


def _flat(found: Quantities) -> dict[str, NDArray]:
    """The `FIELDS` by name, with tensors as rows of nine components."""
    shaped = {name: getattr(found, attribute) for name, attribute in FIELDS.items()}
    return {name: v.reshape(len(v), 9) if v.ndim == 3 else v for name, v in shaped.items()}
