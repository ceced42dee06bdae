"""Three-dimensional views of results: content of a page, files, films, and the page in a browser."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import tisim
from tisim.view import Curve, Field, Surface, View, view_of_file
from tisim.view.command import app
from tisim.view.page import colour_ranges, script, section, style

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=20e3, bulk_modulus=400e3)
BEAM = tisim.Beam(material=SOFT, length=0.03, axial_element_size=0.01, radial_elements=1)
POKE = tisim.Poke(material=SOFT, depth=1e-3, frame_spacing=5e-4, refinement=0.5)


@pytest.fixture(scope="module")
def poke() -> tisim.Result:
    return tisim.simulate(POKE)


@pytest.fixture(scope="module")
def shown(poke: tisim.Result) -> View:
    return tisim.show(poke)


@pytest.fixture(scope="module")
def files(poke: tisim.Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with poke.pvd and beam.vtu."""
    folder = tmp_path_factory.mktemp("shown")
    tisim.write(poke, folder / "poke.pvd")
    tisim.write(tisim.simulate(BEAM), folder / "beam.vtu")
    return folder


def data_of(page: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" class="data">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_a_page_holds_positions_and_fields(shown: View) -> None:
    """Decoded as by the script: positions to 1/65,535 of the picture, fields to 1/255 of their range."""
    data = data_of(shown.html())
    numbers = zlib.decompress(base64.b64decode(data["numbers"]))
    for mesh, surface in zip(data["meshes"], shown.surfaces, strict=True):
        place = mesh["positions"]
        steps = np.frombuffer(numbers, "<u2", place["count"], place["at"]).reshape(mesh["frames"], -1, 3)
        held = np.cumsum(steps, axis=0, dtype=np.uint16) / 65535.0 * data["size"] + data["corner"]
        assert np.abs(held - surface.positions).max() < 0.6 / 65535.0 * max(data["size"]) + 1e-9
        place = mesh["triangles"]
        index = np.frombuffer(numbers, "<u4", place["count"], place["at"])
        assert np.array_equal(index.reshape(-1, 3), surface.triangles)
    stress = shown.colourings.index("von Mises stress")
    place = data["meshes"][0]["fields"][stress]
    held = np.frombuffer(numbers, np.uint8, place["count"], place["at"]) / 255.0
    field, (low, high) = colour_ranges(shown)["von Mises stress"]
    assert data["colourings"][stress]["unit"] == "kPa"
    assert float(data["colourings"][stress]["ticks"][2].removeprefix("≥ ")) == pytest.approx(high, rel=5e-3)
    wanted = np.clip((field.values.ravel() - low) / (high - low), 0.0, 1.0)
    assert np.abs(held - wanted).max() < 0.6 / 255.0


def test_a_view_of_a_poke_says_depth_and_force(poke: tisim.Result, shown: View) -> None:
    assert len(shown.labels) == 2
    force = np.linalg.norm(poke.rod_force[-1])
    assert shown.labels[-1] == f"depth 1 mm · force on the rod {force:.4g} N"
    assert shown.curve is not None
    assert shown.curve.y[-1] == pytest.approx(force)
    assert shown.opened
    assert shown.colourings[:3] == ("displacement", "von Mises stress", "strain energy density")
    rod = shown.surfaces[-1]
    lowest = rod.positions[:, :, 2].min(axis=1)
    assert lowest == pytest.approx(poke.rod_tip[:, 2], abs=1e-6)


def test_a_notebook_shows_it_and_a_page_needs_nothing_else(shown: View, tmp_path: Path) -> None:
    html = shown._repr_html_()
    assert html.startswith("<iframe ")
    assert "srcdoc=" in html
    page = shown.save(tmp_path / "poke.html").read_text(encoding="utf-8")
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    assert "http" not in page
    with pytest.raises(FileNotFoundError, match="expected a folder that exists"):
        shown.save(tmp_path / "nofolder" / "poke.html")


def test_files_show_what_the_result_does(shown: View, files: Path) -> None:
    read = view_of_file(files / "poke.pvd")
    assert read.labels == shown.labels
    assert read.colourings == shown.colourings
    for mine, theirs in zip(read.surfaces, shown.surfaces, strict=True):
        assert np.abs(mine.positions - theirs.positions).max() < 1e-9
        for a, b in zip(mine.fields, theirs.fields, strict=True):
            assert a.unit == b.unit
            assert a.values == pytest.approx(b.values)
    both = view_of_file(*sorted((files / "poke").iterdir()))
    assert both.labels == shown.labels
    beam = view_of_file(files / "beam.vtu")
    assert beam.labels[0].startswith("load 1 · force of the supports ")


def test_an_imperfect_beam_is_displaced_from_its_own_rest_shape(tmp_path: Path) -> None:
    """The mesh of a curved and tapered beam is that of the ideal prism; nothing loads this one."""
    bent = replace(
        BEAM, gravity=(0.0, 0.0, -1e-6), imperfections=tisim.Imperfections(curvature=2.0, taper=2.0)
    )
    result = tisim.simulate(bent)
    rest = tisim.rest_positions(bent, result.mesh)
    np.testing.assert_array_equal(result.rest_positions, rest)
    assert np.abs(rest - result.mesh.nodes).max() > 1e-4
    tisim.write(result, tmp_path / "bent.vtu")
    found = meshio.read(tmp_path / "bent.vtu")
    assert np.abs(found.point_data["displacement"]).max() < 1e-8
    np.testing.assert_allclose(found.cell_data["volume_ratio"][0], 1.0, atol=1e-5)
    assert tisim.show(result).surfaces[0].fields[0].values.max() < 1e-5
    assert "largest displacement 0.00" not in repr(tisim.simulate(replace(BEAM, gravity=(0.0, 0.0, -9.81))))
    moved = re.search(r"largest displacement (\S+) mm", repr(result))
    assert moved is not None
    assert float(moved[1]) < 1e-4


@pytest.mark.parametrize("at_rest", [True, False])
def test_a_series_of_another_program_moves(tmp_path: Path, at_rest: bool) -> None:
    """Its points are at rest, with a displacement beside them, or have moved."""
    corners = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)
    cells = [("hexahedron", np.arange(8)[None])]
    paths = []
    for k, part in enumerate((0.1, 0.2, 0.4)):
        u = part * corners[:, 2:] * [0.0, 0.0, 1.0]
        points = corners if at_rest else corners + u
        vector = {"load": [np.ones((1, 3))]}  # a name of tisim's with another shape
        paths.append(tmp_path / f"s{k}.vtu")
        meshio.Mesh(points, cells, point_data={"displacement": u}, cell_data=vector).write(paths[-1])
    view = view_of_file(*paths)
    body, rest = view.surfaces
    np.testing.assert_allclose(body.fields[0].values.max(axis=1), [100.0, 200.0, 400.0], rtol=1e-6)
    np.testing.assert_allclose(body.positions[:, :, 2].max(axis=1), [1.1, 1.2, 1.4], rtol=1e-6)
    assert rest.positions[0][:, 2].max() == pytest.approx(1.0)


