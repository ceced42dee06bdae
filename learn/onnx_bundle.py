"""A run as ONNX files, checked against torch.

invariant-gnn: `encoder.onnx`, once per interior: rigid (n, levels) -> code, vectors, clear, layers.
`poke.onnx`: these four, start, direction, depth, modulus -> displacement, force. SI units. A model trained
with time also takes `clock`: time since contact [s], the indenter's speed and its speed of approach [m/s].

cegnn: `poke.onnx` alone: profile (n, levels), start, direction, depth -> displacement, force. It searches
neighbours in each layer, and its output jumps where they change: in single precision the rounding of another
runtime causes this somewhere on a grid of a thousand points. In double precision both runtimes find the same
neighbours, so that the files, and the model that they are checked against, are in double precision.

`model.json` holds the points, the indenter and the domain of validity: the files give no warning outside it.
"""

from __future__ import annotations

import copy
import importlib
import json
import logging
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from learn.data import Store, split_of_run
from learn.data.loaders import no_clock, without_fields
from learn.errors import InputError
from learn.models import Cegnn, InvariantGnn, Pokes, Scene, Scenes, pokes_of
from learn.models._encoder import Encoded, Stencil, gathered
from learn.training import Run
from learn.validity import Domain

FILES = ("encoder.onnx", "poke.onnx", "model.json")  # of invariant-gnn
TOLERANCE = 1e-5  # relative to the largest displacement of a poke, and to its force
_CHECKED = 8  # pokes
CLOCK = ["time_s", "rod_speed_m_per_s", "approach_speed_m_per_s"]  # in this order
INTERIOR = ["code", "vectors", "clear", "layers"]  # of `Encoded`
ROD = ["start", "direction", "depth", "modulus"]  # of invariant-gnn
INPUTS = ["profile", "start", "direction", "depth"]  # of cegnn


class PokePart(nn.Module):
    """`InvariantGnn.decode` of one poke with plain tensors as inputs and outputs, for a fixed cloud."""

    def __init__(self, model: InvariantGnn, scene: Scene, stencils: tuple[Stencil, ...]) -> None:
        super().__init__()
        self.model, self.scene, self.stencils = model, scene, stencils

    def forward(
        self, code: Tensor, vectors: Tensor, clear: Tensor, layers: Tensor, start: Tensor, direction: Tensor,
        depth: Tensor, modulus: Tensor, clock: Tensor | None = None,
    ) -> tuple[Tensor, Tensor]:  # fmt: skip
        scene = replace(self.scene, rigid_index=torch.zeros(1, dtype=torch.int64))
        encoded = Encoded(scene, self.stencils, code, vectors, clear, layers)
        pokes = Pokes(
            geometry=torch.zeros(1, dtype=torch.int64),
            start=start[None],
            direction=direction[None],
            depth=depth[None],
            modulus=modulus[None],
            clock=no_clock() if clock is None else clock[None],
        )
        found = self.model.decode(encoded, pokes)
        return found.displacement[0], found.force[0]


class EncoderPart(nn.Module):
    """`InvariantGnn.encode` of one interior with plain tensors as inputs and outputs."""

    def __init__(self, model: InvariantGnn, scene: Scene, stencils: tuple[Stencil, ...]) -> None:
        super().__init__()
        self.model, self.scene, self.stencils = model, scene, stencils

    def forward(self, rigid: Tensor) -> tuple[Tensor, ...]:
        encoded = self.model.encode(replace(self.scene, rigid=rigid[None]), self.stencils)
        return tuple(getattr(encoded, name) for name in INTERIOR)


def export(run: Run, scene: Scene, folder: Path) -> dict[str, Path]:
    """Write poke.onnx, and encoder.onnx for invariant-gnn, for a scene's cloud.

    InputError if a package is missing, or the model has no export.
    """
    model = _exportable(run)
    folder.mkdir(parents=True, exist_ok=True)
    if isinstance(model, Cegnn):
        files = {"poke": folder / "poke.onnx"}
        part = CegnnPart(_in_double(model), scene)
        write_graph(part, _example(scene), files["poke"], INPUTS, ["displacement", "force"])
        return files
    sparse = model.prepare(scene)
    stencils = tuple(gathered(s) for s in sparse)
    one = replace(scene, rigid=scene.rigid[:1], rigid_index=torch.zeros(1, dtype=torch.int64))
    with torch.no_grad():
        encoded = model.encode(one, stencils)
    files = {"encoder": folder / "encoder.onnx", "poke": folder / "poke.onnx"}
    write_graph(
        EncoderPart(model, one, stencils), (one.rigid[0],), files["encoder"],
        ["rigid"], INTERIOR,
    )  # fmt: skip
    vector = torch.tensor([0.0, 0.0, -1.0], dtype=torch.float64)
    scalar = torch.tensor(5e-3, dtype=torch.float64)
    start = scene.points.mean(dim=0)
    names = [*INTERIOR, *ROD]
    inputs = [*(getattr(encoded, name) for name in INTERIOR), start, vector, scalar, scalar * 2e6]
    if model.takes_clock:
        names.append("clock")
        inputs.append(torch.tensor([1.0, 2e-3, 2e-3], dtype=torch.float64))
    write_graph(
        PokePart(model, one, stencils), tuple(inputs), files["poke"], names, ["displacement", "force"]
    )
    return files


