"""What a model is told: where the points lie and what is under them, and how the rod pokes."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from learn.data.batch import Batch
from learn.data.store import Store, rigid_masks


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """One point cloud on the tissue's surface over g kinds of interior. SI units.

    points (n, 3) float64: rest positions; normals (n, 3) float64: outward, unit. profile: stiffness codes
    under each point, 0 to 1 with 1 rigid, (g, n, levels) float32, top level first. rigid: 1 where a level is
    rigid, once a distinct inclusion, (k, n, levels) float32; rigid_index (g,): the inclusion of each
    interior. level_depth (levels,) float64 [m]. rod_radius, rod_edge [m]: as in `Store`.
    """

    points: Tensor
    normals: Tensor
    profile: Tensor
    rigid: Tensor
    rigid_index: Tensor
    level_depth: Tensor
    rod_radius: float
    rod_edge: float

    def to(self, device: torch.device | str) -> Scene:
        """The same scene on a device."""
        moved = {
            f.name: getattr(self, f.name).to(device) for f in fields(self) if not f.name.startswith("rod_")
        }
        return replace(self, **moved)

    def only(self, geometries: NDArray[np.int64]) -> Scene:
        """The same points over these interiors alone, so that no other is encoded; indices stay."""
        used = torch.from_numpy(np.unique(geometries)).to(self.rigid_index.device)
        kept, place = torch.unique(self.rigid_index[used], return_inverse=True)
        index = torch.zeros_like(self.rigid_index)
        index[used] = place
        return replace(self, rigid=self.rigid[kept], rigid_index=index)

    def at(self, points: NDArray[np.int64]) -> Scene:
        """Some of the points, by index."""
        some = torch.from_numpy(points).to(self.points.device)
        return replace(
            self,
            points=self.points[some],
            normals=self.normals[some],
            profile=self.profile[:, some],
            rigid=self.rigid[:, some],
        )


def make_scene(
    *,
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    profile: NDArray[np.uint8],
    level_depth: NDArray[np.float64],
    rod_radius: float,
    rod_edge: float,
) -> Scene:
    """The scene of any point cloud; profile as stored (255 = rigid), (g, n, levels)."""
    masks, index = rigid_masks(profile)
    return Scene(
        points=torch.from_numpy(np.ascontiguousarray(points)),
        normals=torch.from_numpy(np.ascontiguousarray(normals)),
        profile=torch.from_numpy(profile).float() / 255,
        rigid=torch.from_numpy(masks).float(),
        rigid_index=torch.from_numpy(index),
        level_depth=torch.from_numpy(level_depth),
        rod_radius=rod_radius,
        rod_edge=rod_edge,
    )


def scene_of(store: Store) -> Scene:
    """The scene of a store's grid, with all its interiors."""
    return make_scene(
        points=store.points,
        normals=store.normals,
        profile=store.profile,
        level_depth=store.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.rod_edge,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Pokes:
    """b pokes, as in `Batch`: geometry (b,) int64; start, direction (b, 3), depth, modulus (b,) float64."""

    geometry: Tensor
    start: Tensor
    direction: Tensor
    depth: Tensor
    modulus: Tensor


def pokes_of(batch: Batch) -> Pokes:
    """What a model may see of a batch."""
    return Pokes(
        geometry=batch.geometry,
        start=batch.start,
        direction=batch.direction,
        depth=batch.depth,
        modulus=batch.modulus,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Prediction:
    """displacement of the scene's points (b, n, 3) [m]; size of the force on the rod (b,) [N].

    spread (b, n) [m], force_spread (b,) of ln(force): how far the members of an ensemble differ; None of one
    model.
    """

    displacement: Tensor
    force: Tensor
    spread: Tensor | None = None
    force_spread: Tensor | None = None
