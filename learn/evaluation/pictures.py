"""Pictures of a report: best, median and worst test poke, and force against depth."""

from __future__ import annotations

import base64
import io

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from learn.data import Store
from learn.metrics import Cases

Floats = NDArray[np.float64]


def ranked_pokes(cases: Cases) -> dict[str, int]:
    """Pokes with the smallest, the middle and the largest mean distance over their frames."""
    pokes = np.unique(cases.poke)
    means = np.array([cases.distance_mm[cases.poke == p].mean() for p in pokes])
    order = pokes[np.argsort(means)]
    return {"best": int(order[0]), "median": int(order[len(order) // 2]), "worst": int(order[-1])}


def draw_poke(store: Store, cases: Cases, poke: int, title: str) -> Figure:
    """A poke's deepest frame: the surface cut along the push, displacement of both, error from above."""
    mine = np.flatnonzero(cases.poke == poke)
    frame = mine[cases.depth[mine].argmax()]
    side = round(len(store.points) ** 0.5)
    start, push = store.path_start[poke], store.direction[poke]
    figure, axes = plt.subplots(1, 4, figsize=(15, 3.4), layout="constrained")
    depth, shape = cases.depth[frame] * 1e3, store.shapes[store.shape[poke]]
    error = cases.distance_mm[frame].reshape(side, side)
    figure.suptitle(
        f"{title}: poke {poke}, {shape}, {cases.softness[frame]}, {depth:.1f} mm deep; "
        f"error {error.mean():.3f} mm on average, {error.max():.2f} mm at most"
    )
    _cut(axes[0], store.points, cases.truth[frame], cases.predicted[frame], start, push)
    reach = [
        v * 1e3 for v in (store.points[0, 0], store.points[-1, 0], store.points[0, 1], store.points[-1, 1])
    ]
    size = {"simulated |u|": cases.truth[frame], "predicted |u|": cases.predicted[frame]}
    top = max(float(np.linalg.norm(v, axis=1).max()) for v in size.values()) * 1e3
    for axis, (name, field) in zip(axes[1:3], size.items(), strict=True):
        values = np.linalg.norm(field, axis=1).reshape(side, side) * 1e3
        _map(figure, axis, values, reach, name, start, "viridis", top)
    _map(figure, axes[3], error, reach, "error", start, "magma", None)
    return figure


def draw_forces(cases: Cases) -> Figure:
    """Force against depth: up to four pokes a softness, simulated (line) and predicted (crosses)."""
    names = sorted({str(s) for s in cases.softness})
    figure, axes = plt.subplots(
        1, len(names), figsize=(4.6 * len(names), 3.4), layout="constrained", squeeze=False
    )
    for axis, name in zip(axes[0], names, strict=True):
        pokes = np.unique(cases.poke[cases.softness == name])
        for k, poke in enumerate(pokes[np.linspace(0, len(pokes) - 1, min(4, len(pokes))).astype(int)]):
            mine = np.flatnonzero(cases.poke == poke)
            mine = mine[np.argsort(cases.depth[mine])]
            axis.plot(cases.depth[mine] * 1e3, cases.force[mine], color=f"C{k}", label=f"poke {poke}")
            axis.plot(cases.depth[mine] * 1e3, cases.force_predicted[mine], "x", color=f"C{k}")
        axis.set(title=f"{name}: line simulated, crosses predicted", xlabel="depth [mm]", ylabel="force [N]")
        axis.legend(fontsize=8)
    return figure


def encoded(figure: Figure) -> str:
    """The figure as base64 of a PNG; it is closed."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    plt.close(figure)
    return base64.b64encode(buffer.getvalue()).decode()


def _cut(
    axis: plt.Axes, points: Floats, truth: Floats, predicted: Floats, start: Floats, push: Floats
) -> None:
    """Positions of the points in a strip along the push's heading."""
    heading = push[:2] / max(float(np.linalg.norm(push[:2])), 1e-9)
    if np.linalg.norm(push[:2]) < 1e-6:
        heading = np.array([1.0, 0.0])
    offset = points[:, :2] - start[:2]
    beside = offset @ np.array([-heading[1], heading[0]])
    strip = np.flatnonzero(np.abs(beside) < 1.7e-3)
    strip = strip[np.argsort(offset[strip] @ heading)]
    for name, u, style in (("simulated", truth, "k-"), ("predicted", predicted, "C1x")):
        place = points[strip] + u[strip]
        along = (place[:, :2] - start[:2]) @ heading
        axis.plot(along * 1e3, (place[:, 2] - start[2]) * 1e3, style, label=name, markersize=5)
    axis.set(title="cut along the push", xlabel="mm", ylabel="mm", xlim=(-30, 30))
    axis.legend(fontsize=8)


def _map(
    figure: Figure,
    axis: plt.Axes,
    values: Floats,
    reach: list[float],
    title: str,
    start: Floats,
    colours: str,
    top: float | None,
) -> None:
    picture = axis.imshow(values, origin="lower", extent=tuple(reach), cmap=colours, vmin=0, vmax=top)
    axis.plot(start[0] * 1e3, start[1] * 1e3, "+", color="white")
    axis.set(title=f"{title} [mm]", xlabel="x [mm]")
    figure.colorbar(picture, ax=axis, shrink=0.85)
