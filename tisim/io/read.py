"""Reading of meshes of other programs: Abaqus and CalculiX .inp, Gmsh .msh, VTU."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tisim.io import _abaqus
from tisim.mesh import NODES_PER_ELEMENT, ElementKind, Mesh, MeshError, boundary_facets, volumes
from tisim.mesh._mesh import _TURNED, ELEMENT_FACETS, HEXAHEDRA

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Unit = Literal["m", "cm", "mm", "in"]

METRES: Mapping[str, float] = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}
LARGEST = 10.0  # largest size of a body [m], as for any length of a scene
SOLIDS: Mapping[str, ElementKind] = {
    "tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8", "hexahedron20": "hex20",
}  # fmt: skip
_FACETS = ("triangle", "triangle6", "quad", "quad8", "triangle7", "quad9")
_SMALLER = ("vertex", "line", "line3", "line4")  # points and edges, which bound nothing


@dataclass
class _Raw:
    """Contents of a file.

    Attributes
    ----------
    nodes : coordinates, shape (n, 3).
    solids : node indices of solid elements, by type.
    node_sets : node indices, by name.
    element_sets : rows of the solid elements, by name and type.
    facet_sets : corners of the facets, by name.
    """

    nodes: Array
    solids: dict[str, Index]
    node_sets: dict[str, Index] = field(default_factory=dict)
    element_sets: dict[str, dict[str, Index]] = field(default_factory=dict)
    facet_sets: dict[str, list[Index]] = field(default_factory=dict)


def read(path: str | Path, *, unit: Unit = "m", elements: str | None = None) -> Mesh:
    """Read a mesh with its named sets.

    `elements` chooses the body from the file's element sets. Each element set also becomes a node set of the
    mesh (the nodes of its elements), and so does each facet set, unless there is a node set of that name. A
    facet set becomes a facet set of the mesh if all of it lies on the boundary. Nodes that belong to no
    element are omitted.

    - .inp (Abaqus, CalculiX): ``*NODE, *ELEMENT, *NSET, *ELSET, *SURFACE`` (element faces), ``*INCLUDE``;
      names in lower case.
    - .msh (Gmsh 2.2, 4.0 and 4.1): physical groups.
    - .vtu: arrays of 0 and 1 are sets of points, solids or facets, with their names without ``set_``. For a
      file of `tisim.write` the rest shape is read.

    Parameters
    ----------
    path : path
        A file that ends in .inp, .msh or .vtu.
    unit : {"m", "cm", "mm", "in"}
        Unit of the file's coordinates.
    elements : str, optional
        Element set that is the body; by default all solid elements.

    Returns
    -------
    Mesh
        Its facet set "surface" is the boundary.

    Raises
    ------
    MeshError
        For a file that cannot be read, elements of several or unknown types, a missing set, an element
        without volume, or a body larger than 10 m; the message is one sentence.
    FileNotFoundError
        If there is no such file.
    """
    path = Path(path)
    readers = {".inp": _read_inp, ".msh": _read_meshio, ".vtu": _read_meshio}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise MeshError(f"{path}: expected a name that ends in {', '.join(readers)}")
    if unit not in METRES:
        raise MeshError(f"{path}: unit: expected one of {', '.join(METRES)}, got {unit!r}")
    if not path.is_file():
        raise FileNotFoundError(f"{path}: there is no such file")
    try:
        raw = reader(path)
        raw.nodes = raw.nodes * METRES[unit]
        return _mesh(raw, elements)
    except MeshError as error:
        text = str(error)
        raise MeshError(text if text.startswith(str(path)) else f"{path}: {text}") from None


def _read_inp(path: Path) -> _Raw:
    found = _abaqus.parse(path)
    if not found.nodes or not found.elements:
        raise MeshError("expected *NODE and *ELEMENT with at least one of each")
    nodes, place = _abaqus.as_arrays(found)

    def rows(labels: list[int], what: str) -> Index:
        missing = [label for label in labels if label not in place]
        if missing:
            raise MeshError(f"{what}: node {missing[0]} is named, and there is none")
        return np.array([place[label] for label in labels], dtype=np.int64)

    solids: dict[str, list[Index]] = {}
    home: dict[int, tuple[str, int]] = {}
    others: dict[int, Index] = {}  # corners of elements on faces
    for label, (element, labels) in found.elements.items():
        kind = _abaqus.kind_of(element)
        corners = rows(labels, f"element {label}")
        if kind is None:
            others[label] = corners[: 3 if len(corners) in (3, 6) else 4]
        else:
            home[label] = kind, len(solids.setdefault(kind, []))
            solids[kind].append(corners)
    raw = _Raw(nodes=nodes, solids={k: np.array(v) for k, v in solids.items()})
    for name in found.node_sets:
        raw.node_sets[name] = rows(found.members(found.node_sets, name, "node set"), f"node set {name!r}")
    for name in found.element_sets:
        members = found.members(found.element_sets, name, "element set")
        unknown = [m for m in members if m not in found.elements]
        if unknown:
            raise MeshError(f"element set {name!r}: element {unknown[0]} is named, and there is none")
        body = [home[m] for m in members if m in home]
        if body:
            kinds = {k for k, _ in body}
            raw.element_sets[name] = {k: np.array([i for q, i in body if q == k]) for k in kinds}
        faces = [others[m] for m in members if m in others]
        if faces:
            raw.facet_sets[name] = faces
    for name, pairs in found.surfaces.items():
        raw.facet_sets[name] = [
            f for entry, face in pairs for f in _faces(found, raw, home, name, entry, face)
        ]
    return raw


def _faces(
    found: _abaqus.InputFile,
    raw: _Raw,
    home: Mapping[int, tuple[str, int]],
    name: str,
    entry: int | str,
    face: str,
) -> list[Index]:
    """Corners of the faces in one line of *SURFACE."""
    labels = [entry] if isinstance(entry, int) else found.members(found.element_sets, entry, "element set")
    corners = []
    for label in labels:
        kind, row = home.get(label, ("", 0))
        faces = _abaqus.FACES.get(kind[:3], ())
        number = int(face[1:]) if face[:1] == "S" and face[1:].isdigit() else 0
        if not 1 <= number <= len(faces):
            raise MeshError(
                f"*SURFACE {name!r}: expected faces S1 to S{len(faces) or 6} of elements, got {face or label}"
            )
        corners.append(raw.solids[kind][row][list(faces[number - 1])])
    return corners


def meshio_file(path: Path) -> Any:
    """A .msh or .vtu file as a meshio mesh; MeshError, in one sentence, if it cannot be read."""
    import meshio

    shown = io.StringIO()  # meshio prints warnings, and ends the process for some files
    try:
        with contextlib.redirect_stdout(shown), contextlib.redirect_stderr(shown):
            return meshio.read(path, file_format="gmsh" if path.suffix.lower() == ".msh" else "vtu")
    except (Exception, SystemExit) as error:  # its parsers may raise any error on a broken file
        said = " ".join(str(error).split()) or type(error).__name__
        if "Incompatible cell data" in said and path.suffix.lower() == ".msh":
            raise MeshError(
                "expected every entity in a physical group: save the mesh without Gmsh's option to save all"
            ) from None
        name = "Gmsh mesh (2.2, 4.0 or 4.1)" if path.suffix.lower() == ".msh" else "VTU file"
        raise MeshError(f"expected a {name}, which it is not ({said[:120]})") from None


def _read_meshio(path: Path) -> _Raw:
    m = meshio_file(path)
    points = np.asarray(m.point_data.get("rest_position", m.points), dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError("expected nodes in three dimensions")
    unknown = {b.type for b in m.cells} - set(SOLIDS) - set(_FACETS) - set(_SMALLER)
    if unknown:
        raise MeshError(f"elements of type {', '.join(sorted(unknown))}: expected {' or '.join(SOLIDS)}")
    raw = _Raw(nodes=points, solids={})
    start: dict[int, int] = {}  # first row of a block of solids among those of its type
    for k, block in enumerate(m.cells):
        if block.type in SOLIDS:
            kind = SOLIDS[block.type]
            known = raw.solids.get(kind, np.empty((0, NODES_PER_ELEMENT[kind]), dtype=np.int64))
            start[k] = len(known)
            raw.solids[kind] = np.concatenate([known, np.asarray(block.data, dtype=np.int64)])
    for name, chosen in _groups(m).items():
        for k, rows in chosen:
            block = m.cells[k]
            if k in start:
                of_kind = raw.element_sets.setdefault(name, {})
                kind = SOLIDS[block.type]
                before = of_kind.get(kind, np.empty(0, dtype=np.int64))
                of_kind[kind] = np.concatenate([before, rows + start[k]])
            elif block.type in _FACETS:
                corners = 3 if block.type.startswith("triangle") else 4
                raw.facet_sets.setdefault(name, []).extend(np.asarray(block.data)[rows][:, :corners])
            else:
                nodes = np.unique(np.asarray(block.data)[rows])
                raw.node_sets[name] = np.union1d(raw.node_sets.get(name, nodes), nodes)
    for name, values in m.point_data.items():
        if is_mask(values):
            raw.node_sets[name.removeprefix("set_")] = np.flatnonzero(values)
    return raw


def _groups(m: Any) -> dict[str, list[tuple[int, Index]]]:
    """Cells of a meshio mesh by name of their set, as pairs of a block and its rows."""
    found: dict[str, dict[int, Index]] = {}

    def add(name: str, block: int, rows: Any) -> None:
        own = found.setdefault(name, {})
        own[block] = np.union1d(own.get(block, np.empty(0, dtype=np.int64)), np.asarray(rows, dtype=np.int64))

    tags = m.cell_data.get("gmsh:physical")
    if tags is not None:
        named = {(int(dim), int(tag)): name for name, (tag, dim) in m.field_data.items()}
        for k, (block, values) in enumerate(zip(m.cells, tags, strict=True)):
            numbers = np.abs(values)  # negative for a surface that is reversed
            for tag in np.unique(numbers[numbers > 0]):
                name = named.get((block.dim, int(tag)), f"physical-{block.dim}d-{tag}")
                add(name, k, np.flatnonzero(numbers == tag))
        for name, blocks in m.cell_sets.items():  # of Gmsh 4.1: also where an entity is in several groups
            for k, rows in enumerate(blocks):
                if not name.startswith("gmsh:") and rows is not None and len(rows):
                    add(name, k, rows)
    for name, arrays in m.cell_data.items():
        if not name.startswith("gmsh:") and all(map(is_mask, arrays)):
            for k, values in enumerate(arrays):
                if np.any(values):
                    add(name.removeprefix("set_"), k, np.flatnonzero(values))
    return {name: list(blocks.items()) for name, blocks in found.items()}


def is_mask(values: Any) -> bool:
    values = np.asarray(values)
    return values.ndim == 1 and values.dtype.kind in "iub" and bool(np.isin(values, (0, 1)).all())


def _mesh(raw: _Raw, body: str | None) -> Mesh:
    solids = raw.solids
    if body is not None:
        if body not in raw.element_sets:
            known = ", ".join(raw.element_sets) or "none"
            raise MeshError(f"elements {body!r}: expected an element set of the file: {known}")
        solids = {k: raw.solids[k][np.unique(rows)] for k, rows in raw.element_sets[body].items()}
    if not solids:
        raise MeshError(f"expected solid elements ({', '.join(NODES_PER_ELEMENT)}), found none")
    if len(solids) > 1:
        counts = " and ".join(f"{len(e)} {k}" for k, e in solids.items())
        raise MeshError(f"expected elements of one kind, found {counts}; elements= chooses an element set")
    ((kind, elements),) = solids.items()
    if not np.isfinite(raw.nodes).all():
        raise MeshError("expected finite coordinates")
    # Gmsh 2.2 repeats an element in each of its physical groups
    _, once = np.unique(np.sort(elements, axis=1), axis=0, return_index=True)
    elements = elements[np.sort(once)]
    used, flat = np.unique(elements, return_inverse=True)
    if used[0] < 0 or used[-1] >= len(raw.nodes):
        raise MeshError("an element names a node that is not there")
    size = float(np.ptp(raw.nodes[used], axis=0).max())
    if size > LARGEST:
        raise MeshError(
            f"expected a body of up to {LARGEST:g} m, got {size:g} m: give unit='mm' if these are mm"
        )
    place = np.full(len(raw.nodes), -1, dtype=np.int64)
    place[used] = np.arange(len(used))
    mesh = _upright(Mesh(kind=kind, nodes=raw.nodes[used], elements=flat.reshape(elements.shape)))  # type: ignore[arg-type]
    sets = {name: place[nodes] for name, nodes in raw.node_sets.items()}
    for name, of_kind in raw.element_sets.items():
        if kind in of_kind:
            sets.setdefault(name, place[raw.solids[kind][of_kind[kind]]])
    surface = boundary_facets(mesh.kind, mesh.elements)
    facet_sets = {"surface": surface}
    for name, stated in raw.facet_sets.items():
        corners = [own for c in stated if (own := place[c]).min() >= 0]  # of the body
        if not corners:
            continue
        chosen = _on_boundary(mesh, surface, name, corners)
        if chosen is not None and name != "surface":
            facet_sets[name] = chosen
        sets.setdefault(name, _facet_nodes(mesh, corners))
    kept = {name: np.unique(nodes[nodes >= 0]).astype(np.int32) for name, nodes in sets.items()}
    return replace(mesh, node_sets={n: s for n, s in kept.items() if len(s)}, facet_sets=facet_sets)


def _upright(mesh: Mesh) -> Mesh:
    """The mesh with the node order of elements of negative volume reversed; MeshError for zero volume."""
    volume = volumes(mesh)
    flat = ~(np.abs(volume) > 0.0)
    if flat.any():
        raise MeshError(
            f"{int(flat.sum())} of {mesh.n_elements} elements have no volume, the first is {flat.argmax()}"
        )
    elements = mesh.elements.copy()
    turned = volume < 0.0
    elements[turned] = elements[turned][:, _TURNED[mesh.kind]]
    return replace(mesh, elements=elements)


def _keys(corners: Index) -> list[tuple[int, ...]]:
    return [tuple(sorted(set(row))) for row in corners.tolist()]


def _on_boundary(
    mesh: Mesh, surface: NDArray[np.int32], name: str, corners: list[Index]
) -> NDArray[np.int32] | None:
    """The set as outward facets of the mesh; None if some are interior, MeshError if some are not faces."""
    count = 4 if mesh.kind in HEXAHEDRA else 3
    outside = dict(zip(_keys(surface[:, :count].astype(np.int64)), range(len(surface)), strict=True))
    wanted = [tuple(sorted(set(c.tolist()))) for c in corners]
    if all(w in outside for w in wanted):
        return surface[sorted({outside[w] for w in wanted})]
    local = np.array(ELEMENT_FACETS[mesh.kind], dtype=np.int64)[:, :count]
    known = set(_keys(mesh.elements[:, local].reshape(-1, count).astype(np.int64)))
    strange = sum(w not in known for w in wanted)
    if strange:
        raise MeshError(
            f"facet set {name!r}: {strange} of {len(wanted)} facets are no faces of the body's elements"
        )
    return None


def _facet_nodes(mesh: Mesh, corners: list[Index]) -> Index:
    """All nodes, including middle nodes, of faces given by their corners."""
    count = 4 if mesh.kind in HEXAHEDRA else 3
    local = np.array(ELEMENT_FACETS[mesh.kind], dtype=np.int64)
    faces = mesh.elements[:, local].reshape(-1, local.shape[1])
    wanted = {tuple(sorted(set(c.tolist()))) for c in corners}
    mask = np.array([key in wanted for key in _keys(faces[:, :count].astype(np.int64))])
    return np.unique(faces[mask]).astype(np.int64)
