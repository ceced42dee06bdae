"""Inputs and outputs of a model: scenes of points over interiors, pokes, and the response to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from learn.data.clouds import areas, nearest_columns
from learn.data.loaders import Batch, no_clock
from learn.data.setup import Setup
from learn.data.store import Store, rigid_masks


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """A point cloud on the tissue's surface over g interiors. SI units.

    Attributes
    ----------
    points : rest positions [m], shape (n, 3), float64.
    normals : outward unit normals, shape (n, 3), float64.
    area : area of each point, in any unit, shape (n,), float64: weighted sums over points are integrals.
    profile : stiffness codes under each point from 0 to 1 (rigid), top level first, shape (g, n, levels).
    rigid : 1 where a level is rigid, one entry per distinct inclusion, shape (k, n, levels).
    rigid_index : inclusion of each interior, shape (g,).
    level_depth : depth of each level below the surface [m], shape (levels,), float64.
    height : height of the block [m].
    rod_radius, rod_edge : radii of the indenter and of its rounded edge [m], as in `Setup`.
    """

    points: Tensor
    normals: Tensor
    area: Tensor
    profile: Tensor
    rigid: Tensor
    rigid_index: Tensor
    level_depth: Tensor
    height: float
    rod_radius: float
    rod_edge: float

    def to(self, device: torch.device | str) -> Scene:
        """The same scene on a device."""
        moved: dict[str, Any] = {k: v.to(device) for k, v in vars(self).items() if isinstance(v, Tensor)}
        return replace(self, **moved)

    def only(self, interiors: NDArray[np.int64]) -> Scene:
        """The same points over these interiors alone, so that no other is encoded; their indices are kept."""
        used = torch.from_numpy(np.unique(interiors)).to(self.rigid_index.device)
        kept, place = torch.unique(self.rigid_index[used], return_inverse=True)
        index = torch.zeros_like(self.rigid_index)
        index[used] = place
        return replace(self, rigid=self.rigid[kept], rigid_index=index)

    def over(self, interiors: Tensor) -> tuple[Scene, Tensor]:
        """The same points over these interiors (b,) alone, and the index of each in the new scene."""
        used, index = torch.unique(interiors, return_inverse=True)
        kept, inclusion = torch.unique(self.rigid_index[used], return_inverse=True)
        scene = replace(self, profile=self.profile[used], rigid=self.rigid[kept], rigid_index=inclusion)
        return scene, index

    def at(self, points: NDArray[np.int64]) -> Scene:
        """Some of the points, by index."""
        some = torch.from_numpy(points).to(self.points.device)
        return replace(
            self,
            points=self.points[some],
            normals=self.normals[some],
            area=torch.from_numpy(areas(self.points[some].cpu().numpy())).to(self.points.device),
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
    """Scene of any point cloud; `profile` (g, n, levels) as stored (255 = rigid)."""
    masks, index = rigid_masks(profile)
    return Scene(
        points=torch.from_numpy(np.ascontiguousarray(points)),
        normals=torch.from_numpy(np.ascontiguousarray(normals)),
        area=torch.from_numpy(areas(points)),
        profile=torch.from_numpy(profile).float() / 255,
        rigid=torch.from_numpy(masks).float(),
        rigid_index=torch.from_numpy(index),
        level_depth=torch.from_numpy(level_depth),
        height=float(level_depth[0] + level_depth[-1]),
        rod_radius=rod_radius,
        rod_edge=rod_edge,
    )


def scene_on(setup: Setup, profile: NDArray[np.uint8], points: NDArray[np.float64] | None = None) -> Scene:
    """Scene of a setup's grid over interiors, `profile` (g, n, levels) as stored (255 = rigid).

    Or of other `points` (m, 3) of its top face [m], with the profiles of the nearest grid columns.
    """
    if points is not None:
        profile = profile[:, nearest_columns(setup, points)]
    return make_scene(
        points=setup.points if points is None else points,
        normals=setup.normals if points is None else np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        profile=profile,
        level_depth=setup.level_depth,
        rod_radius=setup.rod_radius,
        rod_edge=setup.rod_edge,
    )


def over_same_columns(scene: Scene, setup: Setup, points: NDArray[np.float64]) -> Scene:
    """The scene of a setup's grid with other points (m, 3) of its top face [m], as `scene_on` makes it."""
    device = scene.points.device
    return replace(
        scene.at(nearest_columns(setup, points)),
        points=torch.from_numpy(points).to(device),
        area=torch.from_numpy(areas(points)).to(device),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Pokes:
    """Input of b predictions, as in `Batch`. SI units, float64.

    Attributes
    ----------
    geometry : interior, row of `Scene.profile`, shape (b,), int64.
    start : the indenter's tip at first contact [m], shape (b, 3).
    direction : unit vector of the push, shape (b, 3).
    depth : travel since first contact [m], shape (b,).
    modulus : shear modulus at small strain [Pa], shape (b,).
    clock : time since first contact [s], the rod's speed along the push and its speed of approach [m/s],
        shape (b, 3); shape (b, 0) without time.
    """

    geometry: Tensor
    start: Tensor
    direction: Tensor
    depth: Tensor
    modulus: Tensor
    clock: Tensor = field(default_factory=no_clock)


T = TypeVar("T", Batch, "Pokes")


def pokes_of(batch: Batch) -> Pokes:
    """The inputs in a batch, without displacement and force."""
    return Pokes(
        geometry=batch.geometry,
        start=batch.start,
        direction=batch.direction,
        depth=batch.depth,
        modulus=batch.modulus,
        clock=batch.clock,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """Output of a model for b pokes.

    Attributes
    ----------
    displacement : displacement of the scene's points [m], shape (b, n, 3).
    force : magnitude of the force on the indenter [N], shape (b,).
    spread : standard deviation of an ensemble's displacements [m], shape (b, n); None for one model.
    force_spread : standard deviation of an ensemble's ln(force), shape (b,); None for one model.
    """

    displacement: Tensor
    force: Tensor
    spread: Tensor | None = None
    force_spread: Tensor | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Scenes:
    """The scenes of a dataset, one per setup, which share its g interiors among them.

    Attributes
    ----------
    scenes : one scene per setup of the store, in its order.
    place : scene of each interior of the dataset, shape (g,).
    row : row of each interior in its scene, shape (g,).
    """

    scenes: tuple[Scene, ...]
    place: NDArray[np.int64]
    row: NDArray[np.int64]

    @classmethod
    def of(cls, store: Store, points: Callable[[Setup], NDArray[np.float64]] | None = None) -> Scenes:
        """All interiors of a store under its grids, or under other points of each top face [m]."""
        place, scenes = store.setup_index, []
        row = np.zeros_like(place)
        for k, setup in enumerate(store.setups):
            mine = np.flatnonzero(place == k)
            row[mine] = np.arange(len(mine))
            scenes.append(scene_on(setup, store.profile[mine], None if points is None else points(setup)))
        return cls(scenes=tuple(scenes), place=place, row=row)

    def __len__(self) -> int:
        return len(self.scenes)

    @property
    def device(self) -> torch.device:
        """Where the scenes are."""
        return self.scenes[0].points.device

    def to(self, device: torch.device | str) -> Scenes:
        """The same scenes on a device."""
        return replace(self, scenes=tuple(scene.to(device) for scene in self.scenes))

    def only(self, geometries: NDArray[np.int64]) -> Scenes:
        """The scenes over these interiors alone, so that no other is encoded; their indices are kept."""
        used = np.unique(geometries)
        of_each = [self.row[used[self.place[used] == k]] for k in range(len(self))]
        scenes = (
            scene.only(rows) if len(rows) else scene for scene, rows in zip(self.scenes, of_each, strict=True)
        )
        return replace(self, scenes=tuple(scenes))

    def parts(self, batch: T) -> Iterator[tuple[int, Tensor, T]]:
        """Split a batch, or pokes, by scene.

        Yields
        ------
        The number of the scene, the positions of its pokes in the batch, and these pokes, with `geometry` the
        row of the scene. Nothing is copied if all are of one scene.
        """
        device = batch.geometry.device
        if len(self) == 1:  # without a wait for a GPU
            yield 0, torch.arange(len(batch.geometry), device=device), batch
            return
        geometry = batch.geometry.cpu().numpy()
        place = self.place[geometry]
        found = np.unique(place)
        for k in found:
            mine = np.flatnonzero(place == k)
            where = torch.from_numpy(mine).to(device)
            part = batch
            if len(found) > 1:
                part = replace(part, **{f.name: getattr(part, f.name)[where] for f in fields(part)})
            row = torch.from_numpy(self.row[geometry[mine]]).to(device)
            yield int(k), where, replace(part, geometry=row)

    def each(self, batches: Iterable[T]) -> Iterator[tuple[int, T]]:
        """The parts of all batches, with the number of their scene."""
        for batch in batches:
            for k, _, part in self.parts(batch):
                yield k, part

    def rows(self, call: Callable[[Scene, T], NDArray[Any]], batch: T) -> NDArray[Any]:
        """Results of `call(scene, part)` for the parts of a batch, rows in the order of the batch."""
        parts = list(self.parts(batch))
        found = np.concatenate([call(self.scenes[k], part) for k, _, part in parts])
        return found[np.argsort(np.concatenate([where.numpy() for _, where, _ in parts]), kind="stable")]
