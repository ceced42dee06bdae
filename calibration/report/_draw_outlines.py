"""Pictures of beams: outlines measured and simulated, and the residuals between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import arc_length
from calibration.experiment.model import BeamTrial
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.turned import turned
from calibration.pages import BAND, COLOURS, FAINT, INK, Picture, paper, picture, plain, round_magnification
from calibration.study.calibration import Calibration
from tisim.view import View

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnEdge:
    """One traced edge of a photograph and its distances from the simulated edge.

    Attributes
    ----------
    traced : the points, shape (k, 2).
    nearest, normal : their projections onto the simulated edge, and its unit normals there, shape (k, 2).
    raw, left : distance along the normal as traced, and without the most likely nuisances, both corrected for
        the mesh error, shape (k,).
    along : distance of the points from the clamp along the traced edge, shape (k,).
    """

    traced: Array
    nearest: Array
    normal: Array
    raw: Array
    left: Array
    along: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnPhotograph:
    """sd: of the contour's error, as the lab states it."""

    name: str
    trial: str
    sd: float
    upper: DrawnEdge
    lower: DrawnEdge

    @property
    def edges(self) -> tuple[DrawnEdge, DrawnEdge]:
        return self.upper, self.lower

    @property
    def rms(self) -> tuple[float, float]:
        """rms distance as traced, and registered."""
        raw, left = (np.concatenate([getattr(e, n) for e in self.edges]) for n in ("raw", "left"))
        return float(np.sqrt(np.mean(raw**2))), float(np.sqrt(np.mean(left**2)))


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawn:
    """photographs of all trials; simulated: upper and lower edge by trial, free part, (m, 2) each; view: the
    same to turn around.

    rms of all points once nuisances are taken out: what the fit calls rms.
    """

    photographs: tuple[DrawnPhotograph, ...]
    simulated: Mapping[str, tuple[Array, Array]]
    view: View

    @property
    def rms(self) -> float:
        left = np.concatenate([e.left for p in self.photographs for e in p.edges])
        return float(np.sqrt(np.mean(left**2)))


def contours(outlines: ModelObjective[OutlineModel], chosen: Calibration) -> Drawn | None:
    """One simulation of each beam at the law's parameters; None where it has no equilibrium there.

    Nuisances are taken at these parameters, as the fit's last step takes them.
    """
    u = np.array(chosen.u)
    if not outlines.linearise(u):
        return None
    try:
        seen = outlines.model.seen(outlines.state(u))
    except ValueError:
        return None
    photographs, simulated = [], {}
    for s in seen:
        p = s.photograph
        n = len(p.outline.upper)
        upper, lower = (
            DrawnEdge(
                traced=traced,
                nearest=f.nearest,
                normal=f.normal,
                raw=s.raw[part],
                left=s.left[part],
                along=traced[0, 0] + arc_length(traced),
            )
            for traced, f, part in zip(
                (p.outline.upper, p.outline.lower), s.projections, (slice(n), slice(n, None)), strict=True
            )
        )
        photographs.append(
            DrawnPhotograph(name=p.name, trial=p.trial.id, sd=p.outline.sd, upper=upper, lower=lower)
        )
        simulated[p.trial.id] = (s.simulated[0], s.simulated[1])
    view = turned(seen, title=f"Measured outlines over the beams of {chosen.label}")
    return Drawn(photographs=tuple(photographs), simulated=simulated, view=view)


_SIDES = (("upper edge", COLOURS[0]), ("lower edge", COLOURS[1]))
_MOST = 60  # panels of one picture


