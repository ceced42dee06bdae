"""`python -m factory.inspect DATASET`: what is in a dataset, and how far it got."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from factory._layout import SPECS
from factory._picture import draw_poke
from factory._screen import duration, fail, make_console, size_text
from factory._summary import PAPER, PokeSummary, Summary, summarise
from factory.errors import InputError, describe_os_error
from factory.reader import Dataset, open_dataset

app = typer.Typer(add_completion=False, rich_markup_mode="rich", pretty_exceptions_enable=False)

EXAMPLES = """
[bold]Examples[/bold]

  python -m factory.inspect datasets/quick-ogden.zarr

  python -m factory.inspect datasets/quick-ogden.zarr --arrays

  python -m factory.inspect datasets/quick-ogden.zarr --poke 3 --picture poke3.png
"""


@app.command(epilog=EXAMPLES)
def main(
    dataset: Annotated[Path, typer.Argument(help="The store (also while it is being built).")],
    poke: Annotated[int | None, typer.Option(help="Show one poke, by index.")] = None,
    picture: Annotated[Path | None, typer.Option(help="With --poke: write its picture, a PNG.")] = None,
    arrays: Annotated[bool, typer.Option("--arrays", help="List every array with its units.")] = False,
) -> None:
    """What is in a dataset: progress, depths and forces reached, what stopped the pokes, sizes."""
    console = make_console()
    try:
        if poke is not None:
            _show_poke(open_dataset(dataset), poke, picture, console)
            return
        if picture is not None:
            raise InputError("--picture: expected --poke N with it")
        summary = summarise(dataset)
        console.print(_overview(summary))
        if summary.done:
            console.print(_reached(summary))
            console.print(_causes(summary))
        for index, text in list(summary.failed.items())[:10]:
            console.print(f"poke {index} failed: {text}", markup=False, highlight=False)
        if summary.finished:
            data = open_dataset(dataset)
            console.print(_arrays(data, everything=arrays))
    except InputError as error:
        fail(error)
    except OSError as error:
        fail(InputError(describe_os_error(error, f"{dataset}: cannot read")))


def _overview(summary: Summary) -> Table:
    table = Table(title=str(summary.path), show_header=False)
    state = "finished" if summary.finished else "being built, or stopped on the way"
    counts = f"{len(summary.done)} of {summary.pokes} pokes, {len(summary.failed)} failed"
    table.add_row("state", f"{state}: {counts}")
    table.add_row("recipe, law", f"{summary.recipe}, {summary.model}")
    table.add_row("uuid", summary.uuid)
    table.add_row("shapes", ", ".join(summary.shapes))
    if summary.done:
        nodes = np.array([poke.nodes for poke in summary.done])
        table.add_row("nodes a mesh", f"{nodes.min()} to {nodes.max()}, mean {nodes.mean():.0f}")
        table.add_row("frames", f"{sum(len(poke.depth) for poke in summary.done)}")
    walls = [entry["wall_seconds"] for entry in summary.ledger.values() if not entry.get("error")]
    if walls:
        table.add_row("time a poke", f"mean {np.mean(walls):.1f} s, longest {max(walls):.1f} s")
        table.add_row("time in all", f"{duration(sum(walls))} of worker time")
    return table


def _reached(summary: Summary) -> Table:
    table = Table(title="Depths and forces reached, mean +- sd (the paper's below)")
    measures = ("deepest [mm]", "largest force [N]", "depth a frame [mm]", "force a frame [N]")
    for head in ("softness", "pokes", *measures):
        table.add_column(head, justify="right")
    for name in summary.softness:
        pokes = [poke for poke in summary.done if poke.softness == name]
        if not pokes:
            continue
        table.add_row(name, str(len(pokes)), *_features(pokes))
        paper = PAPER.get(summary.model, {}).get(name)
        if paper:
            cells = [f"{mean:.2f} +- {sd:.2f}" for mean, sd in paper]
            table.add_row("paper", "440", *cells, style="dim")
    return table


def _features(pokes: list[PokeSummary]) -> list[str]:
    kept = [poke for poke in pokes if len(poke.depth)]
    if not kept:
        return ["-"] * 4
    columns = (
        np.array([poke.depth.max() for poke in kept]) * 1e3,
        np.array([poke.force.max() for poke in kept]),
        np.concatenate([poke.depth for poke in kept]) * 1e3,
        np.concatenate([poke.force for poke in kept]),
    )
    return [_mean_sd(values) for values in columns]


def _mean_sd(values: NDArray[np.float64]) -> str:
    return f"{values.mean():.2f} +- {values.std():.2f}"


def _causes(summary: Summary) -> Table:
    table = Table(title="What ended the pokes")
    for head in ("status", "pokes", "deepest, mean [mm]", "for example"):
        table.add_column(head)
    for status, count in Counter(poke.status for poke in summary.done).most_common():
        those = [poke for poke in summary.done if poke.status == status]
        depths = [poke.depth.max() * 1e3 if len(poke.depth) else 0.0 for poke in those]
        example = f"poke {those[0].index}: {those[0].message}"
        table.add_row(status, str(count), f"{np.mean(depths):.1f}", example)
    if summary.failed:
        index, text = next(iter(summary.failed.items()))
        table.add_row("failed", str(len(summary.failed)), "-", f"poke {index}: {text}")
    return table


def _arrays(data: Dataset, *, everything: bool) -> Table:
    table = Table(title="Arrays" if everything else "Largest arrays (--arrays lists all)")
    for head in ("name", "shape", "type", "units", "on disk", "what it is"):
        table.add_column(head)
    sizes = {name: _size(data.path / name) for name in SPECS}
    names = list(SPECS) if everything else sorted(SPECS, key=lambda name: -sizes[name])[:4]
    for name in names:
        array = data.array(name)
        shape = " x ".join(str(n) for n in array.shape)
        units = str(array.attrs.get("units", ""))
        table.add_row(name, shape, str(array.dtype), units, size_text(sizes[name]), SPECS[name].text)
    table.add_row("all", "", "", "", size_text(_size(data.path)), "")
    return table


def _size(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _show_poke(data: Dataset, index: int, picture: Path | None, console: Console) -> None:
    if not 0 <= index < data.n_pokes:
        raise InputError(f"--poke {index}: expected 0 to {data.n_pokes - 1}")
    poke = data.poke(index)
    table = Table(title=f"Poke {index} of {data.path}", show_header=False)
    table.add_row("shape, softness", f"{poke.shape}, {poke.softness}")
    table.add_row("status", f"{poke.status}: {poke.message}" if poke.message else poke.status)
    x, y = (v * 1e3 for v in data.table["site"][index])
    angle = np.degrees(np.arccos(np.clip(-poke.direction[2], -1, 1)))
    table.add_row("site, angle", f"({x:.1f}, {y:.1f}) mm, {angle:.1f} degrees from the normal")
    table.add_row("frames", str(len(poke.depth)))
    if len(poke.depth):
        table.add_row("deepest", f"{poke.depth.max() * 1e3:.2f} mm")
        table.add_row("largest force", f"{np.linalg.norm(poke.rod_force, axis=1).max():.3f} N")
    console.print(table)
    if picture is not None:
        if picture.suffix != ".png":
            raise InputError(f"--picture {picture}: expected a name that ends in .png")
        if not len(poke.depth):
            raise InputError(f"--poke {index}: it has no frames to draw ({poke.message or poke.status})")
        draw_poke(poke, data, picture)
        console.print(f"picture: {picture}")


if __name__ == "__main__":
    app()
