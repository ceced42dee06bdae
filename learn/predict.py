"""`python -m learn.predict RUN SCENE`: a poke in; displacement, force, uncertainty and a picture out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import torch
import typer
from numpy.typing import NDArray

from learn._screen import make_console, plain_errors
from learn.data import Store, open_store
from learn.errors import InputError
from learn.evaluation import load_intervals, together
from learn.metrics import Cases
from learn.models import Pokes, Prediction
from learn.scene_file import load_poke, scene_and_poke
from learn.training import Run, load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Example[/bold]

  python -m learn.predict runs/fast-ours-ogden-0-0 poke.yaml --out poke

Runs of several seeds as one, the mean of their answers:

  python -m learn.predict runs/fast-ours-ogden-0-0 runs/fast-ours-ogden-0-1 poke.yaml

with poke.yaml, for instance:

  site_mm: [5, -10]
  depth_mm: 8
  angle_deg: 20
  heading_deg: 45
  shape: cube-18            # or inclusion: {kind: sphere, radius_mm: 8, centre_mm: [0, 0, 6]}
  softness: S0.5            # or shear_modulus_kPa: 12

Exit codes: 0 done, 2 bad input.
"""


@app.command(epilog=EXAMPLES)
def main(
    runs: Annotated[
        list[Path], typer.Argument(help="Folder of a run, or of several to be joined.", metavar="RUN...")
    ],
    scene: Annotated[Path, typer.Argument(help="A YAML file: the poke.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    out: Annotated[
        Path, typer.Option(help="Folder for displacement.csv, prediction.json and the picture.")
    ] = Path("prediction"),
) -> None:
    """Predicts one poke on the dataset's block."""
    console = make_console()
    with plain_errors():
        loaded = _loaded(runs)
        store = open_store(dataset or loaded.location, verify=False)
        if loaded.uuid != store.uuid:
            raise InputError(
                f"{runs[0]}: trained on dataset {loaded.uuid}, but {store.location} is {store.uuid}"
            )
        file = load_poke(scene)
        if not loaded.recipe.model.startswith("ours") and (
            file.inclusion is not None or file.shear_modulus_kPa is not None
        ):
            raise InputError(
                f"{scene}: model {loaded.recipe.model} knows the dataset's shapes and softness alone"
            )
        about, pokes = scene_and_poke(file, store, scene)
        with torch.no_grad():
            found = loaded.model(about, pokes)
        u, force = found.displacement[0].numpy(), float(found.force[0])
        radius, factor = _uncertainty(loaded, store, found, pokes)
        out.mkdir(parents=True, exist_ok=True)
        _write_csv(out / "displacement.csv", store, u, radius)
        answer = {"force_N": force, "largest_displacement_mm": float(np.linalg.norm(u, axis=1).max() * 1e3)}
        if radius is not None and factor is not None:
            answer |= {"force_low_N": force / factor, "force_high_N": force * factor}
            answer |= {"radius_mean_mm": float(radius.mean()), "radius_max_mm": float(radius.max())}
        (out / "prediction.json").write_text(json.dumps(answer, indent=1) + "\n", encoding="utf-8")
        _draw(out / "prediction.png", store, u, radius, f"force {force:.3f} N")
    for key, value in answer.items():
        console.print(f"{key}: {value:.4g}")
    if radius is None:
        console.print("no intervals: python -m learn.evaluate RUN (or RUN... --ensemble) makes them")
    if file.depth_mm * 1e-3 > loaded.statistics.depth_max * 1.001:
        deepest = loaded.statistics.depth_max * 1e3
        console.print(f"beyond the deepest trained frame ({deepest:.1f} mm): intervals do not hold")
    console.print(f"{out}: displacement.csv, prediction.json, prediction.png")


def _uncertainty(
    run: Run, store: Store, found: Prediction, pokes: Pokes
) -> tuple[NDArray[np.float64] | None, float | None]:
    """Radius at each point [mm] and factor around the force; None without intervals."""
    intervals = load_intervals(run)
    if intervals is None:
        return None, None
    u, force = found.displacement.numpy(), found.force.double().numpy()
    case = Cases(
        truth=u,
        predicted=u,
        force=force,
        force_predicted=force,
        away=np.linalg.norm(store.points - pokes.start.numpy(), axis=1)[None],
        depth=pokes.depth.numpy(),
        poke=np.zeros(1, dtype=np.int64),
        softness=np.array([""]),
        spread=np.zeros(0) if found.spread is None else found.spread.double().numpy(),
        force_spread=np.zeros(0) if found.force_spread is None else found.force_spread.double().numpy(),
    )
    return intervals.radius_mm(case)[0], float(np.exp(intervals.force_log(case)[0]))


def _loaded(folders: list[Path]) -> Run:
    """The run, or the runs as one."""
    runs = [load_run(folder) for folder in folders]
    for run in runs[1:]:
        if run.uuid != runs[0].uuid:
            raise InputError(
                f"{run.folder}: trained on dataset {run.uuid}, {runs[0].folder} on {runs[0].uuid}"
            )
    return together(runs) if len(runs) > 1 else runs[0]


def _write_csv(path: Path, store: Store, u: NDArray[np.float32], radius: NDArray[np.float64] | None) -> None:
    columns = [store.points * 1e3, u * 1e3] + ([radius[:, None]] if radius is not None else [])
    heads = "x_mm,y_mm,z_mm,ux_mm,uy_mm,uz_mm" + (",radius_mm" if radius is not None else "")
    np.savetxt(path, np.concatenate(columns, axis=1), delimiter=",", header=heads, comments="", fmt="%.6g")


def _draw(
    path: Path, store: Store, u: NDArray[np.float32], radius: NDArray[np.float64] | None, title: str
) -> None:
    side = round(len(store.points) ** 0.5)
    place = (store.points + u).reshape(side, side, 3) * 1e3
    figure = plt.figure(figsize=(10, 4), layout="constrained")
    axis = figure.add_subplot(1, 2, 1, projection="3d")
    axis.plot_surface(*place.transpose(2, 0, 1), cmap="viridis", rstride=1, cstride=1)
    axis.set(title=title, xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")
    flat = figure.add_subplot(1, 2, 2)
    shown = radius if radius is not None else np.linalg.norm(u, axis=1) * 1e3
    reach = tuple(float(v) * 1e3 for v in (*store.points[[0, -1], 0], *store.points[[0, -1], 1]))
    picture = flat.imshow(shown.reshape(side, side), origin="lower", extent=reach, cmap="magma")
    flat.set(title="90 % radius [mm]" if radius is not None else "|u| [mm]", xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(picture, ax=flat)
    figure.savefig(path, dpi=100)
    plt.close(figure)


if __name__ == "__main__":
    app()
