"""Figures: the preview beside a store, and one poke in detail."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image

from factory.plan.dataset import Plan
from factory.reader import Dataset
from factory.sampling import grid_points
from factory.simulation.record import Trace
from factory.store.poke_data import PokeData
from tisim.io.whole import whole_file

_INCLUSION: dict[str, Any] = {"facecolor": "#fdae6b", "edgecolor": "#e6550d", "alpha": 0.25}
COLOURS = ("#08306b", "#2171b5", "#6baed6", "#9ecae1", "#c6dbef")


_TITLE = "preview of a dataset of tisim"  # in the file, so that no other picture is replaced


class NotOursError(Exception):
    """A picture of another origin has the name of a preview."""


def draw_preview(plan: Plan, traces: dict[int, Trace], path: Path, of: str = "") -> None:
    """Write the preview, whole or not at all: contact points, force against depth, the top at its deepest.

    Parameters
    ----------
    plan : Plan
    traces : dict of int to Trace
        By index of the poke.
    path : Path
    of : str
        Digest of the store's manifest, which the file states (`preview_of`); "" while there is no store.

    Raises
    ------
    NotOursError
        If the path is a picture of another origin, which stays.
    """
    if path.exists() and preview_of(path) is None:
        raise NotOursError(f"no preview picture: {path.name} is another picture, which stays")
    figure = Figure(figsize=(13, 4.2), layout="constrained", dpi=110)
    sites, curves, top = figure.subplots(1, 3)
    figure.suptitle(f"{plan.recipe.name}, {plan.model}: {len(traces)} of {len(plan.pokes)} pokes")
    _sites(plan, traces, sites)
    for index, trace in sorted(traces.items()):
        colour = COLOURS[plan.pokes[index].level % len(COLOURS)]
        curves.plot(trace.depth * 1e3, trace.force, color=colour, lw=0.9, alpha=0.7)
    for number, name in enumerate(plan.recipe.levels):
        curves.plot([], [], color=COLOURS[number % len(COLOURS)], label=name)
    curves.legend(title="material level")
    curves.set(xlabel="depth [mm]", ylabel="force on the rod [N]", title="all frames")
    _top(plan, traces, top, figure)
    with whole_file(path) as part:
        figure.savefig(part, format="png", metadata={"Title": _TITLE, "Description": of})


def preview_of(path: Path) -> str | None:
    """Digest of the manifest of the store that a preview shows; None for what is no preview."""
    try:
        with Image.open(path) as picture:
            return str(picture.info.get("Description", "")) if picture.info.get("Title") == _TITLE else None
    except (OSError, ValueError):  # what is not a picture was not drawn here
        return None


def _sites(plan: Plan, traces: dict[int, Trace], axes: Any) -> None:
    half = np.array(plan.blocks)[:, :2] / 2 * 1e3
    for x, y in np.unique(half, axis=0):
        axes.add_patch(Rectangle((-x, -y), 2 * x, 2 * y, fill=False, edgecolor="0.8", lw=0.5))
    for inclusion in plan.inclusions:
        axes.add_patch(Polygon(inclusion.plan() * 1e3, closed=True, **_INCLUSION))
    for poke in plan.pokes:
        x, y = (v * 1e3 for v in poke.scene.site)
        colour = COLOURS[poke.level % len(COLOURS)] if poke.index in traces else "0.8"
        dx, dy = (v * 6 for v in poke.scene.direction[:2])
        axes.plot([x, x + dx], [y, y + dy], color=colour, lw=0.7)
        axes.plot(x, y, ".", color=colour, ms=3)
    x, y = half.max(axis=0)
    axes.set(xlim=(-x, x), ylim=(-y, y), xlabel="x [mm]", ylabel="y [mm]")
    axes.set_aspect("equal")
    axes.set_title("contact points and headings; inclusions of all shapes", fontsize=9)


def _top(plan: Plan, traces: dict[int, Trace], axes: Any, figure: Figure) -> None:
    """Draw a map of the top's vertical displacement in the deepest frame so far."""
    shown = [i for i, trace in traces.items() if trace.grid is not None and len(trace.depth)]
    if not shown:
        axes.set_axis_off()
        return
    deepest = max(shown, key=lambda i: (traces[i].depth.max(), -i))
    grid = traces[deepest].grid
    assert grid is not None
    rest = grid_points(plan.pokes[deepest].scene.block.size)
    x, y = (rest[..., axis] * 1e3 for axis in (0, 1))
    drawn = axes.pcolormesh(x, y, grid[..., 2] * 1e3, cmap="viridis", shading="nearest")
    figure.colorbar(drawn, ax=axes, label="vertical displacement [mm]")
    axes.set_aspect("equal")
    axes.set_title(f"poke {deepest} at {traces[deepest].depth.max() * 1e3:.1f} mm", fontsize=9)
    axes.set(xlabel="x [mm]", ylabel="y [mm]")