def draw_trial(drawn: Drawn, trial: BeamTrial, label: str) -> Picture:
    """One beam: to scale, and with its residuals magnified."""
    photographs = [p for p in drawn.photographs if p.trial == trial.id]
    lines = drawn.simulated[trial.id]
    everything = 1e3 * np.vstack([*lines, *(e.traced for p in photographs for e in p.edges)])
    low, high = everything.min(axis=0), everything.max(axis=0)
    size = high - low
    factor = _factor(photographs, float(size.max()))
    margin = 0.1 * float(size.max())  # of what is magnified, and of the clamps
    figure = paper(
        11.0, float(np.clip(5.0 * (size[1] + 2 * margin) / (size[0] + 2 * margin) + 1.4, 2.0, 7.0))
    )
    true, magnified = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes in (true, magnified):
        plain(axes).set_aspect("equal", adjustable="box")
        axes.set_xlabel("x / mm", fontsize=9)
        axes.axvspan(-margin, 0.0, color=BAND, lw=0)
        if trial.supports == "clamped-clamped":
            axes.axvspan(1e3 * trial.free_length, high[0] + margin, color=BAND, lw=0)
    true.set_xlim(-margin, high[0] + margin)
    true.set_ylim(low[1] - margin, high[1] + margin)
    true.set_ylabel("z / mm", fontsize=9)
    _simulated(true, lines, 1.1, INK, f"simulated, {label}")
    _simulated(magnified, lines, 0.8, FAINT, "simulated")
    for i, p in enumerate(photographs):
        _photograph(true, magnified, p, COLOURS[i % len(COLOURS)], factor)
    true.set_title("traced, registered by the fit", fontsize=9, loc="left")
    magnified.set_title(f"residuals, {factor:g} times magnified", fontsize=9, loc="left")
    if len(photographs) <= 8:
        handles, names = true.get_legend_handles_labels()
        figure.legend(
            handles, names, loc="outside upper left", ncols=min(5, len(names)), fontsize=8, frameon=False
        )
    return picture(
        figure,
        f"beam-{trial.id}",
        f"{trial.id}: outline traced (dots; faint crosses: before the registration that the fit found) and"
        f" simulated (line) with {label}; right, the distance that is left, {factor:g} times magnified.",
    )


def draw_residuals(drawn: Drawn, name: str, label: str) -> Picture:
    """Residuals along each photograph's edges, one panel a photograph, one scale."""
    shown = drawn.photographs[:_MOST]
    columns = min(3, len(shown))
    rows = ceil(len(shown) / columns)
    figure = paper(max(6.0, 3.7 * columns), 0.5 + 2.1 * rows)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for axes, p in zip(grid.flat, shown, strict=False):
        _panel(axes, p)
    for axes in grid.flat[len(shown) :]:
        axes.set_visible(False)
    for row in grid:
        row[0].set_ylabel("residual / mm", fontsize=8)
    handles, names = grid.flat[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper left", ncols=3, fontsize=8, frameon=False)
    left_out = len(drawn.photographs) - len(shown)
    more = f" The first {_MOST} photographs are shown, {left_out} are not." if left_out else ""
    return picture(
        figure,
        f"{name}-residuals",
        f"Traced minus simulated ({label}) along the edge's normal, once registration and the other nuisances"
        " are taken out; positive upwards. Band: two standard deviations of the contour's error, as the lab"
        f" states it.{more}",
    )


def _panel(axes: Any, p: DrawnPhotograph) -> None:
    plain(axes)
    axes.axhspan(-2e3 * p.sd, 2e3 * p.sd, color=BAND, lw=0, label="± 2 sd of the contour")
    axes.axhline(0.0, color=FAINT, lw=0.6)
    for edge, (side, colour) in zip(p.edges, _SIDES, strict=True):
        axes.plot(1e3 * edge.along, 1e3 * edge.left, color=colour, lw=1.1, label=side)
    raw, left = p.rms
    axes.set_title(f"{p.name}\nrms {left * 1e3:.3f} mm (as traced {raw * 1e3:.2f})", fontsize=8, loc="left")
    axes.set_xlim(left=0.0)
    axes.set_xlabel("along the edge / mm", fontsize=8)


def _photograph(true: Any, magnified: Any, p: DrawnPhotograph, colour: str, factor: float) -> None:
    for k, edge in enumerate(p.edges):
        every = max(1, len(edge.nearest) // 40)
        at = 1e3 * (edge.nearest + edge.left[:, None] * edge.normal)
        true.plot(*(1e3 * edge.traced[::every]).T, "x", ms=3, mew=0.5, color=FAINT, zorder=1)
        text = f"traced, {p.name.removeprefix(p.trial + ' ')}" if k == 0 else None
        true.plot(*at[::every].T, "o", ms=2.2, color=colour, label=text, zorder=3)
        moved = 1e3 * (edge.nearest + factor * edge.left[:, None] * edge.normal)
        magnified.plot(*moved.T, "-", lw=1.0, color=colour)


def _simulated(axes: Any, lines: tuple[Any, Any], width: float, colour: str, text: str) -> None:
    for k, line in enumerate(lines):
        axes.plot(*(1e3 * line).T, "-", lw=width, color=colour, label=text if k == 0 else None, zorder=2)


def _factor(photographs: list[DrawnPhotograph], size_mm: float) -> float:
    """A round magnification that makes the largest residual about a tenth of the picture."""
    largest = 1e3 * max(float(np.abs(e.left).max()) for p in photographs for e in p.edges)
    return round_magnification(0.08 * size_mm / largest) if largest > 0.0 else 1.0