def test_units_have_prefixes_that_suit(shown: View) -> None:
    units = {f.name: f.unit for f in shown.surfaces[0].fields}
    assert units["displacement"] == "mm"
    assert units["strain energy density"] in ("J/m³", "kJ/m³")
    assert units["largest principal stretch"] == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nothing.vtu"], "there is no such file"),
        (["text.vtu"], "expected a VTU file"),
        (["text.pvd"], "expected a ParaView series"),
        (["text.txt"], "expected a .vtu, a .pvd or the store"),
        (["folder"], "expected the store of a dataset"),
        (["beam.vtu", "--poke", "1"], "--poke goes with the store"),
        (["beam.vtu", "--gif", "x.gif", "--colour", "mood"], "expected one of displacement, von Mises"),
        (["beam.vtu", "--gif", "x.gif", "--width", "7"], "width of 200 to 2000"),
        (["beam.vtu", "--out", "nofolder/x.html"], "expected a folder that exists"),
        (["beam.vtu", "--out", "beam.vtu"], "--out beam.vtu: expected a name that ends in .html"),
        (["beam.vtu", "--gif", "name.v2"], "--gif name.v2: expected a name that ends in .gif"),
        (["beam.vtu", "--gif", "."], "--gif .: expected a name that ends in .gif"),
        (["beam.vtu", "--mp4", "film.gif"], "--mp4 film.gif: expected a name that ends in .mp4"),
        (["beam.vtu", "poke/poke-001.vtu"], "expected the elements of"),
    ],
)
def test_what_cannot_be_shown_is_one_sentence(
    words: list[str], said: str, files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files)
    for name in ("text.vtu", "text.pvd", "text.txt"):
        Path(name).write_text("a text\n")
    Path("folder").mkdir(exist_ok=True)
    ended = CliRunner().invoke(app, words)
    assert ended.exit_code == 2, ended.output
    assert said in ended.output
    assert ended.output.startswith("error: ")
    assert ended.output.count("\n") == 1


