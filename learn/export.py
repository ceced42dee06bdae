"""`python -m learn.export RUN`: ONNX files of a run, checked against torch."""

from __future__ import annotations

import importlib
import json
import logging
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import torch
import typer
from torch import Tensor, nn

from learn._export_cegnn import INPUTS, CegnnPart, difference, example, in_double
from learn._screen import make_console, plain_errors
from learn.data import MemoryDataset, open_store
from learn.errors import InputError
from learn.evaluation import split_of
from learn.models import Pokes, Scene, Surrogate, pokes_of, scene_of
from learn.models._geometry import Encoded
from learn.models._stencil import Stencil, gathered
from learn.models.cegnn import Cegnn
from learn.training import Run, load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

TOLERANCE = 1e-5  # of the largest displacement of a poke, and of its force
_CHECKED = 8  # pokes

EXAMPLES = """
[bold]Example[/bold]

  python -m learn.export runs/fast-ours-ogden-0-0 --out surrogate

encoder.onnx: rigid (n, levels) -> code, vectors, clear: once an interior.
poke.onnx: code, vectors, clear, start, direction, depth, modulus -> displacement, force. SI units.
Of the paper's model, in double precision, poke.onnx alone: profile (n, levels), start, direction, depth.
model.json: the points, the rod, and what it was trained on.

Exit codes: 0 written and checked, 2 bad input or a check that failed.
"""


class PokePart(nn.Module):
    """`Surrogate.decode` of one poke with plain tensors in and out, for a fixed cloud."""

    def __init__(self, model: Surrogate, scene: Scene, stencils: tuple[Stencil, ...]) -> None:
        super().__init__()
        self.model, self.scene, self.stencils = model, scene, stencils

    def forward(
        self, code: Tensor, vectors: Tensor, clear: Tensor, start: Tensor, direction: Tensor, depth: Tensor,
        modulus: Tensor,
    ) -> tuple[Tensor, Tensor]:  # fmt: skip
        scene = replace(self.scene, rigid_index=torch.zeros(1, dtype=torch.int64))
        encoded = Encoded(scene, self.stencils, code, vectors, clear)
        pokes = Pokes(
            geometry=torch.zeros(1, dtype=torch.int64),
            start=start[None],
            direction=direction[None],
            depth=depth[None],
            modulus=modulus[None],
        )
        found = self.model.decode(encoded, pokes)
        return found.displacement[0], found.force[0]


class EncoderPart(nn.Module):
    """`Surrogate.encode` of one interior with plain tensors in and out."""

    def __init__(self, model: Surrogate, scene: Scene, stencils: tuple[Stencil, ...]) -> None:
        super().__init__()
        self.model, self.scene, self.stencils = model, scene, stencils

    def forward(self, rigid: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        encoded = self.model.encode(replace(self.scene, rigid=rigid[None]), self.stencils)
        return encoded.code, encoded.vectors, encoded.clear


def export(run: Run, scene: Scene, folder: Path) -> dict[str, Path]:
    """Writes poke.onnx, and encoder.onnx for ours, for a scene's cloud; InputError without the packages."""
    for name in ("onnx", "onnxscript", "onnxruntime"):
        try:
            importlib.import_module(name)
        except ImportError:
            raise InputError(f"learn.export needs the package {name}, which is not installed") from None
    folder.mkdir(parents=True, exist_ok=True)
    if isinstance(run.model, Cegnn):
        files = {"poke": folder / "poke.onnx"}
        part = CegnnPart(in_double(run.model), scene)
        _write(part, example(scene), files["poke"], INPUTS, ["displacement", "force"])
        return files
    assert isinstance(run.model, Surrogate)
    sparse = run.model.prepare(scene)
    stencils = tuple(gathered(s) for s in sparse)
    one = replace(scene, rigid=scene.rigid[:1], rigid_index=torch.zeros(1, dtype=torch.int64))
    with torch.no_grad():
        encoded = run.model.encode(one, stencils)
    files = {"encoder": folder / "encoder.onnx", "poke": folder / "poke.onnx"}
    _write(
        EncoderPart(run.model, one, stencils), (one.rigid[0],), files["encoder"],
        ["rigid"], ["code", "vectors", "clear"],
    )  # fmt: skip
    vector = torch.tensor([0.0, 0.0, -1.0], dtype=torch.float64)
    scalar = torch.tensor(5e-3, dtype=torch.float64)
    start = scene.points.mean(dim=0)
    _write(
        PokePart(run.model, one, stencils),
        (encoded.code, encoded.vectors, encoded.clear, start, vector, scalar, scalar * 2e6),
        files["poke"],
        ["code", "vectors", "clear", "start", "direction", "depth", "modulus"],
        ["displacement", "force"],
    )
    return files


def _write(part: nn.Module, inputs: tuple[Tensor, ...], path: Path, names: list[str], out: list[str]) -> None:
    logging.getLogger("torch.onnx").setLevel(logging.ERROR)  # it tells of packages that nothing here needs
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the exporter warns of its own future
        torch.onnx.export(
            part.eval(), inputs, str(path), input_names=names, output_names=out, dynamo=True,
            external_data=False, verbose=False,
        )  # fmt: skip


def _session(path: Path, *, threads: int = 1) -> Any:
    runtime: Any = importlib.import_module("onnxruntime")
    options = runtime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    return runtime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])


