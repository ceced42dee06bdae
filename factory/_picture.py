"""A picture of one poke: the deformed block, the section below the rod, force against depth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from factory.reader import Dataset, PokeData


def draw_poke(poke: PokeData, data: Dataset, path: Path) -> None:
    """Writes a PNG of the last frame."""
    figure = Figure(figsize=(14, 4.6), layout="constrained", dpi=110)
    FigureCanvasAgg(figure)
    figure.suptitle(
        f"poke {poke.index}: {poke.shape}, {poke.softness}, {poke.depth[-1] * 1e3:.1f} mm, {poke.status}"
    )
    _block(poke, figure.add_subplot(1, 3, 1, projection="3d"))
    _section(poke, data, figure.add_subplot(1, 3, 2), figure)
    axes = figure.add_subplot(1, 3, 3)
    for name, force, style in (("on the rod", poke.rod_force, "o-"), ("at the base", poke.base_force, "x--")):
        axes.plot(poke.depth * 1e3, np.linalg.norm(force, axis=1), style, ms=4, label=name)
    axes.set(xlabel="depth [mm]", ylabel="force [N]")
    axes.legend()
    figure.savefig(path, format="png")


def _block(poke: PokeData, axes: Any) -> None:
    surface = poke.surface[-1] * 1e3
    corners = surface[poke.triangles]
    sunk = (poke.surface_rest * 1e3 - surface)[poke.triangles][:, :, 2].mean(axis=1)
    shade = 1 - 0.8 * np.clip(sunk / max(float(sunk.max()), 1e-9), 0, 1)
    colours = np.stack([0.35 * shade, 0.55 * shade + 0.1, 0.8 * shade + 0.15], axis=1)
    axes.add_collection3d(
        Poly3DCollection(corners, facecolors=colours, edgecolors="#00000018", linewidths=0.2)
    )
    tip = poke.rod_tip[-1] * 1e3
    tail = tip - 40 * poke.direction
    axes.plot(*np.stack([tip, tail], axis=1), color="#d94801", lw=5)
    low, high = surface.min(axis=0), surface.max(axis=0)
    high[2] = max(high[2], tail[2])
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low)
    axes.view_init(elev=28, azim=-60)
    axes.set(xlabel="x [mm]", ylabel="y [mm]", zlabel="z [mm]")


def _section(poke: PokeData, data: Dataset, axes: Any, figure: Figure) -> None:
    """Stiffness below the grid row nearest to the rod's tip, and that row of the top, deformed."""
    rest = data.table["grid_rest"] * 1e3
    tip = poke.rod_tip[-1] * 1e3
    row = int(np.argmin(np.abs(rest[:, 0, 1] - tip[1])))
    height = float(rest[0, 0, 2])
    levels = poke.profile[row].T / 255
    extent = (rest[row, 0, 0], rest[row, -1, 0], 0.0, height)
    drawn = axes.imshow(
        levels,
        extent=extent,
        aspect="equal",
        cmap="Greys",
        vmin=0,
        vmax=1,
        alpha=0.7,
        interpolation="nearest",
    )
    figure.colorbar(drawn, ax=axes, label="stiffness code (rest shape)", orientation="horizontal")
    axes.plot(poke.grid[-1, row, :, 0] * 1e3, poke.grid[-1, row, :, 2] * 1e3, ".-", color="#2171b5")
    start = tip - 40 * poke.direction
    axes.plot([start[0], tip[0]], [start[2], tip[2]], color="#d94801", lw=3)
    axes.set(xlabel="x [mm]", ylabel="z [mm]", title=f"section at y = {rest[row, 0, 1]:.1f} mm")
    axes.set_ylim(0, height + 12)
