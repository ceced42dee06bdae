"""Meshes of other programs: .inp, .msh and .vtu with their sets, and unreadable files."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

import tisim
from tisim.mesh import Mesh, MeshError, beam_mesh

CUBE = """*HEADING
 a cube of 20 mm, its top a surface, CalculiX or Abaqus
*Node, nset=Nall
10, 0., 0., 0.
 1, 2.0D1, 0., 0.
 2, 20., 20., 0.
 3, 0., 20., 0.
 4, 0., 0., 20.
 5, 20., 0., 20.
 6, 20., 20., 20.
 7, 0., 20., 20.
99, 5., 5., 5.
*ELEMENT, TYPE=c3d8r,
 ELSET=Block
4, 10, 1, 2, 3,
4, 5, 6, 7
*NSET, NSET=Clamp, GENERATE
1, 3, 1
*NSET, NSET=clamp
10
*NSET, NSET=both, INSTANCE=Part-1-1
Part-1-1.clamp, Part-1-1.7
** a comment
*SURFACE, NAME=Top, TYPE=ELEMENT
Block, S2
*MATERIAL, NAME=SOFT
*STEP
*NODE PRINT, NSET=Nall
U
*END STEP
"""


def small(kind: str = "tet10") -> Mesh:
    return beam_mesh(length=0.02, section=tisim.Circle(radius=0.01), kind=kind, radial_elements=1)  # type: ignore[arg-type]


def written(folder: Path, text: str, name: str = "cube.inp") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_an_input_file_with_its_sets(tmp_path: Path) -> None:
    mesh = tisim.read(written(tmp_path, CUBE), unit="mm")
    assert (mesh.kind, mesh.n_nodes, mesh.n_elements) == ("hex8", 8, 1)  # node 99 belongs to no element
    assert tisim.mesh.volumes(mesh) == pytest.approx(8e-6)
    assert sorted(mesh.node_sets) == ["block", "both", "clamp", "nall", "top"]
    assert np.all(mesh.nodes[mesh.node_sets["clamp"], 2] == 0.0)
    assert len(mesh.node_sets["clamp"]) == 4
    assert len(mesh.node_sets["both"]) == 5
    (top,) = mesh.facet_sets["top"]
    a, b, c = mesh.nodes[top[:3]]
    assert np.cross(b - a, c - b) @ [0, 0, 1] > 0  # outward
    assert np.all(mesh.nodes[top, 2] == 0.02)
    assert len(mesh.facet_sets["surface"]) == 6


@pytest.mark.parametrize("face", [1, 2, 3, 4])
def test_faces_of_tetrahedra_have_abaqus_numbers(tmp_path: Path, face: int) -> None:
    """S1 to S4 are opposite to nodes 4, 3, 1, 2 (Abaqus manual, solid elements)."""
    nodes = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 1., 0.\n4, 0., 0., 1.\n"
    text = f"{nodes}*ELEMENT, TYPE=C3D4\n7, 1, 2, 3, 4\n"
    mesh = tisim.read(written(tmp_path, f"{text}*SURFACE, NAME=F\n7, S{face}\n"))
    (facet,) = mesh.facet_sets["f"]
    assert set(range(4)) - set(facet.tolist()) == {(4, 3, 1, 2)[face - 1] - 1}


def test_included_files_are_read(tmp_path: Path) -> None:
    begin, rest = CUBE.split("*NSET", 1)
    written(tmp_path, begin, "mesh.inp")
    mesh = tisim.read(written(tmp_path, f"*INCLUDE, INPUT=mesh.inp\n*NSET{rest}"), unit="mm")
    assert len(mesh.node_sets["clamp"]) == 4


def test_data_lines_in_other_files_are_read(tmp_path: Path) -> None:
    """A keyword with INPUT=, an included file of data lines alone, data lines after it, a byte order mark."""
    whole = tisim.read(written(tmp_path, CUBE), unit="mm")
    head, nodes = CUBE.split("*ELEMENT", 1)[0].rsplit("*Node", 1)
    options, *rows = nodes.splitlines(keepends=True)
    rest = CUBE[CUBE.index("*ELEMENT") :]
    written(tmp_path, "".join(rows), "all.dat")
    written(tmp_path, "".join(rows[:3]), "some.dat")
    named = f"\ufeff{head}*NODE{options.rstrip()}, INPUT=all.dat\n{rest}"
    included = f"{head}*NODE{options}*INCLUDE, INPUT=some.dat\n{''.join(rows[3:])}{rest}"
    for text in (named, included):
        mesh = tisim.read(written(tmp_path, text), unit="mm")
        assert np.array_equal(mesh.nodes, whole.nodes)
        assert np.array_equal(mesh.elements, whole.elements)
        assert sorted(mesh.node_sets) == sorted(whole.node_sets)


@pytest.mark.parametrize("kind", ["tet4", "tet10"])
def test_a_gmsh_file_with_physical_groups(tmp_path: Path, kind: str) -> None:
    """Faces are separate cells with their own group, here oriented inwards."""
    mesh = small(kind)
    solid, face = {"tet4": ("tetra", "triangle"), "tet10": ("tetra10", "triangle6")}[kind]
    tip = mesh.facet_sets["tip"].astype(np.int64)
    path = tmp_path / "beam.msh"
    meshio.Mesh(
        1e3 * mesh.nodes,
        [(solid, mesh.elements.astype(np.int64)), (face, tip[:, [1, 0, 2, 3, 5, 4][: tip.shape[1]]])],
        cell_data={"gmsh:physical": [np.full(mesh.n_elements, 1, np.int32), np.full(len(tip), 2, np.int32)],
                   "gmsh:geometrical": [np.ones(mesh.n_elements, np.int32), np.ones(len(tip), np.int32)]},
        field_data={"body": np.array([1, 3]), "tip": np.array([2, 2])},
    ).write(path, file_format="gmsh22", binary=False)  # fmt: skip
    read = tisim.read(path, unit="mm", elements="body")
    assert read.kind == kind
    np.testing.assert_allclose(read.nodes, mesh.nodes, atol=1e-15)
    np.testing.assert_array_equal(read.elements, mesh.elements)
    assert {tuple(sorted(f)) for f in read.facet_sets["tip"]} == {tuple(sorted(f)) for f in tip}
    np.testing.assert_array_equal(read.node_sets["tip"], mesh.node_sets["tip"])
    with pytest.raises(MeshError, match=r"elements 'bone': expected an element set of the file: body"):
        tisim.read(path, elements="bone")
    with pytest.raises(MeshError, match=r"up to 10 m, got 2[0-9.]+ m: give unit='mm'"):
        tisim.read(path)


GMSH_41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 5 "base"
3 6 "body"
$EndPhysicalNames
$Entities
0 0 1 1
1 0 0 0 1 1 0 1 5 0
1 0 0 0 1 1 1 1 6 0
$EndEntities
$Nodes
1 5 1 5
3 1 0 5
1
2
3
4
5
0 0 0
1 0 0
0 1 0
0 0 1
9 9 9
$EndNodes
$Elements
2 2 1 2
2 1 2 1
1 1 2 3
3 1 4 1
2 1 2 3 4
$EndElements
"""


