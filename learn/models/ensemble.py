"""Models trained from different seeds on the same part, as one: their mean, and how far they differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch

from learn.models._model import Model
from learn.models.scene import Pokes, Prediction, Scene


class Ensemble(Model):
    """Answers with the mean displacement and the geometric mean of the forces.

    The prediction's spread: root mean square distance of the members' displacements from their mean, with
    the n - 1 of a sample (b, n) [m]; force_spread: the same of ln(force) (b,).
    """

    def __init__(self, members: Sequence[Model]) -> None:
        super().__init__()
        if len(members) < 2:
            raise ValueError("an ensemble has at least two members")
        self.members = torch.nn.ModuleList(members)

    def prepare(self, scene: Scene) -> list[Any]:
        """What each member prepares; members of one kind share it."""
        kinds: dict[type, Any] = {}
        for member in self._all():
            if type(member) not in kinds:
                kinds[type(member)] = member.prepare(scene)
        return [kinds[type(member)] for member in self._all()]

    def encode(self, scene: Scene, prepared: list[Any] | None = None) -> list[Any]:
        """Each member's own."""
        ready = prepared if prepared is not None else self.prepare(scene)
        return [member.encode(scene, part) for member, part in zip(self._all(), ready, strict=True)]

    def decode(self, encoded: list[Any], pokes: Pokes) -> Prediction:
        """The members' mean, with their spread."""
        found = [member.decode(part, pokes) for member, part in zip(self._all(), encoded, strict=True)]
        u = torch.stack([p.displacement for p in found])
        logs = torch.log(torch.stack([p.force for p in found]))
        mean, more = u.mean(dim=0), len(found) - 1
        return Prediction(
            displacement=mean,
            force=torch.exp(logs.mean(dim=0)),
            spread=((u - mean).square().sum(dim=(0, 3)) / more).sqrt(),
            force_spread=((logs - logs.mean(dim=0)).square().sum(dim=0) / more).sqrt(),
        )

    def _all(self) -> list[Model]:
        return [member for member in self.members if isinstance(member, Model)]
