"""The picture beside a store: where was poked, how hard it pushed back, what the top looks like."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from numpy.typing import NDArray

from factory._grid import grid_points
from factory.plan import Plan
from tisim.bodies import BoxInclusion, Inclusion

COLOURS = ("#08306b", "#2171b5", "#6baed6", "#9ecae1", "#c6dbef")


@dataclass(frozen=True, eq=False)
class Trace:
    """One poke in short: depth [m] and force [N] of its frames, last displacement of the grid [m]."""

    depth: NDArray[np.float64]
    force: NDArray[np.float64]
    grid: NDArray[np.float32] | None


def preview_path(target: Path) -> Path:
    """NAME.zarr -> NAME.png, beside it."""
    return target.with_suffix(".png")


def draw_preview(plan: Plan, traces: dict[int, Trace], path: Path) -> None:
    """Draws and writes the picture; whole or not at all."""
    figure = Figure(figsize=(13, 4.2), layout="constrained", dpi=110)
    FigureCanvasAgg(figure)
    sites, curves, top = figure.subplots(1, 3)
    figure.suptitle(f"{plan.recipe.name}, {plan.model}: {len(traces)} of {len(plan.pokes)} pokes")
    _sites(plan, traces, sites)
    for index, trace in sorted(traces.items()):
        colour = COLOURS[plan.pokes[index].softness % len(COLOURS)]
        curves.plot(trace.depth * 1e3, trace.force, color=colour, lw=0.9, alpha=0.7)
    for number, name in enumerate(plan.recipe.softness):
        curves.plot([], [], color=COLOURS[number % len(COLOURS)], label=name)
    curves.legend(title="softness")
    curves.set(xlabel="depth [mm]", ylabel="force on the rod [N]", title="every frame kept")
    _top(plan, traces, top, figure)
    temporary = path.with_name(f".{path.name}.tmp")
    figure.savefig(temporary, format="png")
    temporary.replace(path)


def _sites(plan: Plan, traces: dict[int, Trace], axes: Any) -> None:
    half = np.array(plan.block[:2]) / 2 * 1e3
    for inclusion in plan.inclusions:
        axes.add_patch(_outline(inclusion))
    for poke in plan.pokes:
        x, y = (v * 1e3 for v in poke.scene.site)
        colour = COLOURS[poke.softness % len(COLOURS)] if poke.index in traces else "0.8"
        dx, dy = (v * 6 for v in poke.scene.direction[:2])
        axes.plot([x, x + dx], [y, y + dy], color=colour, lw=0.7)
        axes.plot(x, y, ".", color=colour, ms=3)
    axes.set(xlim=(-half[0], half[0]), ylim=(-half[1], half[1]), xlabel="x [mm]", ylabel="y [mm]")
    axes.set_aspect("equal")
    axes.set_title("sites and headings; inclusions of all shapes", fontsize=9)


def _outline(inclusion: Inclusion) -> Any:
    style: dict[str, Any] = {"facecolor": "#fdae6b", "edgecolor": "#e6550d", "alpha": 0.25}
    x, y = inclusion.centre[0] * 1e3, inclusion.centre[1] * 1e3
    if isinstance(inclusion, BoxInclusion):
        a, b = inclusion.size[0] * 1e3, inclusion.size[1] * 1e3
        angle = float(np.degrees(inclusion.angle))
        return Rectangle((x - a / 2, y - b / 2), a, b, angle=angle, rotation_point="center", **style)
    return Circle((x, y), inclusion.radius * 1e3, **style)


def _top(plan: Plan, traces: dict[int, Trace], axes: Any, figure: Figure) -> None:
    """The deepest frame so far as a map of how far the top has sunk."""
    shown = [i for i, trace in traces.items() if trace.grid is not None and len(trace.depth)]
    if not shown:
        axes.set_axis_off()
        return
    deepest = max(shown, key=lambda i: (traces[i].depth[-1], -i))
    grid = traces[deepest].grid
    assert grid is not None
    rest = grid_points(plan.block)
    x, y = (rest[..., axis] * 1e3 for axis in (0, 1))
    drawn = axes.pcolormesh(x, y, grid[..., 2] * 1e3, cmap="viridis", shading="nearest")
    figure.colorbar(drawn, ax=axes, label="vertical displacement [mm]")
    axes.set_aspect("equal")
    axes.set_title(f"poke {deepest} at {traces[deepest].depth[-1] * 1e3:.1f} mm", fontsize=9)
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