def test_an_element_in_two_physical_groups_is_one_element(tmp_path: Path) -> None:
    """Gmsh 2.2 writes it once for each of its groups."""
    mesh = small("tet4")
    n = mesh.n_elements
    path = tmp_path / "beam.msh"
    meshio.Mesh(
        mesh.nodes,
        [("tetra", np.concatenate([mesh.elements, mesh.elements]))],
        cell_data={"gmsh:physical": [np.repeat([1, 2], n).astype(np.int32)],
                   "gmsh:geometrical": [np.ones(2 * n, np.int32)]},
        field_data={"all": np.array([1, 3]), "soft": np.array([2, 3])},
    ).write(path, file_format="gmsh22", binary=False)  # fmt: skip
    found = tisim.read(path)
    assert found.n_elements == n
    assert tisim.mesh.volumes(found).sum() == pytest.approx(tisim.mesh.volumes(mesh).sum())
    assert len(found.facet_sets["surface"]) == len(mesh.facet_sets["surface"])
    assert len(found.node_sets["soft"]) == mesh.n_nodes


def test_gmsh_as_it_is_written_today(tmp_path: Path) -> None:
    mesh = tisim.read(written(tmp_path, GMSH_41, "tet.msh"))
    assert (mesh.kind, mesh.n_nodes, sorted(mesh.node_sets)) == ("tet4", 4, ["base", "body"])
    np.testing.assert_array_equal(mesh.node_sets["base"], [0, 1, 2])
    assert mesh.facet_sets["base"].tolist() == [[0, 2, 1]]  # outward