def _exportable(run: Run) -> Cegnn | InvariantGnn:
    """The run's model; InputError if it has no export, or a package is missing."""
    need_packages()
    if not isinstance(run.model, Cegnn | InvariantGnn):
        raise InputError(f"{run.folder}: model {run.recipe.model} has no ONNX export")
    return run.model


def write_graph(
    part: nn.Module,
    inputs: tuple[Tensor, ...],
    path: Path,
    names: list[str],
    out: list[str],
    *,
    simplify: bool = True,
) -> None:
    """Write a module as an ONNX file, with names of its inputs and outputs.

    `simplify` folds constants, which onnxruntime also does when it loads the file.
    """
    logging.getLogger("torch.onnx").setLevel(logging.ERROR)  # it warns of packages that are not needed here
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # deprecation warnings of the exporter
        torch.onnx.export(
            part.eval(), inputs, str(path), input_names=names, output_names=out, dynamo=True,
            external_data=False, verbose=False, optimize=simplify,
            custom_translation_table={torch.ops.aten.scalar_tensor.default: _whole_number()},
        )  # fmt: skip


def _whole_number() -> Any:
    """Translation of a Python number in an expression with a tensor, at the tensor's precision.

    The exporter itself writes single precision and a cast, which loses half of the digits of numbers next to
    double tensors.
    """
    onnx, script = _package("onnx"), _package("onnxscript")
    kinds = {int(onnx.TensorProto.FLOAT): np.float32, int(onnx.TensorProto.DOUBLE): np.float64}

    def scalar_tensor(s: float, dtype: int = 1, **_where: Any) -> Any:
        op = script.opset18
        if dtype not in kinds:
            return op.Cast(s, to=dtype)
        return op.Constant(value=onnx.numpy_helper.from_array(np.array(s, dtype=kinds[dtype])))

    return scalar_tensor


def need_packages() -> None:
    """Raise InputError if a package that the export needs is missing."""
    for name in ("onnx", "onnxscript", "onnxruntime"):
        _package(name)


def _package(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(
            f"learn.export needs the package {name}, which is not installed: pip install 'tisim[export]'"
        ) from None


def _session(path: Path, *, threads: int = 1) -> Any:
    runtime = _package("onnxruntime")
    options = runtime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    try:
        return runtime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime raises kinds of its own
        text = " ".join(str(error).split())[:120]
        raise InputError(f"{path}: not a readable ONNX file ({text}): learn.export writes it again") from None


def bundle_in(folder: Path) -> bool:
    """True if a folder has all files of an export of invariant-gnn, False if it has none; else InputError."""
    missing = [name for name in FILES if not (folder / name).is_file()]
    if missing and len(missing) < len(FILES):
        raise InputError(
            f"{folder}: expected {', '.join(FILES)}, {missing[0]} is missing: learn.export writes them again"
        )
    return not missing


class OnnxBundle:
    """The exported files, run by onnxruntime."""

    def __init__(self, folder: Path, *, threads: int = 1) -> None:
        self._encoder, self._poke = (
            _session(folder / name, threads=threads) for name in ("encoder.onnx", "poke.onnx")
        )

    def encode(self, rigid: Tensor) -> dict[str, Any]:
        """Encode an interior, `rigid` (n, levels)."""
        return dict(zip(INTERIOR, self._encoder.run(None, {"rigid": rigid.numpy()}), strict=True))

    def poke(self, encoded: dict[str, Any], pokes: Pokes, k: int) -> tuple[Any, Any]:
        """Displacement (n, 3) [m] and force [N] of the k-th poke."""
        known = {node.name for node in self._poke.get_inputs()}
        rod = {name: getattr(pokes, name)[k].numpy() for name in (*ROD, "clock") if name in known}
        displacement, force = self._poke.run(None, {**encoded, **rod})
        return displacement, force


def largest_difference(folder: Path, run: Run, scene: Scene, pokes: Pokes) -> float:
    """Largest difference from torch, relative to each poke's largest displacement or to its force."""
    if isinstance(run.model, Cegnn):
        return _cegnn_difference(_session(folder / "poke.onnx"), run.model, scene, pokes)
    onnx = OnnxBundle(folder)
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


def write_bundle(
    run: Run, store: Store, folder: Path, domain: Domain | None, *, shape: str | None = None
) -> tuple[list[Path], float, int]:
    """Write a run for a grid of the dataset, checked on test pokes; an earlier export is replaced as a whole.

    The grid is that of the block in which `shape` stands, and the check is on test pokes in this block, or on
    any if none is of the test part. Without `shape`, that of the only block.

    Returns
    -------
    The files, the largest relative difference from torch, and the number of pokes checked. InputError if
    the difference is above `TOLERANCE`; the folder is then as it was.
    """
    if shape is not None and shape not in store.shapes:
        raise InputError(f"--shape {shape}: expected one of {', '.join(store.shapes)}")
    number = store.setup_under(None if shape is None else [shape])
    scenes = Scenes.of(store)
    scene, here = scenes.scenes[number], store.setup_index[store.geometry[store.frame_poke]] == number
    rows = split_of_run(store, run).test
    rows = rows[here[rows]] if here[rows].any() else np.flatnonzero(here & store.presses)
    some = np.linspace(0, len(rows) - 1, min(_CHECKED, len(rows))).astype(int)
    [(_, _, checked)] = scenes.parts(pokes_of(without_fields(store, rows[some])))
    _exportable(run)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".export-", dir=folder) as part:
        files, wrong = _write_parts(run, scene, checked, domain, Path(part))
        for name in reversed(FILES):  # a folder without model.json is seen to be incomplete
            (folder / name).unlink(missing_ok=True)
        for path in files:
            path.replace(folder / path.name)
    return [folder / path.name for path in files[:-1]], wrong, len(some)


