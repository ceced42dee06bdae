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
from learn.evaluation import Intervals
from learn.metrics import Cases
from learn.models import Surrogate
from learn.scene_file import load_poke, scene_and_poke
from learn.training import Run, load_run

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Example[/bold]

  python -m learn.predict runs/fast-ours-ogden-0-0 poke.yaml --out poke

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
    run: Annotated[Path, typer.Argument(help="Folder of a run.")],
    scene: Annotated[Path, typer.Argument(help="A YAML file: the poke.")],
    dataset: Annotated[str | None, typer.Option(help="The store, if it moved since the training.")] = None,
    out: Annotated[
        Path, typer.Option(help="Folder for displacement.csv, prediction.json and the picture.")
    ] = Path("prediction"),
) -> None:
    """Predicts one poke on the dataset's block."""
    console = make_console()
    with plain_errors():
        loaded = load_run(run)
        store = open_store(dataset or loaded.location, verify=False)
        if loaded.uuid != store.uuid:
            raise InputError(f"{run}: trained on dataset {loaded.uuid}, but {store.location} is {store.uuid}")
        file = load_poke(scene)
        if not isinstance(loaded.model, Surrogate) and (
            file.inclusion is not None or file.shear_modulus_kPa is not None
        ):
            raise InputError(
                f"{scene}: model {loaded.recipe.model} knows the dataset's shapes and softness alone"
            )
        about, pokes = scene_and_poke(file, store, scene)
        with torch.no_grad():
            found = loaded.model(about, pokes)
        u, force = found.displacement[0].numpy(), float(found.force[0])
        radius, factor = _uncertainty(loaded, store, u, force, pokes.start.numpy()[0], file.depth_mm * 1e-3)
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
        console.print("no intervals: python -m learn.evaluate RUN makes them")
    if file.depth_mm * 1e-3 > loaded.statistics.depth_max * 1.001:
        deepest = loaded.statistics.depth_max * 1e3
        console.print(f"beyond the deepest trained frame ({deepest:.1f} mm): intervals do not hold")
    console.print(f"{out}: displacement.csv, prediction.json, prediction.png")


def _uncertainty(
    run: Run, store: Store, u: NDArray[np.float32], force: float, start: NDArray[np.float64], depth: float
) -> tuple[NDArray[np.float64] | None, float | None]:
    """Radius at each point [mm] and factor around the force; None without intervals."""
    path = run.folder / "intervals.json"
    if not path.is_file():
        return None, None
    try:
        intervals = Intervals(**json.loads(path.read_text(encoding="utf-8")))
    except (ValueError, TypeError):
        raise InputError(f"{path}: not readable; learn.evaluate writes it again") from None
    case = Cases(
        truth=u[None],
        predicted=u[None],
        force=np.array([force]),
        force_predicted=np.array([force]),
        away=np.linalg.norm(store.points - start, axis=1)[None],
        depth=np.array([depth]),
        poke=np.zeros(1, dtype=np.int64),
        softness=np.array([""]),
    )
    return intervals.radius_mm(case)[0], float(np.exp(intervals.force))


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
