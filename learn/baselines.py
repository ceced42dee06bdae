"""Baselines for the models: no motion, the nearest training poke, principal modes, an analytic kernel.

Each is fitted to a training part and then evaluated like a model, on the grids that it was fitted on.
`BASELINES` holds them by their names in the tables; to add one, subclass `Baseline` and add it there.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from learn.data import MemoryDataset
from learn.models import Pokes, Response, Scene, Scenes, pokes_of

Floats = NDArray[np.float64]
MODES = 64
_STEPS, _LEARNING_RATE, _BATCH = 3000, 2e-3, 128  # of the network behind the principal modes
_DEPTH = 2e-3  # [m], difference in depth that weighs as much as one unit of `describe`
_CORES = (2.5e-3, 5e-3, 10e-3)  # [m], a of the kernel
_RANGES = (10e-3, 30e-3)  # [m], L of the kernel
_RIDGE = 1e-6


class Baseline(ABC):
    """A prediction fitted to a training part; evaluated like a model, on the grids it was fitted on."""

    @abstractmethod
    def fit(self, data: MemoryDataset, scenes: Scenes) -> None:
        """Fit to the training part."""

    @abstractmethod
    def predict(self, scene: Scene, pokes: Pokes) -> Response:
        """Displacement and force of b pokes."""

    def prepare(self, scene: Scene) -> Any:  # noqa: ARG002
        return None

    def encode(self, scene: Scene, prepared: Any = None) -> Scene:  # noqa: ARG002
        return scene

    def decode(self, encoded: Scene, pokes: Pokes) -> Response:
        return self.predict(encoded, pokes)


def describe(scene: Scene, pokes: Pokes) -> Floats:
    """Features of a poke of about unit size, shape (b, 3 + 3 + 1 + 16), for grids of rows and columns.

    First contact, direction, soft tissue below it, and a coarse map of the interior (4 x 4 fractions of rigid
    columns).
    """
    start = pokes.start.numpy()
    clear = torch.cumprod(1 - scene.rigid, dim=2).mean(dim=2)  # (k, n)
    inclusion = scene.rigid_index[pokes.geometry]
    near = torch.cdist(pokes.start, scene.points).argmin(dim=1)
    side = round(len(scene.points) ** 0.5)
    maps = (1 - clear).reshape(-1, 1, side, side)
    coarse = torch.nn.functional.adaptive_avg_pool2d(maps, 4).reshape(len(maps), 16)
    return np.column_stack(
        [
            (start - scene.points.mean(dim=0).numpy()) / 0.02,
            pokes.direction.numpy() / 0.5,
            clear[inclusion, near].numpy() / 0.3,
            coarse[inclusion].numpy() / 0.3,
        ]
    )


def force_unit(scene: Scene, pokes: Pokes) -> Floats:
    """Unit of force: shear modulus x indenter radius x depth [N], shape (b,)."""
    return np.asarray(pokes.modulus.numpy() * scene.rod_radius * pokes.depth.numpy())


def response(displacement: NDArray[np.floating[Any]], force: NDArray[np.floating[Any]]) -> Response:
    """A response from NumPy arrays."""
    return Response(
        displacement=torch.from_numpy(np.ascontiguousarray(displacement, dtype=np.float32)),
        force=torch.from_numpy(np.ascontiguousarray(force, dtype=np.float32)),
    )


class Zero(Baseline):
    """No motion; the force is the training part's mean."""

    def fit(self, data: MemoryDataset, scenes: Scenes) -> None:  # noqa: ARG002
        self.force = float(np.mean([float(b.force.mean()) for b in data.batches(1)]))

    def predict(self, scene: Scene, pokes: Pokes) -> Response:
        b = len(pokes.depth)
        return response(np.zeros((b, len(scene.points), 3)), np.full(b, self.force))


class Nearest(Baseline):
    """The most similar training poke at the most similar depth, scaled by depth and modulus."""

    def fit(self, data: MemoryDataset, scenes: Scenes) -> None:
        batch = data.__getitems__(np.arange(len(data)))
        pokes = pokes_of(batch)
        about = scenes.rows(describe, pokes)
        self.features = np.column_stack([about[:, :7], pokes.depth.numpy() / _DEPTH])
        self.field = batch.displacement.numpy() / pokes.depth.numpy()[:, None, None].astype(np.float32)
        self.force = batch.force.numpy() / scenes.rows(force_unit, pokes)

    def predict(self, scene: Scene, pokes: Pokes) -> Response:
        mine = np.column_stack([describe(scene, pokes)[:, :7], pokes.depth.numpy() / _DEPTH])
        best = ((mine[:, None] - self.features[None]) ** 2).sum(axis=2).argmin(axis=1)
        field = self.field[best] * pokes.depth.numpy()[:, None, None]
        return response(field, self.force[best] * force_unit(scene, pokes))