def test_a_result_read_again_is_its_rest_shape(tmp_path: Path) -> None:
    mesh = small("hex8")
    moved = mesh.nodes - np.array([0.0, 0.0, 0.01])
    result = tisim.Result(
        scene=None, status=tisim.Status.CONVERGED, mesh=mesh, load=np.ones(1), positions=moved[None],
        support_force=np.zeros((1, 3)), min_jacobian=np.ones(1), residual=np.zeros(1),
    )  # fmt: skip
    read = tisim.read(tisim.write(result, tmp_path / "beam.vtu"))
    np.testing.assert_allclose(read.nodes, mesh.nodes, atol=1e-15)
    for name in ("clamp", "tip"):
        np.testing.assert_array_equal(read.node_sets[name], mesh.node_sets[name])


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (("c3d8r", "C3D6"), r"elements of type C3D6: expected one of C3D4, C3D10, C3D8, C3D20"),
        (("4, 5, 6, 7\n", "4, 5, 6\n"), r"line 14: \*ELEMENT, TYPE=C3D8R: expected 8 nodes an element"),
        (("2, 20., 20., 0.", "2, 20., x, 0."), r"line 3: \*NODE: numbers are expected there"),
        (("10, 1, 2, 3,", "10, 1, 2, 8,"), r"element 4: node 8 is named, and there is none"),
        (("Part-1-1.clamp,", "grip,"), r"node set 'grip' is named, and there is none"),
        (("Block, S2", "Block, S7"), r"\*SURFACE 'top': expected faces S1 to S6 of elements, got S7"),
        (("*MATERIAL", "*NGEN\n1, 2\n*MATERIAL"), r"\*NGEN: nodes that are generated cannot be read"),
        (("*STEP", "*NODE\n3, 1., 1., 1.\n*STEP"), r"\*NODE: node 3 is stated twice, in two places"),
        (("*STEP", "*INSTANCE, NAME=A, PART=B\n0., 1., 0.\n*STEP"), r"\*INSTANCE: expected one part"),
        (("*MATERIAL", "*INCLUDE, INPUT=no.inp\n*MATERIAL"), r"\*INCLUDE: there is no file"),
        (("*MATERIAL", "*NSET, NSET=A, INPUT=no.dat\n*MATERIAL"), r"\*NSET: there is no file"),
        ((CUBE[: CUBE.index("*NODE")], "1, 2, 3\n"), r"line 1: expected a keyword, which begins with \*"),
        ((CUBE[CUBE.index("*ELEMENT") : CUBE.index("*NSET,")], ""), r"expected \*NODE and \*ELEMENT"),
        (("20., 20., 20.", "nan, 20., 20."), r"expected finite coordinates"),
    ],
)  # fmt: skip
def test_what_an_input_file_may_not_hold(tmp_path: Path, change: tuple[str, str], sentence: str) -> None:
    assert change[0] in CUBE
    with pytest.raises(MeshError, match=sentence) as error:
        tisim.read(written(tmp_path, CUBE.replace(*change, 1)), unit="mm")
    assert str(error.value).startswith(str(tmp_path))
    assert "\n" not in str(error.value)


