"""The page in Chromium, opened from disk as on a phone: values, controls, no errors.

The median time of a frame is printed (`-rP`) and recorded as a property. Test machines share their cores, so
that no bound is set here (docs/how-to/live-page.md has figures).
"""

from __future__ import annotations

import base64
import gzip
import importlib.util
import io
import math
import re
import shutil
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from learn.data._format import RIGID
from learn.errors import ImpossiblePokeError, InputError
from learn.page import command
from learn.page.content import Content, content_of
from learn.page.document import LARGEST, Parts, Written, write_page
from learn.page.simulated import described
from learn.predictor import Predictor
from learn.real_time import RealTime
from tests.learn.commands import call
from tests.learn.page.contrast import CONTRAST

CHROMIUM = shutil.which("chromium")
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# the page is open for seconds: to optimise WebAssembly takes longer than that saves, as do layers of WebGL
FLAGS += ["--js-flags=--liftoff-only", "--disable-gpu-compositing"]
NEEDED = ("onnx", "onnxscript", "onnxruntime")
pytestmark = pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in NEEDED),
    reason=f"one of {', '.join(NEEDED)} is not installed",
)
SHAPES = ["shape-0", "shape-2"]  # of the page; the second is of the training part
# mm, degrees, kPa: inside the trained ranges, steep, outside the trained ranges
POKES = [
    {"interior": 0, "x": 3.0, "y": -8.0, "angle": 12.0, "heading": 40.0, "depth": 2.0, "modulus": 12.0},
    {"interior": 1, "x": -20.0, "y": 15.5, "angle": 33.0, "heading": -120.0, "depth": 1.3, "modulus": 25.0},
    {"interior": 0, "x": 0.0, "y": 0.0, "angle": 0.0, "heading": 0.0, "depth": 6.0, "modulus": 9.0},
]


@pytest.fixture(scope="module")
def written(predictor: Predictor, tmp_path_factory: pytest.TempPathFactory) -> Written:
    return write_page(predictor, tmp_path_factory.mktemp("html") / "poke.html", shapes=SHAPES, pokes=1)


@pytest.fixture(scope="module")
def opened(written: Written) -> Iterator[Any]:
    """The page at a phone's width, with its errors in `faults`; opened once, since that takes 4 core-s."""
    if CHROMIUM is None:
        pytest.skip("there is no chromium on the path")
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 390, "height": 700}, has_touch=True, is_mobile=True)
        page.faults = []
        page.on("pageerror", lambda error: page.faults.append(str(error)))
        page.on("console", lambda said: page.faults.append(said.text) if said.type == "error" else None)
        page.on("request", lambda asked: page.faults.append(asked.url) if "http" in asked.url[:5] else None)
        page.goto(written.path.as_uri())
        page.wait_for_function("document.documentElement.dataset.ready", timeout=60_000)
        yield page
        browser.close()


@pytest.fixture
def page(opened: Any) -> Any:
    """The page as it is after it was opened: poke, standpoint, and limits of the sliders."""
    opened.evaluate("""async () => {
      const t = await tisim;
      t.limits ??= structuredClone(t.about.sliders);
      Object.assign(t.about.sliders, structuredClone(t.limits));
      scrollTo(0, 0);
      t.beside(null);
      t.view.look("slant");
      t.change({ ...t.about.start });
      while (t.awake || t.asked) await new Promise((r) => setTimeout(r, 5));
    }""")
    return opened


def _graph(path: Path) -> Any:
    """The graph in the file, run by onnxruntime in this process."""
    import onnxruntime

    found = re.search(r'id="graph">([^<]*)<', path.read_text(encoding="utf-8"))
    assert found is not None
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3
    model = gzip.decompress(base64.b64decode(found[1]))
    return onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])


def _pose(poke: dict[str, float]) -> np.ndarray[Any, np.dtype[np.float64]]:
    turn = np.pi / 180
    values = [poke["x"] * 1e-3, poke["y"] * 1e-3, poke["angle"] * turn, poke["heading"] * turn]
    return np.array([*values, poke["depth"] * 1e-3, poke["modulus"] * 1e3])


def test_it_is_one_small_file(written: Written) -> None:
    assert written.gzipped < LARGEST
    assert written.size == written.path.stat().st_size
    assert not re.search(r"""(src|href)\s*=\s*["']""", written.path.read_text(encoding="utf-8")[:20_000])


