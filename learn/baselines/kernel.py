"""An analytic kernel fitted linearly: fields that fall like a point load's on an elastic half space.

u = depth sum_k c_k g_k v_k: g falls as 1 / sqrt(r^2 + a^2) (Boussinesq) times exp(-r / L) (the base below),
v is the surface normal, the direction from first touch or that of the push; factors of the push's
inclination, the depth, and the soft tissue below the contact. Equivariant, like our model.
"""

from __future__ import annotations

import numpy as np

from learn.baselines._baseline import Baseline, Floats, describe, force_unit, prediction
from learn.data import MemoryDataset
from learn.models import Pokes, Prediction, Scene, pokes_of

_CORES = (2.5e-3, 5e-3, 10e-3)  # m, a
_RANGES = (10e-3, 30e-3)  # m, L
_RIDGE = 1e-6


class Kernel(Baseline):
    def fit(self, data: MemoryDataset, scene: Scene) -> None:
        normal, right = np.zeros((1, 1)), np.zeros(1)
        logs, columns = [], []
        for batch in data.batches(16):
            pokes = pokes_of(batch)
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

    def answer(self, scene: Scene, pokes: Pokes) -> Prediction:
        field = (self._basis(scene, pokes) @ self.coefficients).reshape(len(pokes.depth), -1, 3)
        force = np.exp(self._force_basis(scene, pokes) @ self.force_coefficients)
        return prediction(field * pokes.depth.numpy()[:, None, None], force * force_unit(scene, pokes))

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
