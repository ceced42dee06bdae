"""The class that a model derives from, ensembles, and the registry of models.

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
from dataclasses import dataclass
from typing import Any, TypeVar

import torch
from torch import nn

from learn.data.loaders import Batch
from learn.data.statistics import Statistics
from learn.errors import InputError
from learn.models.scene import Pokes, Response, Scene, Scenes


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

    def warm_start(self, batches: Iterable[Batch], scenes: Scenes) -> None:
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