def test_the_page_from_the_zip_is_the_page_from_the_run(
    predictor: Predictor, written: Written, tmp_path: Path
) -> None:
    saved, later, again = (tmp_path / name for name in ("poke.zip", "later.html", "again.zip"))
    shapes = [flag for name in SHAPES for flag in ("--shape", name)]
    done = call(command.app, predictor.run.folder, *shapes, "--pokes", 1, "--parts", saved)
    assert done.exit_code == 0, done.output
    done = call(command.app, saved, "--out", later)
    assert done.exit_code == 0, done.output
    assert "3 interiors, 1 simulated poke of" in done.output
    assert written.path.read_bytes() == later.read_bytes()
    assert saved.stat().st_size < 0.3 * written.gzipped
    Parts.load(saved).save(again)
    assert again.read_bytes() == saved.read_bytes()


def test_the_browser_says_what_python_says(page: Any, written: Written, predictor: Predictor) -> None:
    """Agreement to 1e-6 of the largest displacement and of the force with onnxruntime and torch in Python."""
    content: Content = content_of(predictor, shapes=SHAPES, pokes=1)
    session, names = _graph(written.path), content.graph.outputs()
    ask = "async (poke) => { const r = await (await tisim).surrogate.ask(poke);"
    ask += " return Object.fromEntries(Object.entries(r).map(([k, v]) => [k, Array.from(v)])); }"
    for poke in POKES:
        inputs, pose = content.inputs[int(poke["interior"])], _pose(poke)
        found = page.evaluate(ask, poke)
        runtime = dict(zip(names, session.run(None, {"poke": pose, **inputs}), strict=True))
        with torch.no_grad():
            tensors = [torch.from_numpy(array) for array in inputs.values()]
            of_torch = dict(zip(names, content.graph(torch.from_numpy(pose), *tensors), strict=True))
        assert set(found) == set(names)
        for name in names:
            for source, true in (("onnxruntime", runtime[name]), ("torch", of_torch[name].numpy())):
                sizes = np.linalg.norm(true, axis=1) if np.ndim(true) == 2 else np.abs(true)
                wrong = np.abs(np.array(found[name]).reshape(np.shape(true)) - true).max()
                relative = wrong / max(sizes.max(), 1e-12)
                if name in ("displacement", "force"):
                    print(f"{name} at {poke['depth']} mm: {relative:.1e} off {source}")
                assert relative <= 1e-6, (name, source, poke)


def test_controls_move_the_rod_and_the_page_tells_the_answer(page: Any) -> None:
    """Sliders, keys and mouse move the indenter; the page marks extrapolation and shows the FEM poke."""

    def now() -> dict[str, float]:
        found: dict[str, float] = page.evaluate("async () => (await tisim).poke")
        return found

    def answered() -> None:
        page.evaluate(
            "async () => { const t = await tisim;"
            " while (t.awake || t.asked) await new Promise((r) => setTimeout(r, 5)); }"
        )

    page.evaluate("async (poke) => (await tisim).change(poke)", POKES[0])
    page.get_by_label("Depth").fill("2.5")
    answered()
    assert now()["depth"] == 2.5
    force = float(page.locator("#force").inner_text())
    assert force > 0
    assert re.fullmatch(r"90 % interval [\d.]+ to [\d.]+ N", page.locator("#interval").inner_text())
    picture = page.locator("#picture")
    picture.focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("+")
    answered()
    assert now()["x"] == pytest.approx(2.0)
    assert now()["depth"] == pytest.approx(3.0)
    assert float(page.locator("#force").inner_text()) > force

    box = picture.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.55)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 30, box["y"] + box["height"] * 0.55)
    page.mouse.up()
    answered()
    assert now()["x"] != pytest.approx(2.0)

    page.evaluate("async (poke) => (await tisim).change(poke)", {**POKES[2], "depth": 0.0})
    answered()
    assert page.locator("body").get_attribute("data-inside") == "true"
    assert page.locator("#verdict").inner_text() == "No contact: nothing moves."
    assert "outside" not in page.locator("#checks").inner_text()

    page.evaluate("async (poke) => (await tisim).change(poke)", POKES[2])
    answered()
    assert page.locator("body").get_attribute("data-inside") == "false"
    assert "depth (4.5 mm; trained: 1 to 2" in page.locator("#verdict").inner_text()
    page.get_by_role("button", name="Show the FEM poke beside it").click()
    page.wait_for_function("document.getElementById('compared-text').textContent.startsWith('FEM: ')")
    assert "of the points lie within their intervals" in page.locator("#compared-text").inner_text()
    page.wait_for_function("/^Force [0-9.]+ newtons/.test(document.getElementById('spoken').textContent)")


