"""`python -m factory.inspect DATASET`: show the content and the progress of a dataset."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factory.cli import (
    Plugins,
    duration,
    import_plugins,
    make_app,
    make_console,
    shown_errors,
    sides_text,
    size_text,
)
from factory.errors import InputError
from tisim.options import Version

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from factory.inspection.summary import Summary
    from factory.reader import Dataset
    from factory.store.poke_data import PokeData

EXAMPLES = """
[bold]Examples[/bold]

  python -m factory.inspect datasets/quick-ogden.zarr

  python -m factory.inspect datasets/quick-ogden.zarr --arrays

  python -m factory.inspect datasets/quick-ogden.zarr --poke 3 --picture poke3.png
"""


def main(
    dataset: Annotated[Path, typer.Argument(help="Dataset (finished, or being built).")],
    poke: Annotated[int | None, typer.Option(help="Show one poke, by index.")] = None,
    picture: Annotated[Path | None, typer.Option(help="With --poke: write its picture, a PNG.")] = None,
    arrays: Annotated[bool, typer.Option("--arrays", help="List all arrays with their units.")] = False,
    plugin: Plugins = None,
    version: Version = False,
) -> None:
    """Show the content of a dataset: progress, depths, forces, reasons why pokes ended, sizes."""
    del version
    with shown_errors(f"{dataset}: cannot read"):
        import_plugins(plugin)

        from factory.inspection.summary import summarise
        from factory.reader import open_dataset

        console = make_console()
        if poke is not None:
            _show_poke(open_dataset(dataset), poke, picture, console)
            return
        if picture is not None:
            raise InputError("--picture: expected --poke N with it")
        summary = summarise(dataset)
        console.print(_overview(summary))
        if summary.replacement:
            console.print(summary.replacement)
        if summary.done:
            console.print(_reached(summary))
            console.print(_causes(summary))
        for index, text in list(summary.damaged.items())[:10]:
            console.print(f"poke {index}: its staged result is damaged ({text}): a build simulates it again")
        for index, text in list(summary.failed.items())[:10]:
            console.print(f"poke {index} failed: {text}")
        if summary.finished:
            console.print(_arrays(open_dataset(dataset), everything=arrays))


def _overview(summary: Summary) -> Table:
    import numpy as np
    from rich.table import Table

    table = Table(title=str(summary.path), show_header=False)
    state = "being built, or stopped on the way"
    if summary.finished:
        state = "partial" if summary.waiting else "finished"
    counts = f"{len(summary.done)} of {summary.pokes} pokes, {len(summary.failed)} failed"
    if summary.waiting:
        counts += f", {summary.waiting} not simulated yet"
    if summary.damaged:
        counts += f", {len(summary.damaged)} damaged"
    table.add_row("state", f"{state}: {counts}")
    table.add_row("recipe, law", f"{summary.recipe}, {summary.model}")
    table.add_row("uuid", summary.uuid)
    table.add_row("shapes", ", ".join(summary.shapes))
    if summary.done:
        nodes = np.array([poke.nodes for poke in summary.done])
        table.add_row("nodes per mesh", f"{nodes.min()} to {nodes.max()}, mean {nodes.mean():.0f}")
        table.add_row("frames", f"{sum(len(poke.depth) for poke in summary.done)}")
    walls = [entry["wall_seconds"] for entry in summary.ledger.values() if not entry.get("error")]
    if walls:
        table.add_row("time per poke", f"mean {np.mean(walls):.1f} s, longest {max(walls):.1f} s")
        table.add_row("total time", f"{duration(sum(walls))} of worker time")
    return table


def _reached(summary: Summary) -> Table:
    from rich.table import Table

    from factory.inspection.features import measures
    from factory.inspection.paper_table import PAPER, pokes_a_level

    table = Table(title="Depths and forces reached, mean +- sd (the paper's below)")
    heads = ("deepest [mm]", "largest force [N]", "depth per frame [mm]", "force per frame [N]")
    for head in ("material level", "pokes", *heads):
        table.add_column(head, justify="right")
    for name in summary.levels:
        pokes = [poke for poke in summary.done if poke.level == name]
        if not pokes:
            continue
        ours = measures(pokes)
        table.add_row(name, str(len(pokes)), *(_mean_sd(ours) if ours else ["-"] * 4))
        paper = PAPER.get(summary.model, {}).get(name)
        if paper:
            table.add_row("paper", str(pokes_a_level()), *_mean_sd(paper), style="dim")
    return table


def _mean_sd(pairs: Sequence[tuple[float, float]]) -> list[str]:
    return [f"{mean:.2f} +- {sd:.2f}" for mean, sd in pairs]


def _causes(summary: Summary) -> Table:
    from rich.table import Table

    table = Table(title="Reasons why pokes ended")
    for head in ("status", "pokes", "deepest, mean [mm]", "for example"):
        table.add_column(head)
    for status, count in Counter(poke.status for poke in summary.done).most_common():
        those = [poke for poke in summary.done if poke.status == status]
        depths = [poke.depth.max() * 1e3 if len(poke.depth) else 0.0 for poke in those]
        first = those[0]
        example = f"poke {first.index}: {first.message}" if first.message else f"poke {first.index}"
        table.add_row(status, str(count), f"{sum(depths) / len(depths):.1f}", example)
    if summary.failed:
        index, text = next(iter(summary.failed.items()))
        table.add_row("failed", str(len(summary.failed)), "-", f"poke {index}: {text}")
    return table


def _arrays(data: Dataset, *, everything: bool) -> Table:
    from rich.table import Table

    table = Table(title="Arrays" if everything else "Largest arrays (--arrays lists all)")
    for head in ("name", "shape", "type", "units", "on disk", "content"):
        table.add_column(head)
    specs = data.specs
    sizes = {name: data.size_of(name) for name in specs}
    names = list(specs) if everything else sorted(specs, key=lambda name: -sizes[name])[:4]
    for name in names:
        array = data.array(name)
        shape = " x ".join(str(n) for n in array.shape)
        units = str(array.attrs.get("units", ""))
        table.add_row(name, shape, str(array.dtype), units, size_text(sizes[name]), specs[name].text)
    table.add_row("all", "", "", "", size_text(data.size_of()), "")
    return table


def _show_poke(data: Dataset, index: int, picture: Path | None, console: Console) -> None:
    import numpy as np
    from rich.table import Table

    if not 0 <= index < data.n_pokes:
        raise InputError(f"--poke {index}: expected 0 to {data.n_pokes - 1}")
    poke = data.poke(index)
    data.check_sums(index)
    table = Table(title=f"Poke {index} of {data.path}", show_header=False)
    table.add_row("shape, material level", f"{poke.shape}, {poke.level}")
    table.add_row("block", f"{sides_text([[1e3 * side for side in poke.block]])} mm")
    lengths = ", ".join(f"{1e3 * v:g}" for v in poke.inclusion.dimensions)
    table.add_row("inclusion", f"{poke.inclusion.kind}, {lengths} mm")
    table.add_row("status", f"{poke.status}: {poke.message}" if poke.message else poke.status)
    x, y = (v * 1e3 for v in data.table["site"][index])
    angle = np.degrees(np.arccos(np.clip(-poke.direction[2], -1, 1)))
    table.add_row("contact point, angle", f"({x:.1f}, {y:.1f}) mm, {angle:.1f} degrees from the normal")
    table.add_row("frames", str(len(poke.depth)))
    if len(poke.depth):
        table.add_row("deepest", f"{poke.depth.max() * 1e3:.2f} mm")
        table.add_row("largest force", f"{np.linalg.norm(poke.rod_force, axis=1).max():.3f} N")
    for name, text in _pieces(data, index, poke):
        table.add_row(name, text)
    console.print(table)
    if picture is not None:
        if picture.suffix != ".png":
            raise InputError(f"--picture {picture}: expected a name that ends in .png")
        if not len(poke.depth):
            raise InputError(f"--poke {index}: it has no frames to draw ({poke.message or poke.status})")
        from factory.inspection.figures import draw_poke

        draw_poke(poke, data, picture)
        console.print(f"picture: {picture}")


def _pieces(data: Dataset, index: int, poke: PokeData) -> Iterator[tuple[str, str]]:
    """Phase and text of each piece of a poke's course: speed, duration, force at its first and last frame."""
    import numpy as np

    from factory.recipe.course import PHASES, phases, pieces_at

    if poke.time is None or poke.dissipated_energy is None:
        return
    times, depths = data.table["course_time"][index], data.table["course_depth"][index]
    force, piece = np.linalg.norm(poke.rod_force, axis=1), pieces_at(times, poke.time)
    lengths, moves = np.diff(times, prepend=0.0), np.diff(depths, prepend=0.0)
    for number, phase in enumerate(phases(depths)):
        inside = np.flatnonzero(piece == number)
        what = f"{lengths[number]:.3g} s"
        if moves[number]:
            speed = 1e3 * abs(moves[number]) / lengths[number]
            what = f"to {1e3 * depths[number]:.3g} mm at {speed:.3g} mm/s, {what}"
        forces = f"{force[inside[0]]:.3f} to {force[inside[-1]]:.3f} N" if len(inside) else "not reached"
        yield PHASES[phase], f"{what}: {len(inside)} frames, {forces}"
    if len(poke.time):
        yield "energy dissipated", f"{1e3 * poke.dissipated_energy[-1]:.3g} mJ in {poke.time[-1]:.3g} s"


app = make_app(main, EXAMPLES)

if __name__ == "__main__":
    app()
