"""Inputs and outputs of a model, the class that a model derives from, ensembles, and the registry of models.

To add a model, derive from `Model` in a separate file and register it:

>>> from learn.models import Model, register_model
>>> @register_model("mine", version=1)
... class Mine(Model):
...     def __init__(self, statistics): ...
...     def encode(self, scene, prepared=None): ...
...     def decode(self, encoded, pokes): ...

`learn.train --model mine --plugin FILE` imports the file and trains it; recipes, checkpoints, tables and
`learn.predict` refer to it by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from learn.data.clouds import areas, nearest_columns
from learn.data.loaders import Batch, no_clock
from learn.data.statistics import Statistics
from learn.data.store import Store, rigid_masks
from learn.errors import InputError


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
    rod_radius, rod_edge : radii of the indenter and of its rounded edge [m], as in `Store`.
    """

    points: Tensor
    normals: Tensor
    area: Tensor
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
        """The same points over these interiors alone, so that no other is encoded; their indices are kept."""
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


def scene_on(store: Store, points: NDArray[np.float64]) -> Scene:
    """The store's interiors under other points of its top face: profiles of the nearest grid columns."""
    return make_scene(
        points=points,
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        profile=store.profile[:, nearest_columns(store, points)],
        level_depth=store.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.rod_edge,
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


class Model(nn.Module):
    """A network that predicts pokes in three steps; each result is reusable while its input is unchanged.

    Attributes
    ----------
    free_interior : True if the model accepts interiors and moduli that the dataset does not hold.
    takes_clock : True if the model requires `Pokes.clock`; only these models are trained on datasets with
        time.
    outputs : names of the last layers' matrices, which an optimiser for hidden layers excludes.
    """

    free_interior: bool = False
    takes_clock: bool = False
    outputs: frozenset[str] = frozenset()

    def warm_start(self, batches: Iterable[Batch], scene: Scene) -> None:
        """Fit the parts that are not trained, before training, to some batches of the training part."""

    def prepare(self, scene: Scene) -> Any:  # noqa: ARG002 - not every model has something to prepare
        """Quantities that depend on the points alone, neither on weights nor on interiors."""
        return None

    def encode(self, scene: Scene, prepared: Any = None) -> Any:
        """Quantities that do not depend on the poke."""
        raise NotImplementedError

    def decode(self, encoded: Any, pokes: Pokes) -> Response:
        """Displacement and force of b pokes."""
        raise NotImplementedError

    def forward(self, scene: Scene, pokes: Pokes) -> Response:
        """All three steps."""
        return self.decode(self.encode(scene, self.prepare(scene)), pokes)


Factory = Callable[[Statistics], Model]
F = TypeVar("F", bound=Factory)


@dataclass(frozen=True, kw_only=True)
class RegisteredModel:
    """A model by name: `make` builds it from training statistics, `version` is that of its architecture."""

    make: Factory
    version: int


MODELS: dict[str, RegisteredModel] = {}
OLD_NAMES = {"ours": "invariant-gnn", "ours-small": "invariant-gnn-small"}  # in recipes and checkpoints


def register_model(name: str, *, version: int = 1) -> Callable[[F], F]:
    """Decorator that adds a model's class, or a function that makes it from `Statistics`, to `MODELS`.

    Parameters
    ----------
    name : name of the model in recipes, checkpoints and tables. An existing name is replaced.
    version : version of the architecture; checkpoints of another version are refused.
    """

    def register(make: F) -> F:
        MODELS[name] = RegisteredModel(make=make, version=version)
        return make

    return register


def make_model(name: str, statistics: Statistics) -> Model:
    """Make a model by name, with weights from torch's random state. InputError for an unknown name."""
    name = OLD_NAMES.get(name, name)
    if name not in MODELS:
        raise InputError(f"model {name}: expected one of {', '.join(MODELS)}")
    return MODELS[name].make(statistics)


class Ensemble(Model):
    """Models trained from different seeds on one training part, evaluated as one.

    The displacement is the members' mean, the force their geometric mean. The spread is the root mean square
    distance of the members from their mean, with n - 1 degrees of freedom.
    """

    @property
    def free_interior(self) -> bool:  # type: ignore[override]
        return all(member.free_interior for member in self._all())

    @property
    def takes_clock(self) -> bool:  # type: ignore[override]
        return any(member.takes_clock for member in self._all())

    def __init__(self, members: Sequence[Model]) -> None:
        super().__init__()
        if len(members) < 2:
            raise ValueError("an ensemble has at least two members")
        self.members = torch.nn.ModuleList(members)

    def prepare(self, scene: Scene) -> list[Any]:
        """Prepared quantities of each member, computed once per class of members."""
        kinds: dict[type, Any] = {}
        for member in self._all():
            if type(member) not in kinds:
                kinds[type(member)] = member.prepare(scene)
        return [kinds[type(member)] for member in self._all()]

    def encode(self, scene: Scene, prepared: list[Any] | None = None) -> list[Any]:
        """Encoded quantities of each member."""
        ready = prepared if prepared is not None else self.prepare(scene)
        return [member.encode(scene, part) for member, part in zip(self._all(), ready, strict=True)]

    def decode(self, encoded: list[Any], pokes: Pokes) -> Response:
        """Mean response of the members, with their spread."""
        found = [member.decode(part, pokes) for member, part in zip(self._all(), encoded, strict=True)]
        u = torch.stack([p.displacement for p in found])
        logs = torch.log(torch.stack([p.force for p in found]))
        mean, more = u.mean(dim=0), len(found) - 1
        return Response(
            displacement=mean,
            force=torch.exp(logs.mean(dim=0)),
            spread=((u - mean).square().sum(dim=(0, 3)) / more).sqrt(),
            force_spread=((logs - logs.mean(dim=0)).square().sum(dim=0) / more).sqrt(),
        )

    def _all(self) -> list[Model]:
        return [member for member in self.members if isinstance(member, Model)]
