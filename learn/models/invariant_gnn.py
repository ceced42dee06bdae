"""Equivariant graph network: invariants of points give coefficients of vectors that rotate with the scene.

Only distances, angles and depths enter the networks, and the displacement is a sum of vectors that rotate
with the scene (surface normal, direction from the contact, direction of the push, slopes of codes and of
messages). So a rotated, mirrored or translated scene gives the rotated, mirrored or translated displacement,
and the same force, to rounding. Interior and neighbourhoods are encoded once per geometry (`encode`), a poke
costs `decode` alone. The displacement is predicted in units of the depth, the force in units of shear modulus
times rod radius times depth: without gravity the force of one elastic law is proportional to its moduli, and
the modulus is not an input of the networks if the dataset states that its levels differ by a factor alone.
If the dataset has time, the time since contact and the rod's speeds are also invariants of the poke.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable

import torch
from torch import Tensor, nn
from torch.nn.functional import silu, softplus

from learn.data.loaders import Batch
from learn.data.statistics import Statistics
from learn.errors import InputError
from learn.models import _ahead, _contact
from learn.models._contact import Contact
from learn.models._encoder import Encoded, GeometryEncoder, Stencil, means, slopes, stencils_of
from learn.models._prior import Prior
from learn.models.base import Model, register_model
from learn.models.scene import Pokes, Response, Scene, Scenes, pokes_of

SEEN = 6  # channels of the code in the features of the contact
N_CLOCK = 3  # invariants of a poke with time


# version 1 lacked the indenter's surface; 2 weighted points equally, and had a modulus input without effect;
# 3 did not see the inverse of the soft tissue's thickness; 4 did not see what lies ahead of the indenter
@register_model("invariant-gnn", version=5)
class InvariantGnn(Model):
    """The surrogate.

    Parameters
    ----------
    statistics : statistics of the training part, which set the units of modulus and force.
    hidden : width of the trunk.
    messages, directions : channels of the messages' means and slopes.
    scales : indices of the encoder's radii in each round of messages.
    vectors : channels of the encoder's slopes, at each of its two larger radii.
    """

    free_interior = True
    outputs = frozenset({"coefficients.weight", "force_head.2.weight"})

    def __init__(
        self,
        statistics: Statistics,
        *,
        hidden: int = 64,
        messages: int = 16,
        directions: int = 8,
        scales: tuple[tuple[int, ...], ...] = ((0, 1), (0,)),
        vectors: int = 8,
    ) -> None:
        super().__init__()
        self.log_modulus = statistics.log_modulus_mean
        self.force_unit = math.exp(statistics.log_force_mean)
        self.log_time, self.log_speed = statistics.log_time_mean, statistics.log_speed_mean
        self.takes_clock = self.log_time is not None and self.log_speed is not None
        self.encoder = GeometryEncoder(vectors=vectors, height=statistics.block_height)
        self.prior = Prior()
        code, turning = self.encoder.n_code, self.encoder.n_vectors
        self.look = nn.Linear(code, SEEN, bias=False)
        seen = 3 * SEEN
        about = _contact.N_POKE + 3 * seen + _contact.N_COVER + _ahead.N_AHEAD
        about += (self.log_modulus is not None) + (N_CLOCK if self.takes_clock else 0)
        self.from_code = nn.Linear(code, hidden)
        self.from_poke = nn.Linear(about, hidden, bias=False)
        self.from_point = nn.Linear(_contact.N_POINT + seen + 2 * turning, hidden, bias=False)
        self.enter = nn.Linear(hidden, hidden)
        self.rounds = nn.ModuleList([_Messages(hidden, messages, directions, some) for some in scales])
        self.leave = nn.Sequential(nn.Linear(hidden, hidden), nn.SiLU())
        self.coefficients = nn.Linear(hidden, 3 + turning + len(scales[-1]) * directions + _contact.N_GATES)
        self.force_head = nn.Sequential(
            nn.Linear(2 * hidden + about, hidden), nn.SiLU(), nn.Linear(hidden, 1)
        )
        with torch.no_grad():
            self.coefficients.weight.mul_(0.1)
            last = self.force_head[2]
            assert isinstance(last, nn.Linear)
            last.weight.mul_(0.1)
            last.bias.fill_(math.log(math.e - 1))  # softplus of it is 1

    def prepare(self, scene: Scene) -> tuple[Stencil, ...]:
        """The cloud's neighbourhoods."""
        return stencils_of(scene)

    def encode(self, scene: Scene, prepared: tuple[Stencil, ...] | None = None) -> Encoded:
        """Quantities that do not depend on the poke; reusable while geometry and weights are unchanged."""
        encoded: Encoded = self.encoder(scene, prepared if prepared is not None else stencils_of(scene))
        return encoded

    @torch.no_grad()
    def warm_start(self, batches: Iterable[Batch], scenes: Scenes) -> None:
        """Fit the closed form that the network corrects."""
        encode = functools.cache(lambda k: self.encode(scenes.scenes[k]))
        samples = (
            (contact, _soft(encode(k), contact, scenes.scenes[k].rigid_index[part.geometry]), part)
            for k, part in scenes.each(batches)
            for contact in [Contact(scenes.scenes[k], pokes_of(part))]
        )
        self.prior.fit(samples)

    def decode(self, encoded: Encoded, pokes: Pokes) -> Response:
        """Displacement and force of b pokes."""
        scene = encoded.scene
        inclusion = scene.rigid_index[pokes.geometry]
        contact = Contact(scene, pokes)
        vectors = encoded.vectors.index_select(2, inclusion)
        scalars, toward = contact.seen(self.look(encoded.code).index_select(1, inclusion))
        cover = _contact.of_cover(self._cover(encoded, contact, inclusion), contact.depth, contact.poke[:, 2])
        ahead = self._ahead(encoded, contact, pokes, inclusion)
        known = [torch.stack([*cover, *ahead], dim=1), *self._of_modulus(pokes), *self._of_clock(pokes)]
        about = torch.cat([contact.poke, scalars, *known], dim=1)
        unit = contact.unit.permute(2, 0, 1)[..., None]
        push = contact.push.T[:, None, :, None]
        toward = torch.einsum("nbk,kbc->nbc", contact.unit, toward)
        seen = [contact.point, toward, (vectors * unit).sum(dim=0), (vectors * push).sum(dim=0)]
        code = self.from_code(encoded.code).index_select(1, inclusion)
        h = silu(self.from_point(torch.cat(seen, dim=2)) + self.from_poke(about) + code)
        h = silu(self.enter(h))
        slope = vectors[..., :0]
        for round_ in self.rounds:
            h, slope = round_(h, encoded.stencils, unit, push, contact.near[2])
        out = self.leave(h)

        sizes = [3, vectors.shape[3] + slope.shape[3], _contact.N_GATES]
        amounts, others, gates = self.coefficients(out).split(sizes, dim=2)
        own = (torch.cat([vectors, slope], dim=3) * others).sum(dim=3).permute(1, 2, 0)
        for amount, vector in zip(amounts.unbind(2), contact.vectors(), strict=True):
            own = own + amount[..., None] * vector
        smooth = self.prior(contact, _soft(encoded, contact, inclusion))
        u = _contact.held(contact.place, smooth, own * contact.far[..., None], torch.sigmoid(gates))

        pooled = [torch.einsum("nb,nbc->bc", contact.near[k], out) for k in (0, 1)]
        kappa = self.force_head(torch.cat([*pooled, about], dim=1))[:, 0]
        depth = pokes.depth.clamp(min=0.0)  # no response without contact
        unit_force = (pokes.modulus * depth).float() * (scene.rod_radius * self.force_unit)
        return Response(
            displacement=(u * depth.float()[None, :, None]).permute(1, 0, 2),
            force=unit_force * softplus(kappa),
        )

    def _cover(self, encoded: Encoded, contact: Contact, inclusion: Tensor) -> Tensor:
        """Thickness of the soft tissue below the contact (b,), in rod radii.

        A harmonic mean, since the stiffnesses of columns side by side add up.
        """
        inverse = 1 / encoded.clear.clamp(min=_contact.LEAST_CLEAR).index_select(1, inclusion)
        return self.column(encoded.scene) / (contact.near[0] * inverse).sum(dim=0)

    def _ahead(self, encoded: Encoded, contact: Contact, pokes: Pokes, inclusion: Tensor) -> list[Tensor]:
        """Invariants of what lies ahead of the indenter along its push, each (b,)."""
        scene = encoded.scene
        blocked = _ahead.blocked(
            contact.exact.r * scene.rod_radius,
            scene.normals,
            torch.log(scene.area),
            encoded.layers.index_select(1, inclusion),
            pokes.direction,
            scene.height,
        )
        return _ahead.of_path(blocked, contact.depth, scene.rod_radius)

    def column(self, scene: Scene) -> float:
        """The unit of `Encoded.clear` in rod radii."""
        return (self.encoder.height or scene.height) / scene.rod_radius

    def _of_modulus(self, pokes: Pokes) -> list[Tensor]:
        """Centred logarithm of the modulus, unless the modulus only scales the force."""
        if self.log_modulus is None:
            return []
        return [(torch.log(pokes.modulus) - self.log_modulus).float()[:, None]]

    def _of_clock(self, pokes: Pokes) -> list[Tensor]:
        """Invariants of time: centred logarithms of time and speed of approach, and the ratio of speeds."""
        if self.log_time is None or self.log_speed is None:
            return []
        if not pokes.clock.shape[1]:
            raise InputError(
                "the model was trained with time: expected that of each poke, and the rod's speeds"
            )
        time, speed, approach = pokes.clock.unbind(1)
        parts = [torch.log(time) - self.log_time, torch.log(approach) - self.log_speed, speed / approach]
        return [torch.stack(parts, dim=1).float()]