class OnnxSurrogate:
    """The exported files, run by onnxruntime."""

    def __init__(self, folder: Path, *, threads: int = 1) -> None:
        self._encoder, self._poke = (
            _session(folder / name, threads=threads) for name in ("encoder.onnx", "poke.onnx")
        )

    def encode(self, rigid: Tensor) -> dict[str, Any]:
        """Once an interior; rigid (n, levels)."""
        code, vectors, clear = self._encoder.run(None, {"rigid": rigid.numpy()})
        return {"code": code, "vectors": vectors, "clear": clear}

    def poke(self, encoded: dict[str, Any], pokes: Pokes, k: int) -> tuple[Any, Any]:
        """Displacement (n, 3) [m] and force [N] of the k-th poke."""
        rod = {name: getattr(pokes, name)[k].numpy() for name in ("start", "direction", "depth", "modulus")}
        displacement, force = self._poke.run(None, {**encoded, **rod})
        return displacement, force


def largest_difference(folder: Path, run: Run, scene: Scene, pokes: Pokes) -> float:
    """Of the files in a folder from torch, relative to each poke's largest displacement, and to its force."""
    if isinstance(run.model, Cegnn):
        return difference(_session(folder / "poke.onnx"), run.model, scene, pokes)
    onnx = OnnxSurrogate(folder)
    with torch.no_grad():
        found = run.model(scene, pokes)
    worst = 0.0
    for k in range(len(pokes.depth)):
        rigid = scene.rigid[scene.rigid_index[pokes.geometry[k]]]
        u, force = onnx.poke(onnx.encode(rigid), pokes, k)
        truth = found.displacement[k].numpy()
        worst = max(worst, float(np.abs(u - truth).max() / np.linalg.norm(truth, axis=1).max()))
        worst = max(worst, abs(float(force) / float(found.force[k]) - 1))
    return worst


@app.command(epilog=EXAMPLES)
def main(
    run: Annotated[Path, typer.Argument(help="Folder of a run.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    out: Annotated[Path | None, typer.Option(help="Default: onnx/ in the run.")] = None,
) -> None:
    """Writes a run as ONNX for the dataset's grid and checks it on test pokes."""
    console = make_console()
    with plain_errors():
        loaded = load_run(run)
        store = open_store(dataset or loaded.location, verify=False)
        if loaded.uuid != store.uuid:
            raise InputError(f"{run}: trained on dataset {loaded.uuid}, but {store.location} is {store.uuid}")
        scene, folder = scene_of(store), out or run / "onnx"
        test = MemoryDataset(store, split_of(store, loaded.recipe).test)
        files = export(loaded, scene, folder)
        some = np.linspace(0, len(test) - 1, min(_CHECKED, len(test))).astype(int)
        wrong = largest_difference(folder, loaded, scene, pokes_of(test.__getitems__(some)))
        if not wrong <= TOLERANCE:
            for path in files.values():
                path.unlink()
            raise InputError(
                f"{folder}: ONNX is {wrong:.1e} off torch, more than {TOLERANCE:g}; files removed"
            )
        about = {
            "uuid": loaded.uuid,
            "law": loaded.law,
            "rod_radius_m": scene.rod_radius,
            "difference_from_torch": wrong,
            "points_m": scene.points.tolist(),
        }
        (folder / "model.json").write_text(json.dumps(about) + "\n", encoding="utf-8")
    console.print(
        f"{', '.join(str(path) for path in files.values())} and model.json; "
        f"{wrong:.1e} off torch over {len(some)} pokes"
    )


if __name__ == "__main__":
    app()
