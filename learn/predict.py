"""`python -m learn.predict`: one poke by a trained surrogate, with a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from learn._options import Dataset, Plugins, Version, check_folder, load_plugins, single
from learn._terminal import make_console, plain_errors

EXAMPLES = """
[bold]Examples[/bold]

  python -m learn.predict runs/quick datasets/scenes/poke.yaml --out poke

By the network that comes with tisim (its card: learn/pretrained/covers/card.md):

  python -m learn.predict covers datasets/scenes/lump.yaml --out lump

Runs of several seeds as one, the mean of their predictions:

  python -m learn.predict runs/fast-invariant-gnn-ogden-0-0 runs/fast-invariant-gnn-ogden-0-1 poke.yaml

with poke.yaml, for instance:

  site_mm: \\[5, -10]
  depth_mm: 8
  angle_deg: 20
  heading_deg: 45
  shape: cube-18            # or inclusion: {kind: sphere, radius_mm: 8, centre_mm: \\[0, 0, 6]}
  softness: S0.5            # or shear_modulus_kPa: 12

At a lab's own points of the top face too, such as markers, a CSV file with columns x_mm and y_mm:

  python -m learn.predict runs/quick datasets/scenes/poke.yaml --points markers.csv

Every prediction states whether the poke is inside the trained ranges.

Exit codes: 0 done, 2 bad input, or outside the training with --strict.
"""


def main(
    runs: Annotated[
        list[Path],
        typer.Argument(
            help="Folder of a run, or covers, or folders of several runs to average.", metavar="RUN..."
        ),
    ],
    scene: Annotated[Path, typer.Argument(help="YAML file with the poke.")],
    dataset: Dataset = None,
    points: Annotated[
        Path | None,
        typer.Option(
            help="CSV file of points of the top face (x_mm, y_mm, and names in id): points.csv has the"
            " displacement there.",
            metavar="FILE",
        ),
    ] = None,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Refuse pokes outside the domain of validity (exit code 2)."),
    ] = False,
    out: Annotated[
        Path, typer.Option(help="Folder for displacement.csv, points.csv, prediction.json and the picture.")
    ] = Path("prediction"),
    plugin: Plugins = None,
    _version: Version = False,
) -> None:
    """Predict one poke, and check whether it is within the domain of validity of the model."""
    console = make_console()
    with plain_errors():
        from learn.predictor import load

        load_plugins(plugin or [])
        check_folder(out)
        predictor = load(list(runs), dataset=dataset)
        answer = predictor.predict(scene, points=points, strict=strict)
        answer.save(out)
        for key, value in answer.as_dict().items():
            if isinstance(value, float):
                console.print(f"{key}: {value:.4g}")
        if answer.radius is None:
            console.print(
                "no intervals: learn.evaluate makes them where there are two or more validation pokes"
            )
        elif answer.force_interval is None:
            console.print("no interval of the force, which is predicted to be 0 N or less")
        console.print(answer.verdict)
        for check in answer.checks:
            if check.inside is None:  # what is outside stands in the verdict
                console.print(f"  {check.text}")
        files = ["displacement.csv", *(["points.csv"] if points else []), "prediction.json", "prediction.png"]
        console.print(f"{out}: {', '.join(files)}")


app = single(main, EXAMPLES)

if __name__ == "__main__":
    app(prog_name="python -m learn.predict")
