"""Pictures of a report: learning curve, best, median and worst test poke, force against depth.

Figures are made outside pyplot: a notebook keeps its backend, and none has to be closed.
"""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from learn.data import Store
from learn.metrics import Predictions
from learn.models import Pokes, Scene

Floats = NDArray[np.float64]


def ranked_pokes(predictions: Predictions) -> dict[str, int]:
    """Pokes with the smallest, the middle and the largest mean distance over their frames, each once.

    Two pokes have no median; a single poke is "only".
    """
    pokes = np.unique(predictions.poke)
    means = np.array([predictions.distance_mm[predictions.poke == p].mean() for p in pokes])
    order = [int(p) for p in pokes[np.argsort(means)]]
    if len(order) == 1:
        return {"only": order[0]}
    if len(order) == 2:
        return {"best": order[0], "worst": order[1]}
    return {"best": order[0], "median": order[len(order) // 2], "worst": order[-1]}


def draw_learning(logs: dict[str, list[dict[str, Any]]]) -> Figure:
    """Training loss and validation error against the epoch; logs: lines of `log.jsonl` by run."""
    figure = Figure(figsize=(11, 3.2), layout="constrained")
    axes = figure.subplots(1, 2)
    heads = {"train_loss": "training loss", "validation_mean_mm": "validation, mean distance [mm]"}
    for axis, (key, head) in zip(axes, heads.items(), strict=True):
        for name, lines in logs.items():
            known = [(line["epoch"] + 1, line[key]) for line in lines if key in line]
            if known:
                axis.plot(*zip(*known, strict=True), label=name)
        axis.set(title=head, xlabel="epoch")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    if len(logs) > 1:
        axes[0].legend(fontsize=8)
    return figure


def draw_poke(store: Store, predictions: Predictions, poke: int, title: str) -> Figure:
    """A poke's deepest frame: section along the push, true and predicted displacement, and the error."""
    mine = np.flatnonzero(predictions.poke == poke)
    frame = mine[predictions.depth[mine].argmax()]
    points = store.setup_of(poke).points
    side = round(len(points) ** 0.5)
    start, push = store.path_start[poke], store.direction[poke]
    figure = Figure(figsize=(15, 3.4), layout="constrained")
    axes = figure.subplots(1, 4)
    depth, shape = predictions.depth[frame] * 1e3, store.shapes[store.shape[poke]]
    error = predictions.distance_mm[frame].reshape(side, side)
    figure.suptitle(
        f"{title}: poke {poke}, {shape}, {predictions.softness[frame]}, {depth:.1f} mm deep; "
        f"error {error.mean():.3f} mm on average, {error.max():.2f} mm at most"
    )
    _cut(axes[0], points, predictions.truth[frame], predictions.predicted[frame], start, push)
    reach = [v * 1e3 for v in (points[0, 0], points[-1, 0], points[0, 1], points[-1, 1])]
    size = {"simulated |u|": predictions.truth[frame], "predicted |u|": predictions.predicted[frame]}
    top = max(float(np.linalg.norm(v, axis=1).max()) for v in size.values()) * 1e3
    for axis, (name, field) in zip(axes[1:3], size.items(), strict=True):
        values = np.linalg.norm(field, axis=1).reshape(side, side) * 1e3
        _map(figure, axis, values, reach, name, start, "viridis", top)
    _map(figure, axes[3], error, reach, "error", start, "magma", None)
    return figure


def draw_forces(predictions: Predictions) -> Figure:
    """Force against depth: up to four pokes per softness level, simulated (line), predicted (crosses)."""
    names = sorted({str(s) for s in predictions.softness})
    figure = Figure(figsize=(max(6.0, 4.6 * len(names)), 3.4), layout="constrained")
    axes = figure.subplots(1, len(names), squeeze=False)
    for axis, name in zip(axes[0], names, strict=True):
        pokes = np.unique(predictions.poke[predictions.softness == name])
        for k, poke in enumerate(pokes[np.linspace(0, len(pokes) - 1, min(4, len(pokes))).astype(int)]):
            mine = np.flatnonzero(predictions.poke == poke)
            mine = mine[np.argsort(predictions.depth[mine])]
            axis.plot(
                predictions.depth[mine] * 1e3, predictions.force[mine], color=f"C{k}", label=f"poke {poke}"
            )
            axis.plot(predictions.depth[mine] * 1e3, predictions.force_predicted[mine], "x", color=f"C{k}")
        axis.set(title=f"{name}: line simulated, crosses predicted", xlabel="depth [mm]", ylabel="force [N]")
        axis.legend(fontsize=8)
    return figure


def draw_adaptation(before: Predictions, after: Predictions) -> Figure:
    """Adaptation of a run: force of four pokes, and both errors against the depth, before and after."""
    figure = Figure(figsize=(14, 3.8), layout="constrained")
    axes = figure.subplots(1, 3)
    pokes = ranked_pokes(before)
    for k, (name, poke) in enumerate(pokes.items()):
        mine = np.flatnonzero(before.poke == poke)  # the frames of both are the same, in one order
        mine = mine[np.argsort(before.depth[mine])]
        depth, colour = before.depth[mine] * 1e3, f"C{k}"
        axes[0].plot(depth, before.force[mine], color=colour, label=f"poke {poke}, {name} as trained")
        axes[0].plot(depth, before.force_predicted[mine], ":", color=colour)
        axes[0].plot(depth, after.force_predicted[mine], "x", color=colour)
    axes[0].set(title="line simulated, dots as trained, crosses adapted", ylabel="force [N]")
    axes[0].legend(fontsize=8)
    for part, style, label in ((before, ":", "as trained"), (after, "-", "adapted")):
        band = np.ceil(part.depth * 1e3 - 1e-6)
        depths = np.unique(band)
        mean = [part.distance_mm[band == d].mean() for d in depths]
        wrong = np.abs(part.force_predicted - part.force) / part.force
        axes[1].plot(depths, mean, style, color="C0", label=label)
        axes[2].plot(depths, [100 * wrong[band == d].mean() for d in depths], style, color="C1", label=label)
    axes[1].set(title="mean error at contact points left out", ylabel="error [mm]")
    axes[2].set(title="error of the force", ylabel="error [%]")
    for axis in axes:
        axis.set(xlabel="depth [mm]")
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    for axis in axes[1:]:
        axis.legend(fontsize=8)
    return figure


def draw_prediction(
    scene: Scene,
    pokes: Pokes,
    u: NDArray[np.float32],
    *,
    radius: Floats | None,
    title: str,
    marks: Floats | None = None,
) -> Figure:
    """One predicted poke: section along the push with indenter and inclusion, and a map of the top.

    The map shows the radius of the intervals, or the displacement without intervals, and `marks`.

    Parameters
    ----------
    scene, pokes : the model's input, one poke.
    u, radius : displacement (n, 3) and radius of its interval (n,) [m].
    marks : points to mark on the map (m, 3) [m].
    """
    points, start, push = scene.points.numpy(), pokes.start[0].numpy(), pokes.direction[0].numpy()
    depth, top = float(pokes.depth[0]), scene.points[0, 2].item()
    heading = push[:2] / np.linalg.norm(push[:2]) if np.linalg.norm(push[:2]) > 1e-6 else np.array([1.0, 0.0])
    figure = Figure(figsize=(12, 4.2), layout="constrained")
    cut, flat = figure.subplots(1, 2, width_ratios=[1.6, 1])
    figure.suptitle(title)
    offset = points[:, :2] - start[:2]
    strip = np.flatnonzero(np.abs(offset @ np.array([-heading[1], heading[0]])) < _strip(points))
    strip = strip[np.argsort(offset[strip] @ heading)]
    rigid = scene.rigid[scene.rigid_index[pokes.geometry[0]]].numpy()
    along, levels = offset[strip] @ heading, scene.level_depth.numpy()
    ahead, upper, lower = _section(points, rigid > 0, levels, start, heading)
    if np.isfinite(upper).any():
        height = (top - upper) * 1e3, (top - lower) * 1e3
        cut.fill_between(ahead * 1e3, *height, color="0.75", linewidth=0, label="inclusion, by columns")
    cut.plot(along * 1e3, np.full(len(strip), top * 1e3), ":", color="0.5", label="rest surface")
    now = points[strip] + u[strip]
    cut.plot((now[:, :2] - start[:2]) @ heading * 1e3, now[:, 2] * 1e3, "C0.-", label="predicted surface")
    cut.plot(*_indenter(scene, push, depth, heading, start[2]).T * 1e3, color="C3", label="indenter")
    cut.set(
        title="cut along the push, through the grid points next to it", xlabel="mm from first contact",
        ylabel="height [mm]", xlim=(-30, 30), ylim=((top - levels[-1]) * 1e3, top * 1e3 + 8), aspect="equal",
    )  # fmt: skip
    cut.legend(fontsize=8, loc="lower right")
    side = round(len(points) ** 0.5)
    shown = np.linalg.norm(u, axis=1) if radius is None else radius
    reach = [v * 1e3 for v in (points[0, 0], points[-1, 0], points[0, 1], points[-1, 1])]
    name = "displacement" if radius is None else "radius of the 90 % interval"
    _map(figure, flat, shown.reshape(side, side) * 1e3, reach, name, start, "viridis", None)
    columns = (rigid.sum(axis=1) > 0).reshape(side, side).astype(float)
    if columns.any():
        x, y = points[:side, 0] * 1e3, points[::side, 1] * 1e3
        flat.contour(x, y, columns, levels=[0.5], colors="white", linewidths=1, linestyles="--")
    if marks is not None:
        flat.plot(*marks[:, :2].T * 1e3, "o", mfc="none", mec="white", markersize=4, label="points asked for")
        flat.legend(fontsize=8, loc="lower right", facecolor="0.4", labelcolor="white")
    flat.set(ylabel="y [mm]")
    return figure


def _indenter(scene: Scene, push: Floats, depth: float, heading: Floats, height: float) -> Floats:
    """Outline of the indenter in the plane of the push: along the heading, and height [m], (m, 2)."""
    radius, edge = scene.rod_radius, scene.rod_edge
    turn = np.linspace(0, np.pi / 2, 20)
    aside = np.concatenate([radius - edge + edge * np.sin(turn), [radius]])
    ahead = np.concatenate([edge * (np.cos(turn) - 1), [-0.03]])
    outline = np.concatenate([np.column_stack([ahead, -aside])[::-1], np.column_stack([ahead, aside])])
    axis = np.array([push[:2] @ heading, push[2]])
    across = np.array([-axis[1], axis[0]])
    return np.array([0.0, height]) + (depth + outline[:, :1]) * axis + outline[:, 1:] * across


def encoded(figure: Figure) -> str:
    """The figure as base64 of a PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return base64.b64encode(buffer.getvalue()).decode()


def _cut(axis: Axes, points: Floats, truth: Floats, predicted: Floats, start: Floats, push: Floats) -> None:
    """Draw the positions of the points in a strip along the push's heading."""
    heading = push[:2] / max(float(np.linalg.norm(push[:2])), 1e-9)
    if np.linalg.norm(push[:2]) < 1e-6:
        heading = np.array([1.0, 0.0])
    offset = points[:, :2] - start[:2]
    beside = offset @ np.array([-heading[1], heading[0]])
    strip = np.flatnonzero(np.abs(beside) < _strip(points))
    strip = strip[np.argsort(offset[strip] @ heading)]
    for name, u, style in (("simulated", truth, "k-"), ("predicted", predicted, "C1x")):
        place = points[strip] + u[strip]
        along = (place[:, :2] - start[:2]) @ heading
        axis.plot(along * 1e3, (place[:, 2] - start[2]) * 1e3, style, label=name, markersize=5)
    axis.set(title="cut along the push", xlabel="mm", ylabel="mm", xlim=(-30, 30))
    axis.legend(fontsize=8)


def _section(
    points: Floats, rigid: NDArray[np.bool_], levels: Floats, start: Floats, heading: Floats
) -> tuple[Floats, Floats, Floats]:
    """Vertical section of the inclusion through first contact, each place in the cell of its grid point.

    Distances along the heading, and depths of the inclusion's upper and lower side there [m], (k,); NaN where
    there is none. `rigid` is (n, levels), and `levels` are the depths of the levels' middles [m].
    """
    from scipy.spatial import cKDTree

    ahead = np.linspace(-0.03, 0.03, 601)
    away, column = cKDTree(points[:, :2]).query(start[:2] + ahead[:, None] * heading, p=np.inf)
    in_block = np.asarray(away) <= _strip(points)
    inside = rigid[column] & in_block[:, None]
    half = 0.5 * (levels[1] - levels[0])
    upper = levels[inside.argmax(axis=1)] - half
    lower = levels[::-1][inside[:, ::-1].argmax(axis=1)] + half
    none = ~inside.any(axis=1)
    return ahead, np.where(none, np.nan, upper), np.where(none, np.nan, lower)


def _strip(points: Floats) -> float:
    """Half of the width of a strip that holds a row of points at any heading [m]."""
    from scipy.spatial import cKDTree

    apart = np.asarray(cKDTree(points[:, :2]).query(points[:, :2], k=2)[0])
    return 0.55 * float(apart[:, 1].max())


def _map(
    figure: Figure,
    axis: Axes,
    values: Floats,
    reach: list[float],
    title: str,
    start: Floats,
    colours: str,
    top: float | None,
) -> None:
    # the square root makes the far field visible beside the contact
    norm = PowerNorm(0.5, vmin=0, vmax=top if top is not None else max(float(values.max()), 1e-9))
    # from the first to the last point, and half a cell beyond: a pixel's centre is its point
    x0, x1, y0, y1 = reach
    dx, dy = 0.5 * (x1 - x0) / (values.shape[1] - 1), 0.5 * (y1 - y0) / (values.shape[0] - 1)
    extent = (x0 - dx, x1 + dx, y0 - dy, y1 + dy)
    picture = axis.imshow(values, origin="lower", extent=extent, cmap=colours, norm=norm)
    axis.plot(start[0] * 1e3, start[1] * 1e3, "+", color="white")
    axis.set(title=f"{title} [mm]", xlabel="x [mm]")
    figure.colorbar(picture, ax=axis, shrink=0.85)