def draw_poke(poke: PokeData, data: Dataset, path: Path) -> None:
    """Write a picture of the deepest frame: the block, the section below the indenter, and all forces."""
    figure = Figure(figsize=(14, 4.6), layout="constrained", dpi=110)
    figure.suptitle(
        f"poke {poke.index}: {poke.shape}, {poke.level}, {poke.depth.max() * 1e3:.1f} mm, {poke.status}"
    )
    _block(poke, figure.add_subplot(1, 3, 1, projection="3d"))
    _section(poke, data, figure.add_subplot(1, 3, 2), figure)
    axes = figure.add_subplot(1, 3, 3)
    across, label = (poke.depth * 1e3, "depth [mm]") if poke.time is None else (poke.time, "time [s]")
    for name, force, style in (("on the rod", poke.rod_force, "o-"), ("at the base", poke.base_force, "x--")):
        axes.plot(across, np.linalg.norm(force, axis=1), style, ms=4, label=name)
    axes.set(xlabel=label, ylabel="force [N]")
    axes.legend()
    with whole_file(path) as part:
        figure.savefig(part, format="png")


def _deepest(poke: PokeData) -> int:
    """Frame of the largest depth: the last one, unless the rod is drawn back."""
    return int(np.argmax(poke.depth))


def _block(poke: PokeData, axes: Any) -> None:
    surface = poke.surface[_deepest(poke)] * 1e3
    corners = surface[poke.triangles]
    sunk = (poke.surface_rest * 1e3 - surface)[poke.triangles][:, :, 2].mean(axis=1)
    shade = 1 - 0.8 * np.clip(sunk / max(float(sunk.max()), 1e-9), 0, 1)
    colours = np.stack([0.35 * shade, 0.55 * shade + 0.1, 0.8 * shade + 0.15], axis=1)
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=colours, edgecolors="#00000018", linewidths=0.2)
    )
    tip = poke.rod_tip[_deepest(poke)] * 1e3
    tail = tip - 40 * poke.direction
    axes.plot(*np.stack([tip, tail], axis=1), color="#d94801", lw=5)
    low, high = surface.min(axis=0), surface.max(axis=0)
    high[2] = max(high[2], tail[2])
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low)
    axes.view_init(elev=28, azim=-60)
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")


def _section(poke: PokeData, data: Dataset, axes: Any, figure: Figure) -> None:
    """Draw the vertical section through the rod's axis: undeformed stiffness, deformed surface, rod."""
    tip = poke.rod_tip[_deepest(poke)]
    heading = np.array(poke.direction[:2])
    lean = float(np.linalg.norm(heading))
    heading = heading / lean if lean > 1e-6 else np.array([1.0, 0.0])
    cut = _cut(poke.surface[_deepest(poke)] - np.array([*tip[:2], 0.0]), poke.triangles, heading)
    axes.add_collection(LineCollection(cut * 1e3, colors="#2171b5", linewidths=1.2))

    # part of the plane within the block, and the grid columns nearest to it
    rest = data.grid_rest(int(data.table["poke_geometry"][poke.index]))
    (low, high), height = (rest[[0, -1], [0, -1], :2] - tip[:2]), float(rest[0, 0, 2])
    ends = np.sort([low, high], axis=0)
    with np.errstate(divide="ignore"):
        reach = np.sort(ends / heading, axis=0)
    along = np.linspace(reach[0].max(), reach[1].min(), 200)
    place = (along[:, None] * heading - ends[0]) / (ends[1] - ends[0])
    column, row = np.rint(np.clip(place, 0, 1).T * (np.array(rest.shape[1::-1])[:, None] - 1)).astype(int)
    drawn = axes.imshow(
        poke.profile[row, column].T / 255,
        extent=(along[0] * 1e3, along[-1] * 1e3, 0.0, height * 1e3),
        aspect="equal",
        cmap="Greys",
        vmin=0,
        vmax=1,
        alpha=0.7,
        interpolation="nearest",
    )
    figure.colorbar(
        drawn, ax=axes, label="stiffness code of the nearest grid columns, at rest", orientation="horizontal"
    )

    radius = data.attributes["identity"]["recipe"]["rod"]["radius_mm"]
    push = np.array([lean, float(poke.direction[2])])
    across, foot = radius * np.array([-push[1], push[0]]), np.array([0.0, tip[2] * 1e3])
    corners = [foot + across, foot - across, foot - across - 80 * push, foot + across - 80 * push]
    axes.add_patch(Polygon(corners, closed=True, facecolor="#d94801", alpha=0.8))
    axes.set(xlabel="along the heading, from the tip [mm]", ylabel="z [mm]", title="section through the rod")
    axes.set_xlim(along[0] * 1e3 - 2, along[-1] * 1e3 + 2)
    axes.set_ylim(-1, height * 1e3 + 12)


def _cut(surface: Any, triangles: Any, heading: Any) -> Any:
    """Cut of a surface by a vertical plane through the origin: segments (k, 2, 2), along the heading and z.

    `surface` (n, 3) is relative to the origin in x and y, with absolute z.
    """
    side = surface[:, :2] @ np.array([-heading[1], heading[0]])
    side = np.where(side == 0.0, 1e-12, side)  # so that no corner lies on the plane
    flat = np.stack([surface[:, :2] @ heading, surface[:, 2]], axis=1)
    first, second = triangles, np.roll(triangles, -1, axis=1)
    crossed = (side[first] > 0) != (side[second] > 0)  # none or two edges of each triangle
    first, second = first[crossed], second[crossed]
    share = (side[first] / (side[first] - side[second]))[:, None]
    return (flat[first] + share * (flat[second] - flat[first])).reshape(-1, 2, 2)