def test_the_command_writes_page_and_picture(files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(files)
    ended = CliRunner().invoke(app, ["poke.pvd"])
    assert ended.exit_code == 0, ended.output
    assert Path("poke.html").stat().st_size < 1e6
    ended = CliRunner().invoke(app, ["poke.pvd", "--gif", "poke.gif", "--width", "300", "--seconds", "1"])
    assert ended.exit_code == 0, ended.output
    with Image.open("poke.gif") as picture:
        assert picture.n_frames == 2  # type: ignore[attr-defined]
        assert picture.width == 300
        colours = len(set(picture.convert("RGB").get_flattened_data()))
    assert colours > 20


def test_a_film_is_written(shown: View, tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg", reason="the extra video is not installed")
    film = shown.animate(tmp_path / "poke.mp4", width=300, seconds=1.0)
    assert film.read_bytes()[4:8] == b"ftyp"


def test_a_film_or_page_that_is_not_finished_leaves_the_old_one(
    shown: View, poke: tisim.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are written beside it, and put in place in one step: here none comes to that."""
    seen = []

    def killed(part: Path, path: Path) -> None:
        seen.append((part.name.startswith(path.name), part.stat().st_size > 1000, path.read_text()))
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", killed)
    for name, write in (
        ("a.html", shown.save),
        ("a.gif", lambda path: shown.animate(path, seconds=0.2, width=200)),
        ("a.png", lambda path: tisim.picture(poke, path)),
        ("a.vtu", lambda path: tisim.write(poke, path)),
        ("a.ply", lambda path: tisim.write(poke, path)),
        ("a.stl", lambda path: tisim.write(poke, path)),
    ):
        (tmp_path / name).write_text("old")
        with pytest.raises(KeyboardInterrupt):
            write(tmp_path / name)
        assert seen.pop() == (True, True, "old"), name
        assert (tmp_path / name).read_text() == "old"
    assert len(list(tmp_path.iterdir())) == 6


@pytest.mark.parametrize("code", [0, 1])
def test_a_film_that_ffmpeg_does_not_finish_is_not_left(
    code: int, shown: View, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ffmpeg is a stand-in that writes its last argument; its format is stated, as the name does not."""
    program, film = tmp_path / "bin" / "ffmpeg", tmp_path / "poke.mp4"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\ncat >/dev/null\nfor last; do :; done\necho "$*" >"$last"\nexit {code}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
    film.write_text("old")
    if code:
        with pytest.raises(ValueError, match=r"^poke\.mp4: ffmpeg ended with"):
            shown.animate(film, seconds=0.2, width=200)
        assert film.read_text() == "old"
    else:
        shown.animate(film, seconds=0.2, width=200)
        assert " -f mp4 " in film.read_text()
    assert {p.name for p in tmp_path.iterdir()} == {"bin", "poke.mp4"}


def test_no_ffmpeg_is_said_in_one_sentence(
    shown: View, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(ValueError, match=r"an MP4 needs ffmpeg: install it, or pip install 'tisim\[video\]'"):
        shown.animate(tmp_path / "poke.mp4", width=300)


@pytest.fixture(scope="module")
def browser():
    """Chromium, if it is installed; else the tests are skipped."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    found = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if found is None:
        pytest.skip("there is no chromium")
    with playwright.sync_playwright() as driver:
        arguments = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
        arguments.append("--enable-unsafe-swiftshader")
        browser = driver.chromium.launch(executable_path=found, args=arguments)
        yield browser
        browser.close()


def test_the_page_in_a_browser(browser: Any, shown: View, tmp_path: Path) -> None:
    """At a phone's width: the page draws, frames step by keyboard, colours change, no errors are logged."""
    page = browser.new_page(viewport={"width": 390, "height": 844})
    complaints: list[str] = []
    page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning") else None)
    page.on("pageerror", lambda e: complaints.append(str(e)))
    page.goto(shown.save(tmp_path / "poke.html").as_uri())
    page.wait_for_selector(".tisim-view[data-ready]")
    page.wait_for_timeout(100)
    assert page.locator(".readout").inner_text() == shown.labels[-1]
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    first = picture_of(page, tmp_path)
    assert len(set(first.get_flattened_data())) > 200, "it draws"
    page.locator(".frame").focus()
    page.keyboard.press("Home")
    assert page.locator(".readout").inner_text() == shown.labels[0]
    page.locator(".frame").press("End")
    page.locator("select").select_option(label="von Mises stress [kPa]")
    assert page.locator(".bar .name").inner_text() == "von Mises stress [kPa]"
    coloured = picture_of(page, tmp_path)
    assert coloured.tobytes() != first.tobytes()
    page.locator("canvas").focus()
    page.keyboard.press("ArrowLeft")
    assert picture_of(page, tmp_path).tobytes() != coloured.tobytes(), "it turns"
    page.locator(".play").click()
    page.wait_for_function("document.querySelector('.play').textContent === 'Play'")
    assert page.locator(".readout").inner_text() == shown.labels[-1]
    assert not complaints
    page.close()


def picture_of(page: Any, folder: Path) -> Image.Image:
    page.wait_for_timeout(60)
    page.locator("canvas").screenshot(path=folder / "canvas.png")
    with Image.open(folder / "canvas.png") as picture:
        return picture.convert("RGB").crop((0, 0, picture.width, picture.height - 90))


def test_views_of_ones_own_share_a_page(browser: Any, tmp_path: Path) -> None:
    """Two views share one script; a view far off the screen releases its WebGL context and restores it."""
    corner = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)
    field = Field(name="<height>", unit="m", values=corner[:, :, 2])
    views = [
        View(
            title=f"A corner & {k}",
            labels=("one",),
            surfaces=(Surface(positions=corner, triangles=faces, fields=(field,)),),
            curve=Curve(x=np.zeros(1), x_name="x", x_unit="", y=np.zeros(1), y_name="y", y_unit="N"),
        )
        for k in range(2)
    ]
    space = '<div style="height:4000px"></div>'
    sections = space.join(section(v) for v in views)
    (tmp_path / "two.html").write_text(
        f'<!doctype html><meta charset="utf-8"><title>two</title><link rel="icon" href="data:,">'
        f"<style>{style()}</style>{sections}<script>{script()}</script>"
    )
    page = browser.new_page(viewport={"width": 800, "height": 600})
    complaints: list[str] = []
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda e: complaints.append(str(e)))
    page.goto((tmp_path / "two.html").as_uri())
    page.wait_for_function("document.querySelectorAll('.tisim-view[data-ready]').length === 1")
    page.locator("canvas").nth(1).scroll_into_view_if_needed()
    page.wait_for_function("document.querySelectorAll('.tisim-view[data-ready]').length === 2")
    page.wait_for_timeout(150)
    page.locator("canvas").nth(0).scroll_into_view_if_needed()
    page.wait_for_timeout(300)
    page.locator("canvas").nth(0).screenshot(path=tmp_path / "again.png")
    with Image.open(tmp_path / "again.png") as picture:
        assert len(set(picture.convert("RGB").get_flattened_data())) > 50, "it draws again"
    assert page.locator(".bar .name").nth(0).inner_text() == "<height> [m]"
    assert not complaints
    page.close()
