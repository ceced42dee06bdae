"""Surfaces that bound no body are refused with one sentence; valid ones are returned in metres."""

import numpy as np
import pytest
import trimesh

from tisim.mesh._mesh import MeshError
from tisim.mesh.surface import checked_surface, crossing_faces


def ball(radius=0.01, at=(0.0, 0.0, 0.0), subdivisions=2):
    return trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius).apply_translation(at)


def joined(*surfaces):
    return trimesh.util.concatenate(surfaces)


def opened():
    surface = trimesh.creation.box((0.1, 0.1, 0.03))
    surface.update_faces(np.arange(12) != 3)
    return surface


def inside_out():
    surface = ball()
    surface.invert()
    return surface


def one_turned():
    faces = ball().faces.copy()
    faces[5] = faces[5][::-1]
    return trimesh.Trimesh(ball().vertices, faces, process=False)


def pinched():
    surface = trimesh.creation.box((0.1, 0.1, 0.03))
    vertices = surface.vertices.copy()
    vertices[0] = (0.04, 0.04, 0.05)  # a bottom corner moved out through the top
    return trimesh.Trimesh(vertices, surface.faces, process=False)


def flat():
    vertices = [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0.1, 0.1, 0]]
    return trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], process=False)


@pytest.mark.parametrize(
    ("surface", "options", "message"),
    [
        (opened(), {}, r"the surface is open: 3 boundary edges"),
        (inside_out(), {}, r"inside-out.*turn the normals"),
        (one_turned(), {}, r"turned against their neighbours"),
        (joined(ball(), ball(at=(0.05, 0, 0))), {}, r"2 separate pieces"),
        (joined(ball(), ball(at=(0.05, 0, 0))), {"allow_cavities": True}, r"2 separate bodies"),
        (pinched(), {}, r"cuts through itself in \d+ pairs of triangles, first near"),
        (flat(), {}, r"is flat"),
        (trimesh.Trimesh(), {}, r"is empty"),
        (ball(10.0), {}, r"20 m large; its coordinates look like millimetres"),
        (ball(0.01), {"units": "mm"}, r"0\.02 mm large; its coordinates look like metres"),
        (ball(), {"units": "inch"}, r"units must be 'm' or 'mm'"),
        (
            trimesh.Trimesh([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False),
            {},
            r"not finite",
        ),
    ],
)
def test_a_surface_without_a_body_is_refused_in_one_sentence(surface, options, message):
    with pytest.raises(MeshError, match=message) as caught:
        checked_surface(surface, **options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.stl", None, "there is no surface file"),
        ("empty.stl", b"", "is empty"),
        ("junk.ply", b"\x00\x01 junk", "cannot be read as a surface"),
        ("cloud.unknown", b"1 2 3", "cannot be read as a surface"),
        ("short.stl", bytes(80) + b"\xff\x00\x00\x00" + b"abc", "is empty"),
    ],
    ids=["missing", "empty", "junk", "unknown", "short"],
)
def test_unreadable_files_are_named(tmp_path, name, content, message):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(MeshError, match=message) as caught:
        checked_surface(tmp_path / name)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".off"])
def test_files_in_millimetres_come_out_in_metres(tmp_path, suffix):
    path = tmp_path / f"ball{suffix}"
    ball(10.0).export(path)
    shell = checked_surface(path, units="mm")
    assert shell.extents == pytest.approx(0.02, rel=1e-6)
    assert shell.volume == pytest.approx(ball().volume, rel=1e-5)


def test_the_callers_surface_is_not_changed():
    surface = ball(10.0)
    checked_surface(surface, units="mm")
    assert surface.extents == pytest.approx(20.0)


def test_a_cavity_is_let_through_where_allowed():
    hollow = joined(ball(), ball(0.004).copy())
    faces = hollow.faces.copy()
    inner = np.linalg.norm(hollow.triangles_center, axis=1) < 0.005
    faces[inner] = faces[inner][:, ::-1]
    hollow = trimesh.Trimesh(hollow.vertices, faces, process=False)
    assert checked_surface(hollow, allow_cavities=True).volume < ball().volume
    with pytest.raises(MeshError, match="2 separate pieces"):
        checked_surface(hollow)


def test_crossing_faces_are_those_of_the_crossing_and_touching_is_none():
    two = joined(ball(), ball(at=(0.012, 0.0005, 0.0003)))
    pairs = crossing_faces(two)
    n = len(ball().faces)
    assert len(pairs) > 10
    assert ((pairs[:, 0] < n) & (pairs[:, 1] >= n)).all()
    # the two spheres intersect in a circle in the plane half-way between their centres
    assert np.abs(two.triangles_center[pairs.ravel()][:, 0] - 0.006).max() < 0.003
    assert len(crossing_faces(ball())) == 0
    assert len(crossing_faces(trimesh.creation.box((1.0, 1.0, 1.0)).subdivide())) == 0