def _judged(page: Any, poke: dict[str, float]) -> str:
    """The page's verdict on a poke."""
    found: str = page.evaluate(
        "async (poke) => { const t = await tisim; t.change(poke);"
        " while (t.awake || t.asked) await new Promise((r) => setTimeout(r, 1));"
        " return document.getElementById('verdict').textContent; }",
        poke,
    )
    return found


def _judge(touch: RealTime, poke: dict[str, float]) -> str:
    """The verdict of `learn.real_time` on a poke of the page, or reason and text of its refusal."""
    x, y, angle, heading, depth, touch.modulus = _pose(poke).tolist()
    push = (math.sin(angle) * math.cos(heading), math.sin(angle) * math.sin(heading), -math.cos(angle))
    try:
        return touch(site=(x, y), direction=push, depth=depth).verdict
    except ImpossiblePokeError as refused:
        return f"{refused.reason}: {refused}"


def _in_mm(predictor: Predictor, poke: dict[str, float]) -> str:
    """What `Predictor.predict` expects in place of a poke that it refuses."""
    keys = {
        "depth_mm": "depth",
        "angle_deg": "angle",
        "heading_deg": "heading",
        "shear_modulus_kPa": "modulus",
    }
    scene = {key: poke[name] for key, name in keys.items()}
    with pytest.raises(InputError) as refused:
        predictor.predict(
            {"shape": SHAPES[int(poke["interior"])], "site_mm": [poke["x"], poke["y"]], **scene}
        )
    return "expected" + re.split("expected|, got", str(refused.value))[1]


def _pokes(predictor: Predictor) -> Iterator[dict[str, float]]:
    """Pokes inside the trained ranges, at every distance from them, and impossible ones."""
    store, domain = predictor.store, predictor.domain
    assert domain is not None
    low, high = domain.ranges["depth_mm"]
    of_training = np.flatnonzero(store.shape == store.shapes.index(SHAPES[1]))[0]
    trained = {**described(store, int(of_training), 1)[0]["poke"], "depth": (low + high) / 2}
    yield trained
    for beyond in (-0.2, 0.0002, 0.03, 0.2, 0.49, 1.1, 14.0):  # of the range
        yield {**trained, "depth": high + 0.01 + 1e-3 * high + beyond * (high - low)}
    for change in (
        {"x": 47.4},
        {"angle": 44.8},
        {"modulus": 35.2},
        {"modulus": 2e3},
        {"interior": 0},
        {"interior": 2},
    ):
        yield {**trained, **change}
    for change in ({"x": 49.0}, {"y": -48.2}, {"angle": 48.0}, {"depth": 33.0}, {"x": 49.0, "depth": 33.0}):
        yield {**trained, **change}
    yield {**trained, "x": 49.0, "depth": 0.0}
    rigid = (store.profile[store.geometry[store.shape == store.shapes.index(SHAPES[0])][0]] == RIGID).any(
        axis=1
    )
    x, y = store.setups[0].points[rigid, :2].mean(axis=0) * 1e3
    random = np.random.default_rng(2)
    for a, b, c, d, e in random.uniform((-9, -9, 0, -180, 9), (9, 9, 44, 180, 31), (25, 5)):
        yield {**trained, "interior": 0, "x": x + a, "y": y + b, "angle": c, "heading": d, "depth": e}


