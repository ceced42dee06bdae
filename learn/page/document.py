"""Write a page's content as one self-contained HTML file: script, network, arrays and onnxruntime.

The data of the run (`Parts`) are a tenth of it, and can be saved to make the page later.

The script and onnxruntime's WebAssembly come from `bundle/`, made by `js/build.mjs` and shipped with the
package. Large members are gzipped and base64-encoded; the browser unpacks them.
"""

from __future__ import annotations

import base64
import functools
import gzip
import io
import json
import lzma
import tempfile
import zipfile
import zlib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import torch
from jinja2 import Environment, StrictUndefined
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from learn._yaml import first_fault
from learn.errors import InputError
from learn.page import controls
from learn.page.content import Content, content_of
from learn.page.graph import write_page_graph
from learn.predictor import Predictor
from learn.training.run_folder import write_whole
from learn.verdict import words

LARGEST = 10e6  # bytes of the gzipped file
_MEMBERS = ("page.json", "arrays.bin", "poke.onnx")
_SLIDERS = {
    "depth": "Depth",
    "x": "Contact point x",
    "y": "Contact point y",
    "angle": "Angle from the vertical",
    "heading": "Heading",
    "modulus": "Shear modulus",
}


@dataclass(frozen=True, kw_only=True)
class Written:
    """A written page: file, size and gzipped size [bytes], numbers of interiors and of simulated pokes."""

    path: Path
    size: int
    gzipped: int
    interiors: int
    pokes: int


class _Halo(BaseModel):
    low: float
    high: float


class _Block(BaseModel):
    size: tuple[float, float, float]
    middle: tuple[float, float]


class _Rod(BaseModel):
    radius: float


class _Row(BaseModel):
    trained: str


class _About(BaseModel):
    """The description for the script: keys that it has to have, and the form of those that are read here."""

    arrays: dict[str, Any]
    block: _Block
    checks: list[_Row]
    grid: int
    halo: _Halo | None
    interior_inputs: list[str]
    interiors: Annotated[list[dict[str, Any]], Field(min_length=1)]
    levels: int
    rod: _Rod
    simulated: list[dict[str, Any]]
    sliders: dict[str, Any]
    softness: list[dict[str, Any]]
    start: dict[str, Any]


class _Described(BaseModel):
    about: _About


class _Stated(BaseModel):
    """Texts of a page, and its description for the script: `page.json` of the parts' zip."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[1] = 1  # of `about` and the arrays, raised where the script expects others
    title: str
    lead: str
    notes: tuple[str, ...]
    about: dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Parts:
    """Data of a page that depend on its run; the package adds the script and onnxruntime.

    Attributes
    ----------
    title, lead, notes : texts.
    about : description for the script, with the offset of each array.
    arrays, graph : bytes of the arrays, and of the network (ONNX).
    """

    title: str
    lead: str
    notes: tuple[str, ...]
    about: dict[str, Any]
    arrays: bytes
    graph: bytes

    def save(self, path: Path) -> None:
        """Write the parts as one zip, of a megabyte or two, that `load` reads."""
        stated = _Stated(title=self.title, lead=self.lead, notes=self.notes, about=self.about)
        path.parent.mkdir(parents=True, exist_ok=True)
        whole = io.BytesIO()
        with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as file:
            members = stated.model_dump_json(indent=1).encode(), self.arrays, self.graph
            for name, content in zip(_MEMBERS, members, strict=True):
                file.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), content, zipfile.ZIP_DEFLATED)
        write_whole(path, whole.getvalue())

    @staticmethod
    def load(path: Path) -> Parts:
        """Read the zip that `save` wrote; InputError if the file is not one."""
        if not path.exists():
            raise InputError(f"{path}: no such file, expected the parts of a page (learn.page --parts)")
        try:
            with zipfile.ZipFile(path) as file:
                text, arrays, graph = (file.read(name) for name in _MEMBERS)
            stated = _Stated.model_validate_json(text)
            _Described.model_validate_json(text)
        except ValidationError as error:
            raise InputError(f"{path}: page.json: {first_fault(error)}") from None
        except (OSError, KeyError, RuntimeError, zipfile.BadZipFile, zlib.error, EOFError) as error:
            raise InputError(
                f"{path}: expected the parts of a page, as learn.page --parts writes them ({error})"
            ) from None
        texts = {name: value for name, value in stated if name != "format"}
        return Parts(**texts, arrays=arrays, graph=graph)

    def write(self, path: Path) -> Written:
        """Write the page; InputError if it is larger than `LARGEST`."""
        text = _html(self).encode()
        gzipped = len(gzip.compress(text, 6))
        interiors, shown = self.about["interiors"], self.about["simulated"]
        if gzipped > LARGEST:
            raise InputError(
                f"{path}: {gzipped / 1e6:.1f} MB gzipped, more than {LARGEST / 1e6:.0f}: choose fewer of the "
                f"{len(interiors) - 1} inclusions with --shape, or fewer --pokes"
            )
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, text)
        return Written(path=path, size=len(text), gzipped=gzipped, interiors=len(interiors), pokes=len(shown))


def parts_of(predictor: Predictor, *, shapes: list[str] | None = None, pokes: int = 4) -> Parts:
    """The parts of a run's page.

    Parameters
    ----------
    predictor : predictor of one run of invariant-gnn or invariant-gnn-small, trained without time.
    shapes, pokes : see `learn.page.content.content_of`.

    Raises
    ------
    InputError
        If the model or a shape has no page, or a package is missing.
    """
    content = content_of(predictor, shapes=shapes, pokes=pokes)
    with tempfile.TemporaryDirectory() as folder:
        graph = Path(folder) / "poke.onnx"
        write_page_graph(content.graph, content.inputs[0], graph)
        network = graph.read_bytes()
    content.about["halo"] = _halo(content)
    about, arrays = content.packed()
    return Parts(
        title="Poke the block",
        lead=_lead(predictor, content),
        notes=tuple(_notes(predictor, content)),
        about=about,
        arrays=arrays,
        graph=network,
    )


def write_page(
    predictor: Predictor, path: Path, *, shapes: list[str] | None = None, pokes: int = 4
) -> Written:
    """Write a run's live page (`parts_of`) to an HTML file."""
    return parts_of(predictor, shapes=shapes, pokes=pokes).write(path)