# version 3 had two rounds of messages, the first at two radii, and 8 vectors; 4 and 5 are as invariant-gnn of
# versions 3 and 4
@register_model("invariant-gnn-small", version=6)
def small(statistics: Statistics) -> InvariantGnn:
    """Half as wide, with one round of messages: faster, at a larger error."""
    return InvariantGnn(statistics, hidden=32, messages=8, directions=4, scales=((0,),), vectors=4)


def _soft(encoded: Encoded, contact: Contact, inclusion: Tensor) -> Tensor:
    """Fraction of the column below the contact that is soft, shape (b,)."""
    return (contact.near[0] * encoded.clear.index_select(1, inclusion)).sum(dim=0)


class _Messages(nn.Module):
    """One round: means, and slopes along the scene's vectors, of a narrow copy of h at some scales."""

    def __init__(self, hidden: int, messages: int, directions: int, scales: tuple[int, ...]) -> None:
        super().__init__()
        self.directions, self.scales = directions, scales
        self.thin = nn.Linear(hidden, messages + directions)
        wide = hidden + len(scales) * (messages + 2 * directions)
        self.mix = nn.Linear(wide, hidden)
        self.whole = nn.Linear(hidden, hidden, bias=False)
        self.back = nn.Linear(hidden, hidden)

    def forward(
        self, h: Tensor, stencils: tuple[Stencil, ...], unit: Tensor, push: Tensor, near: Tensor
    ) -> tuple[Tensor, Tensor]:
        thin = self.thin(h)
        scalar, vector = thin[..., : -self.directions], thin[..., -self.directions :]
        parts, vectors = [h], []
        for s in (stencils[k] for k in self.scales):
            slope = slopes(s, vector.contiguous())
            parts += [means(s, scalar.contiguous()), (slope * unit).sum(dim=0), (slope * push).sum(dim=0)]
            vectors.append(slope)
        whole = self.whole(torch.einsum("nb,nbc->bc", near, h))
        new = h + self.back(silu(self.mix(torch.cat(parts, dim=2)) + whole))
        return new, torch.cat(vectors, dim=3)