def test_other_files_that_cannot_be_read(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for name in ("beam.msh", "beam.vtu"):
        with pytest.raises(MeshError, match=r"which it is not"):
            tisim.read(written(tmp_path, "$Nonsense\n<VTKFile>", name))
    with pytest.raises(MeshError, match=r"expected a name that ends in \.inp, \.msh, \.vtu"):
        tisim.read(written(tmp_path, "", "beam.stl"))
    with pytest.raises(FileNotFoundError):
        tisim.read(tmp_path / "none.inp")
    binary = tmp_path / "binary.inp"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MeshError, match="expected a text file"):
        tisim.read(binary)
    mixed = tmp_path / "mixed.vtu"
    nodes = small().nodes
    meshio.Mesh(nodes, [("tetra", [[0, 1, 2, 3]]), ("hexahedron", [list(range(8))])]).write(mixed)
    with pytest.raises(MeshError, match=r"elements of one kind, found 1 tet4 and 1 hex8"):
        tisim.read(mixed)
    wedge = tmp_path / "wedge.vtu"
    meshio.Mesh(nodes, [("wedge", [[0, 1, 2, 3, 4, 5]])]).write(wedge)
    with pytest.raises(MeshError, match=r"elements of type wedge: expected tetra or"):
        tisim.read(wedge)
    assert capfd.readouterr().out == ""


def test_names_in_quotes_and_comments_in_latin(tmp_path: Path) -> None:
    """A dot in a quoted name is no prefix of an instance, and what follows it no node."""
    sets = '*NSET, NSET="Set 1.2"\n10, 1\n*NSET, NSET=B\n"Set 1.2", 3\n'
    path = tmp_path / "latin.inp"
    path.write_bytes(("** Körper\n" + CUBE.replace("** a comment\n", sets)).encode("latin-1"))
    mesh = tisim.read(path, unit="mm")
    assert len(mesh.node_sets["b"]) == 3
    assert set(mesh.node_sets["set 1.2"].tolist()) < set(mesh.node_sets["b"].tolist())


def gmsh_41(first: str, second: str) -> str:
    """Two tetrahedra, and a face of each as an entity with physical groups."""
    names = '$PhysicalNames\n4\n2 2 "clamp"\n2 3 "glued"\n2 4 "tip"\n3 1 "body"\n$EndPhysicalNames\n'
    surfaces = "".join(f"{k} 0 0 0 1 1 1 {groups} 0\n" for k, groups in ((1, first), (2, second)))
    nodes = "3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n"
    elements = "3 4 1 4\n2 1 2 1\n1 1 3 2\n2 2 2 1\n2 2 3 5\n3 1 4 2\n3 1 2 3 4\n4 2 3 4 5\n"
    return (
        f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}"
        f"$Entities\n0 0 2 1\n{surfaces}1 0 0 0 1 1 1 1 1 2 1 2\n"
        f"$EndEntities\n$Nodes\n1 5 1 5\n{nodes}$EndNodes\n$Elements\n{elements}$EndElements\n"
    )


def test_groups_of_gmsh_4(tmp_path: Path) -> None:
    """A surface in two groups is in both, a reversed one (a negative tag) in its own."""
    mesh = tisim.read(written(tmp_path, gmsh_41("2 2 3", "1 -4"), "two.msh"))
    assert {"body", "clamp", "glued", "tip"} <= set(mesh.node_sets)
    np.testing.assert_array_equal(mesh.node_sets["clamp"], mesh.node_sets["glued"])
    assert len(mesh.facet_sets["glued"]) == len(mesh.facet_sets["tip"]) == 1
    with pytest.raises(MeshError, match="expected every entity in a physical group"):
        tisim.read(written(tmp_path, gmsh_41("1 2", "0"), "one.msh"))
