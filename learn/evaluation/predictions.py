"""Predictions of a model with the simulated truth: on dataset parts, other clouds and rotated scenes."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from learn.data import Batch, MemoryDataset, Setup, Store, make_batch
from learn.data.clouds import SurfaceField
from learn.metrics import Predictions, join_predictions
from learn.models import Pokes, Response, Scene, Scenes, pokes_of
from learn.models.at_points import place
from learn.quantities import covariates, cover_at, interior_of

Floats = NDArray[np.float64]
Cloud = Callable[[Setup], Floats]  # points (n, 3) on a setup's top face [m]


class Predicts(Protocol):
    """Anything that predicts pokes: `learn.models.Model` and `learn.baselines.Baseline`."""

    def prepare(self, scene: Scene) -> Any: ...

    def encode(self, scene: Scene, prepared: Any = None) -> Any: ...

    def decode(self, encoded: Any, pokes: Pokes) -> Response: ...


def predict_part(
    model: Predicts,
    scenes: Scenes,
    data: MemoryDataset,
    *,
    batch: int = 64,
    prepared: Sequence[Any] | None = None,
) -> Predictions:
    """Predictions of all frames of a part; `scenes` are those of the store, on the model's device.

    `prepared`: what `model.prepare` gives for each scene, where that is known.
    """
    return predict_batches(model, scenes, data.store, data.batches(batch), prepared)


@torch.no_grad()
def predict_batches(
    model: Predicts,
    scenes: Scenes,
    store: Store,
    batches: Iterable[Batch],
    prepared: Sequence[Any] | None = None,
) -> Predictions:
    """Predictions of these batches, of each in the order of its scenes, which are on the model's device."""
    parts: list[Predictions] = []

    @functools.cache
    def encode(k: int) -> Any:
        scene = scenes.scenes[k]
        return model.encode(scene, model.prepare(scene) if prepared is None else prepared[k])

    points = functools.cache(lambda k: scenes.scenes[k].points.cpu().numpy())
    interior = functools.cache(
        lambda geometry: interior_of(store.setups[store.setup_index[geometry]], store.profile[geometry])
    )

    def cover(poke: int) -> float:
        inside = interior(int(store.geometry[poke]))
        return 1e3 * cover_at(store.setup_of(poke), inside, store.path_start[poke], store.direction[poke])

    def covariates_of(poke: int, depth: float) -> Floats:
        start, direction = store.path_start[poke], store.direction[poke]
        inside = interior(int(store.geometry[poke]))
        return covariates(store.setup_of(poke), inside, start=start, direction=direction, depth=depth)

    for k, batch in scenes.each(batches):
        found = model.decode(encode(k), pokes_of(batch.to(scenes.device)))
        away = np.linalg.norm(points(k)[None] - batch.start.numpy()[:, None], axis=2)
        poke = store.frame_poke[batch.frame.numpy()]
        parts.append(
            Predictions(
                truth=batch.displacement.numpy(),
                predicted=found.displacement.float().cpu().numpy(),
                force=batch.force.double().numpy(),
                force_predicted=found.force.double().cpu().numpy(),
                away=away,
                depth=batch.depth.numpy(),
                poke=poke,
                softness=np.array(store.softness_names)[store.softness[poke]],
                shape=np.array(store.shapes)[store.shape[poke]],
                cover=np.array([cover(int(index)) for index in poke]),
                covariates=np.array(
                    [covariates_of(int(p), float(d)) for p, d in zip(poke, batch.depth, strict=True)]
                ),
                spread=_or_zero(found.spread, away.shape),
                force_spread=_or_zero(found.force_spread, poke.shape),
                clock=batch.clock.double().cpu().numpy(),
            )
        )
    return join_predictions(parts)