class Modes(Baseline):
    """Principal modes of the displacement over depth, with coefficients from a small network."""

    def fit(self, data: MemoryDataset, scenes: Scenes) -> None:
        batch = data.__getitems__(np.arange(len(data)))
        pokes = pokes_of(batch)
        fields = batch.displacement.numpy().reshape(len(data), -1) / pokes.depth.numpy()[:, None].astype("f4")
        self.mean = fields.mean(axis=0)
        _, _, modes = np.linalg.svd(fields - self.mean, full_matrices=False)
        self.modes = modes[: min(MODES, len(modes))]
        wanted = (fields - self.mean) @ self.modes.T
        self.unit = wanted.std(axis=0).max() + 1e-12
        log_force = np.log(batch.force.numpy() / scenes.rows(force_unit, pokes))
        self.log_force = float(log_force.mean())
        x = torch.from_numpy(scenes.rows(self._inputs, pokes)).float()
        y = np.column_stack([wanted / self.unit, (log_force - self.log_force) * 0.3])
        self._train(x, torch.from_numpy(y).float())

    def _train(self, x: torch.Tensor, y: torch.Tensor) -> None:
        with torch.random.fork_rng():
            torch.manual_seed(0)
            self.net = nn.Sequential(
                nn.Linear(x.shape[1], 128),
                nn.SiLU(),
                nn.Linear(128, 128),
                nn.SiLU(),
                nn.Linear(128, y.shape[1]),
            )
            optimiser = torch.optim.AdamW(self.net.parameters(), lr=_LEARNING_RATE, weight_decay=0.05)
            schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, _STEPS)
            for _ in range(_STEPS):
                pick = torch.randint(len(x), (min(_BATCH, len(x)),))
                loss = (self.net(x[pick]) - y[pick]).square().sum(dim=1).mean()
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
                schedule.step()

    def predict(self, scene: Scene, pokes: Pokes) -> Response:
        with torch.no_grad():
            out = self.net(torch.from_numpy(self._inputs(scene, pokes)).float()).numpy()
        field = (out[:, :-1] * self.unit) @ self.modes + self.mean
        force = np.exp(out[:, -1] / 0.3 + self.log_force) * force_unit(scene, pokes)
        return response(field.reshape(len(out), -1, 3) * pokes.depth.numpy()[:, None, None], force)

    def _inputs(self, scene: Scene, pokes: Pokes) -> Floats:
        return np.column_stack(
            [describe(scene, pokes), pokes.depth.numpy() / 5e-3, np.log(pokes.modulus.numpy()) - 9.7]
        )


class Kernel(Baseline):
    """An analytic kernel fitted linearly: fields that decay like a point load's on an elastic half-space.

    u = depth sum_k c_k g_k v_k with g = exp(-r / L) / sqrt(r^2 + a^2): Boussinesq's decay times that of the
    base below. v is the surface normal, the direction from first contact or the push; c_k depends linearly on
    inclination, depth and the soft tissue below the contact. It is equivariant.
    """

    def fit(self, data: MemoryDataset, scenes: Scenes) -> None:
        normal, right = np.zeros((1, 1)), np.zeros(1)
        logs, columns = [], []
        for k, batch in scenes.each(data.batches(16)):
            scene, pokes = scenes.scenes[k], pokes_of(batch)
            basis = self._basis(scene, pokes)
            truth = (batch.displacement.numpy() / pokes.depth.numpy()[:, None, None]).reshape(-1)
            normal, right = normal + basis.T @ basis, right + basis.T @ truth
            columns.append(self._force_basis(scene, pokes))
            logs.append(np.log(batch.force.numpy() / force_unit(scene, pokes)))
        ridge = _RIDGE * np.trace(normal) / len(normal)
        self.coefficients = np.linalg.solve(normal + ridge * np.eye(len(normal)), right)
        self.force_coefficients = np.linalg.lstsq(np.concatenate(columns), np.concatenate(logs), rcond=None)[
            0
        ]

    def predict(self, scene: Scene, pokes: Pokes) -> Response:
        field = (self._basis(scene, pokes) @ self.coefficients).reshape(len(pokes.depth), -1, 3)
        force = np.exp(self._force_basis(scene, pokes) @ self.force_coefficients)
        return response(field * pokes.depth.numpy()[:, None, None], force * force_unit(scene, pokes))

    def _basis(self, scene: Scene, pokes: Pokes) -> Floats:
        r = scene.points.numpy()[None] - pokes.start.numpy()[:, None]
        push, normal = pokes.direction.numpy()[:, None], scene.normals.numpy()[None]
        square = (r**2).sum(axis=2)
        size = np.sqrt(square)
        along = (push * normal).sum(axis=2)
        soft = np.broadcast_to(describe(scene, pokes)[:, 6:7], size.shape)
        deep = np.broadcast_to(pokes.depth.numpy()[:, None] / 5e-3, size.shape)
        factors = (np.ones_like(size), along, deep, soft)
        turn = (r * push).sum(axis=2) / np.sqrt(square + _CORES[0] ** 2)
        vectors = (
            np.broadcast_to(normal, r.shape),
            r / np.sqrt(square + _CORES[0] ** 2)[..., None],
            np.broadcast_to(push, r.shape),
        )
        columns = [
            (_CORES[0] / np.sqrt(square + core**2) * np.exp(-size / reach) * factor)[..., None] * vector
            for core in _CORES
            for reach in _RANGES
            for factor in (*factors, turn)
            for vector in vectors
        ]
        return np.stack(columns, axis=-1).reshape(-1, len(columns))

    def _force_basis(self, scene: Scene, pokes: Pokes) -> Floats:
        depth = pokes.depth.numpy() / 5e-3
        about = describe(scene, pokes)
        return np.column_stack([np.ones_like(depth), np.log(depth), depth, about[:, 5], about[:, 6]])


BASELINES: dict[str, type[Baseline]] = {
    "zero displacement": Zero,
    "nearest training poke": Nearest,
    "PCA and MLP": Modes,
    "analytic kernel": Kernel,
}
