"""CAD bodies from files."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

from calibration.errors import InputError
from calibration.shape import read_mesh


@pytest.mark.parametrize("ending", [".stl", ".ply", ".STL"])
def test_millimetres_become_metres(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"beam{ending}"
    trimesh.creation.cylinder(radius=10.0, height=100.0).export(path, file_type=ending[1:].lower())
    body = read_mesh(path, units="mm")
    assert body.is_watertight
    assert body.extents == pytest.approx([0.02, 0.02, 0.1], rel=1e-5)


def test_metres(tmp_path: Path) -> None:
    path = tmp_path / "beam.stl"
    trimesh.creation.box((0.1, 0.02, 0.02)).export(path)
    assert read_mesh(path, units="m").volume == pytest.approx(4e-5, rel=1e-5)


def test_units_must_be_said() -> None:
    with pytest.raises(TypeError, match="units"):
        read_mesh("beam.stl")  # type: ignore[call-arg]


def test_refusals_are_one_sentence_with_the_file(tmp_path: Path) -> None:
    box = trimesh.creation.box((100.0, 20.0, 20.0))
    good = tmp_path / "good.stl"
    box.export(good)
    opened = tmp_path / "open.stl"
    trimesh.Trimesh(box.vertices, box.faces[1:], process=False).export(opened)
    broken = tmp_path / "broken.ply"
    broken.write_text("this is no mesh\n")
    other = tmp_path / "beam.obj"
    box.export(other)
    for path, units, message in (
        (good, "m", "look like millimetres"),
        (good, "inch", "expected 'mm' or 'm'"),
        (opened, "mm", "is open"),
        (broken, "mm", "cannot be read"),
        (other, "mm", "ends in .stl or .ply"),
        (tmp_path / "none.stl", "mm", "there is no surface file"),
    ):
        with pytest.raises(InputError, match=message) as caught:
            read_mesh(path, units=units)  # type: ignore[arg-type]
        assert path.name in str(caught.value)
        assert "\n" not in str(caught.value)