def _or_zero(spread: torch.Tensor | None, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The spread, or zeros for a single model."""
    return np.zeros(shape) if spread is None else spread.double().cpu().numpy()


def predict_on(
    model: Predicts,
    store: Store,
    rows: NDArray[np.int64],
    cloud: Cloud,
    surfaces: SurfaceField | None = None,
    *,
    device: torch.device | str = "cpu",
) -> Predictions:
    """Predictions at other points of the top face, against interpolation of each poke's own surface mesh.

    `cloud` makes the points of a setup's top face, as many for each; the model sees them as
    `learn.models.at_points.place` places them. `device` is the model's.
    """
    field = surfaces or SurfaceField(store, np.unique(store.frame_poke[rows]).tolist())
    placed = {id(setup): place(setup, cloud(setup)) for setup in store.setups}
    found: list[Predictions] = []
    for k in range(max(len(one.clouds) for one in placed.values())):

        def points(setup: Setup, k: int = k) -> Floats:
            clouds = placed[id(setup)].clouds
            return clouds[min(k, len(clouds) - 1)]

        scenes = Scenes.of(store, points).to(device)
        found.append(predict_batches(model, scenes, store, _batches(store, rows, points, field)))
    setup = store.setup_index[store.geometry[found[0].poke]]

    def at_points(name: str) -> NDArray[Any]:
        values = [getattr(one, name) for one in found]
        each = [one.pick([v[setup == k] for v in values]) for k, one in enumerate(placed.values())]
        out = np.concatenate(each)
        out[np.argsort(setup, kind="stable")] = out.copy()
        return out

    return replace(found[0], **{name: at_points(name) for name in ("truth", "predicted", "away", "spread")})


def interpolation_error_mm(store: Store, rows: NDArray[np.int64]) -> float:
    """Mean distance [mm] between interpolated and stored displacement at the grid's points."""
    field = SurfaceField(store, np.unique(store.frame_poke[rows]).tolist())
    wrong = []
    for batch in _batches(store, rows, lambda setup: setup.points, field):
        frames = batch.frame.numpy()
        first = int(frames[0])
        stored = torch.from_numpy(store.displacement(slice(first, int(frames[-1]) + 1))[frames - first])
        wrong.append(float((batch.displacement - stored).norm(dim=2).mean()))
    return float(np.mean(wrong)) * 1e3


def _batches(store: Store, rows: NDArray[np.int64], cloud: Cloud, surfaces: SurfaceField) -> Iterator[Batch]:
    """Yield one batch per poke."""
    for poke in np.unique(store.frame_poke[rows]):
        mine = rows[store.frame_poke[rows] == poke]
        yield make_batch(store, mine, surfaces.displacement(mine, cloud(store.setup_of(poke))))


@dataclass(frozen=True)
class SymmetryError:
    """Largest error over points, pokes and rotations: displacement [mm]; force relative to its magnitude."""

    displacement_mm: float
    force: float


@torch.no_grad()
def symmetry_error(
    model: Predicts, scenes: Scenes, pokes: Pokes, *, about_normal: bool = False, rotations: int = 5
) -> SymmetryError:
    """Difference between the prediction for a rotated scene and the rotated prediction.

    Parameters
    ----------
    about_normal : quarter turns about the vertical and no translation, as in the paper; otherwise random
        rotations about any axis and translations by up to 0.1 m.
    rotations : number of random rotations.
    """
    worst = [
        _symmetry_error(model, scenes.scenes[k], part, _motions(rotations, about_normal=about_normal))
        for k, _, part in scenes.parts(pokes)
    ]
    return SymmetryError(max(e.displacement_mm for e in worst), max(e.force for e in worst))


def _motions(rotations: int, *, about_normal: bool) -> list[tuple[Floats, Floats]]:
    """Rotations (3, 3) and translations (3,) [m]."""
    if about_normal:
        quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        return [(np.linalg.matrix_power(quarter, k + 1), np.zeros(3)) for k in range(3)]
    random = np.random.default_rng(0)
    return [
        (Rotation.random(None, random).as_matrix(), random.uniform(-0.1, 0.1, 3)) for _ in range(rotations)
    ]


def _symmetry_error(
    model: Predicts, scene: Scene, pokes: Pokes, motions: list[tuple[Floats, Floats]]
) -> SymmetryError:
    device = scene.points.device
    pokes = replace(pokes, **{name: value.to(device) for name, value in vars(pokes).items()})
    still = model.decode(model.encode(scene, model.prepare(scene)), pokes)
    worst, worst_force = 0.0, 0.0
    for turn, shift in motions:
        q, t = (torch.from_numpy(a).to(device) for a in (turn, shift))
        turned = replace(scene, points=scene.points @ q.T + t, normals=scene.normals @ q.T)
        rod = replace(pokes, start=pokes.start @ q.T + t, direction=pokes.direction @ q.T)
        moved = model.decode(model.encode(turned, model.prepare(turned)), rod)
        apart = (moved.displacement.double() - still.displacement.double() @ q.T).norm(dim=2).max()
        worst = max(worst, float(apart) * 1e3)
        worst_force = max(worst_force, float(((moved.force - still.force) / still.force).abs().max()))
    return SymmetryError(worst, worst_force)