def _write_parts(
    run: Run, scene: Scene, checked: Pokes, domain: Domain | None, folder: Path
) -> tuple[list[Path], float]:
    """Write the files, model.json last, and check them; these, and the largest difference from torch."""
    files = export(run, scene, folder)
    wrong = largest_difference(folder, run, scene, checked)
    if not wrong <= TOLERANCE:
        raise InputError(
            f"{run.folder}: its ONNX is {wrong:.1e} off torch, more than {TOLERANCE:g}; nothing was written"
        )
    about = {
        "uuid": run.uuid,
        "law": run.law,
        "model": run.recipe.model,
        "rod_radius_m": scene.rod_radius,
        "rod_edge_m": scene.rod_edge,
        "difference_from_torch": wrong,
        "domain": None if domain is None else domain.model_dump(mode="json"),
        "points_m": scene.points.tolist(),
    }
    if run.model.takes_clock:
        about["clock"] = CLOCK
    (folder / "model.json").write_text(json.dumps(about) + "\n", encoding="utf-8")
    return [*files.values(), folder / "model.json"], wrong


class CegnnPart(nn.Module):
    """`Cegnn` of one poke with plain tensors as inputs and outputs, for a fixed cloud."""

    def __init__(self, model: Cegnn, scene: Scene) -> None:
        super().__init__()
        self.model, self.scene = model, scene

    def forward(
        self, profile: Tensor, start: Tensor, direction: Tensor, depth: Tensor
    ) -> tuple[Tensor, Tensor]:
        scene = replace(self.scene, profile=profile[None])
        pokes = Pokes(
            geometry=torch.zeros(1, dtype=torch.int64),
            start=start[None],
            direction=direction[None],
            depth=depth[None],
            modulus=torch.ones(1, dtype=torch.float64),  # the profile's codes hold the softness
        )
        found = self.model.decode(self.model.encode(scene), pokes)
        return found.displacement[0], found.force[0]


def _in_double(model: Cegnn) -> Cegnn:
    """The model with its weights in double precision."""
    return copy.deepcopy(model).double().eval()


def _example(scene: Scene) -> tuple[Tensor, ...]:
    """Example inputs of one poke."""
    down = torch.tensor([0.0, 0.0, -1.0], dtype=torch.float64)
    return scene.profile[0], scene.points.mean(dim=0), down, torch.tensor(5e-3, dtype=torch.float64)


def _cegnn_difference(session: Any, model: Cegnn, scene: Scene, pokes: Pokes) -> float:
    """`largest_difference` for cegnn, against torch in double precision."""
    with torch.no_grad():
        found = _in_double(model)(scene, pokes)
    worst = 0.0
    for k in range(len(pokes.depth)):
        rod = {name: getattr(pokes, name)[k].numpy() for name in INPUTS[1:]}
        u, force = session.run(None, {"profile": scene.profile[pokes.geometry[k]].numpy(), **rod})
        truth = found.displacement[k].numpy()
        worst = max(worst, float(np.abs(u - truth).max() / np.linalg.norm(truth, axis=1).max()))
        worst = max(worst, abs(float(force) / float(found.force[k]) - 1))
    return worst