def test_the_page_judges_pokes_as_python_does(page: Any, predictor: Predictor) -> None:
    """Its verdicts are those of `learn.real_time` word by word, and so are its refusals, in mm."""
    wider = "const { depth, modulus } = (await tisim).about.sliders; [depth.high, modulus.high] = [40, 4e3];"
    page.evaluate(f"async () => {{ {wider} }}")  # mm, kPa
    interiors: list[dict[str, Any]] = [{"shape": name} for name in SHAPES] + [{"inclusion": {"kind": "none"}}]
    touches = [predictor.real_time({**interior, "shear_modulus_kPa": 12.0}) for interior in interiors]
    seen = set()
    for poke in _pokes(predictor):
        told, true = _judged(page, poke), _judge(touches[int(poke["interior"])], poke)
        reason = true.partition(":")[0]
        if reason not in ("site", "depth", "angle", "inclusion"):
            assert told == true, poke
            seen.add(told.partition(" the ")[0])
            continue
        seen.add(reason)
        expected = true.partition("direction: ")[2].partition(", got")[0] or _in_mm(predictor, poke)
        match = re.fullmatch(r"No prediction: [a-z ]+: (.*), got .*\.", told)
        assert match is not None, (told, poke)
        assert match[1] == expected
        assert page.locator("#force").inner_text() == "\N{EN DASH}"
        assert page.locator("body").get_attribute("data-inside") == "refused"
    grades = {"Inside", "Just outside", "Outside", "Far outside", "No contact: nothing moves."}
    assert seen == grades | {"site", "depth", "angle", "inclusion"}
    assert page.faults == []


def test_fingers_move_the_rod_and_the_view(page: Any) -> None:
    """On a phone one finger on the block moves the indenter; two rotate and zoom the view only."""
    screen = page.context.new_cdp_session(page)
    box = page.locator("#picture").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.55

    def touch(kind: str, *fingers: float) -> None:
        """Fingers at these distances to the right of the picture's centre [pixels]."""
        points = [{"x": middle[0] + x, "y": middle[1], "id": k} for k, x in enumerate(fingers)]
        screen.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": points})

    def state() -> tuple[list[float], float]:
        """Contact point (x, y) and distance of the camera."""
        x, y, away = page.evaluate(
            "async () => { const t = await tisim;"
            " while (t.awake || t.asked) await new Promise((r) => setTimeout(r, 5));"
            " return [t.poke.x, t.poke.y, t.view.camera.position.length()]; }"
        )
        return [x, y], away

    touch("Start", 0)
    place, away = state()
    touch("Move", 25)
    touch("Move", 50)
    touch("End")  # a browser may delay a move until the next frame, but not beyond the end
    moved, still = state()
    assert moved[0] > place[0] + 5.0
    assert still == away

    touch("Start", -20)
    assert state()[0] != moved
    touch("Start", -20, 20)
    for spread in (30, 40, 50, 60):
        touch("Move", -spread, spread)
    pinched, nearer = state()
    touch("Move", 60)
    touch("End")
    assert pinched == moved
    assert nearer < 0.9 * away

    touch("Start", 0)
    touch("Cancel")
    touch("Start", -40)
    assert state()[0][0] < 0.0
    touch("End")
    assert page.faults == []


def test_it_is_readable(page: Any) -> None:
    """Controls have names, the force is announced, contrast suffices, a phone needs no lateral scrolling."""
    nameless = page.evaluate(
        "() => [...document.querySelectorAll('input, select, button, canvas')]"
        ".filter((e) => !(e.labels?.length || e.textContent.trim() || e.ariaLabel)).map((e) => e.id)"
    )
    assert nameless == []
    assert page.locator("[aria-live=polite]").count() == 2
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.evaluate("document.documentElement.lang") == "en"
    contrast = page.evaluate(CONTRAST)
    assert contrast, "no text was measured"
    assert min(contrast.values()) >= 4.5, min(contrast.items(), key=lambda item: item[1])


def test_the_picture_and_the_time_of_a_frame(
    page: Any, tmp_path: Path, record_property: pytest.RecordProperty
) -> None:
    """The screenshot is not blank, the median time is recorded, and no error occurred."""
    from PIL import Image

    shot = page.locator("#picture").screenshot(path=tmp_path / "poke.png")
    colours = Image.open(io.BytesIO(shot)).convert("RGB").getcolors(maxcolors=1 << 20)
    assert colours is not None
    assert len(colours) > 500
    times = page.evaluate("""async () => {
      const t = await tisim;
      t.times.length = 0;
      while (t.times.length < 10) {
        t.change({ x: t.poke.x === 5 ? 6 : 5 });
        await new Promise((r) => setTimeout(r, 5));
      }
      return t.times;
    }""")
    for name in ("inference", "whole"):
        median = statistics.median(frame[name] for frame in times)
        record_property(f"median_{name}_ms", median)
        print(f"median of {len(times)} frames, {name}: {median:.1f} ms")
    assert page.faults == []