def _html(page: Parts) -> str:
    here = files("learn.page")
    bundle, template = here / "bundle", here / "template"
    about = {
        **page.about,
        "checks": controls.with_units(page.about["checks"]),
        "refusals": controls.refusals(page.about["block"], page.about["rod"]),
        "words": words(),
    }
    parts = {
        "about": json.dumps(about, allow_nan=False).encode(),
        "arrays": page.arrays,
        "graph": page.graph,
    }
    script = (bundle / "page.js").read_text(encoding="utf-8")
    if "</script" in script.lower():
        raise InputError("learn/page/bundle/page.js: ends its own element; build it again")
    halo = page.about["halo"]
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    source = (template / "page.html").read_text(encoding="utf-8")
    return environment.from_string(source).render(
        title=page.title,
        lead=page.lead,
        style=(template / "page.css").read_text(encoding="utf-8"),
        script=script,
        sliders=[{"key": key, "label": label} for key, label in _SLIDERS.items()],
        halo=halo and [f"{halo['low']:g}", f"{halo['high']:g}"],
        checks=bool(page.about["checks"]),
        about=page.notes,
        parts=[*((name, _packed(raw)) for name, raw in parts.items()), ("wasm", _wasm())],
    )


@functools.cache
def _wasm() -> str:
    """WebAssembly of onnxruntime, packed: once in a process, since it takes a second."""
    whole = lzma.decompress((files("learn.page") / "bundle" / "onnxruntime.wasm.xz").read_bytes())
    return _packed(whole)


def _packed(raw: bytes) -> str:
    return base64.b64encode(gzip.compress(raw, 6, mtime=0)).decode()


def _lead(predictor: Predictor, content: Content) -> str:
    run, store = predictor.run, predictor.store
    length, width, height = content.about["block"]["size"]
    return (
        f"{length:.0f} x {width:.0f} x {height:.0f} mm of soft tissue (law {store.law}) with a rigid "
        f"inclusion, and an indenter of {2e3 * store.rod_radius:g} mm diameter. The surrogate "
        f"{run.recipe.model} predicts in this browser."
    )


def _notes(predictor: Predictor, content: Content) -> list[str]:
    run, store = predictor.run, predictor.store
    bundle = json.loads((files("learn.page") / "bundle" / "bundle.json").read_text(encoding="utf-8"))
    versions = bundle["versions"]
    lines = [
        f"Model {run.recipe.model}, epoch {run.epoch} of {run.recipe.epochs}, trained on "
        f"{run.statistics.frames} frames of dataset {store.uuid} ({store.law}, {int(store.done.sum())} "
        "simulated pokes).",
        f"The network predicts {store.n_points} points. Between them the drawn surface is interpolated; "
        "points inside the indenter are drawn on its surface. Inclusions are drawn as the network "
        "represents them, in columns.",
    ]
    if predictor.intervals is not None:
        level = predictor.intervals.level
        lines.append(
            f"Intervals: conformal at {100 * level:.0f} %, from {predictor.intervals.pokes} pokes; "
            "calibrated inside the trained ranges; wider, and not calibrated, outside."
        )
    steps = [step for poke in content.about["simulated"] for step in poke["steps"]]
    if steps:
        lines.append(
            "FEM pokes are of the test part, on which the model was not trained. Their displacements have "
            f"steps of {max(steps) * 1e6:.2g} \N{MICRO SIGN}m or less (16 bits)."
        )
    lines.append(
        "The page needs neither server nor network connection: onnxruntime-web "
        f"{versions['onnxruntime-web']} (Microsoft, MIT licence) and "
        f"three.js {versions['three']} (three.js authors, MIT licence) are inside this file."
    )
    return lines


def _halo(content: Content) -> dict[str, float] | None:
    """Ends of the halo's scale [mm]: median and largest interval radius of the pokes shown, rounded."""
    part = content.graph
    if part.intervals is None:
        return None
    pokes = [{**shown["poke"], "depth": shown["depths"][-1]} for shown in content.about["simulated"]]
    radii = []
    for poke in pokes or [content.about["start"]]:
        found = dict(zip(part.outputs(), _ask(content, poke), strict=True))
        radii.append(found["radius"].numpy() * 1e3)
    every = np.concatenate(radii)
    low, high = _round(float(np.median(every))), _round(float(every.max()))
    return {"low": low, "high": high if high > low else 10 * low}


@torch.no_grad()
def _ask(content: Content, poke: dict[str, Any]) -> tuple[torch.Tensor, ...]:
    turn = np.pi / 180
    values = [poke["x"] * 1e-3, poke["y"] * 1e-3, poke["angle"] * turn, poke["heading"] * turn]
    values += [poke["depth"] * 1e-3, poke["modulus"] * 1e3]
    inputs = content.inputs[poke["interior"]]
    answer: tuple[torch.Tensor, ...] = content.graph(
        torch.tensor(values, dtype=torch.float64), *(torch.from_numpy(array) for array in inputs.values())
    )
    return answer


def _round(value: float) -> float:
    """Round to one significant digit."""
    return float(f"{value:.0e}")
