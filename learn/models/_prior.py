"""A closed form that the network corrects: fields like a point load's on an elastic layer, fitted linearly.

u / depth = sum_k c_k g_k v_k: g falls as 1 / sqrt(r^2 + a^2) (Boussinesq's half space) times exp(-r / L) (the
fixed base below); v is the surface normal, the direction from first contact or that of the push; each with
factors of inclination, depth and the soft tissue below the contact. It is fitted to the training part
by weighted least squares before the network is trained, and stays fixed.
"""

from __future__ import annotations

from collections.abc import Iterable

import torch
from torch import Tensor, nn

from learn.data.loaders import Batch
from learn.models._contact import Contact

CORES = (1.0, 2.0, 4.0)  # a, rod radii
RANGES = (4.0, 12.0)  # L, rod radii
POKE_FACTORS = 7  # that depend on the poke alone; one more varies from point to point
_RIDGE = 1e-6
_NEAR = 20.0  # weight of points near first contact, as in training
_NEAR_WIDTH = 2.4  # rod radii


class Prior(nn.Module):
    """The closed form, with `coefficients` (cores x ranges, factors, 3)."""

    coefficients: Tensor

    def __init__(self) -> None:
        super().__init__()
        shape = (len(CORES) * len(RANGES), POKE_FACTORS + 1, 3)
        self.register_buffer("coefficients", torch.zeros(shape, dtype=torch.float64))

    @torch.no_grad()
    def forward(self, contact: Contact, soft: Tensor) -> Tensor:
        """Displacement over depth (n, b, 3), computed in float64, since large terms nearly cancel."""
        radial, factors, turn, vectors = _parts(contact, soft)
        c = self.coefficients
        of_poke = torch.einsum("bf,kfv->bkv", factors, c[:, :-1])
        amounts = torch.einsum("nbk,bkv->nbv", radial, of_poke) + turn[..., None] * (radial @ c[:, -1])
        return sum(a[..., None] * v for a, v in zip(amounts.unbind(2), vectors, strict=True)).float()  # type: ignore[union-attr]

    @torch.no_grad()
    def fit(self, samples: Iterable[tuple[Contact, Tensor, Batch]]) -> None:
        """Fit by least squares over these frames, with larger weights near first contact."""
        size = self.coefficients.numel()
        normal = torch.zeros(size, size, dtype=torch.float64)
        right = torch.zeros(size, dtype=torch.float64)
        for contact, soft, batch in samples:
            radial, factors, turn, vectors = _parts(contact, soft)
            n, b, _ = radial.shape
            every = torch.cat([factors.expand(n, b, -1), turn[..., None]], dim=2)
            scalar = (radial[..., :, None] * every[..., None, :]).reshape(n * b, -1)
            truth = (batch.displacement / batch.depth[:, None, None]).permute(1, 0, 2)
            square = contact.exact.r.square().sum(dim=2)
            weight = 1 + _NEAR * torch.exp(-0.5 * square / _NEAR_WIDTH**2)
            # the design is scalars times vectors: for each pair of vectors, products of the scalars
            basis = [v.expand(n, b, 3) for v in vectors]
            for j, one in enumerate(basis):
                right[j::3] += scalar.T @ (weight * (one * truth).sum(dim=2)).reshape(-1)
                for k, other in enumerate(basis[: j + 1]):
                    both = (weight * (one * other).sum(dim=2)).reshape(-1, 1)
                    normal[j::3, k::3] += (part := scalar.T @ (both * scalar))
                    if k < j:
                        normal[k::3, j::3] += part
        ridge = _RIDGE * normal.diagonal().mean() * torch.eye(size, dtype=torch.float64)
        found = torch.linalg.solve(normal + ridge, right)
        self.coefficients.copy_(found.reshape(self.coefficients.shape))


def _parts(contact: Contact, soft: Tensor) -> tuple[Tensor, Tensor, Tensor, tuple[Tensor, Tensor, Tensor]]:
    """Radial functions (n, b, k), factors of a poke (b, f), cosine of direction and push (n, b), vectors."""
    r, push, normal, depth = contact.exact
    square = r.square().sum(dim=2)
    size = torch.sqrt(square + 1e-6)
    radial = torch.stack(
        [torch.rsqrt(square + a * a) * torch.exp(-size / length) for a in CORES for length in RANGES], dim=2
    )
    unit = r * torch.rsqrt(square + 1)[..., None]
    lean = (contact.here * push).sum(dim=1) + 0.8  # centred near zero
    deep = depth / 4
    factors = [torch.ones_like(deep), lean, deep, soft.double(), deep * lean, deep * deep, deep * soft]
    return radial, torch.stack(factors, dim=1), (unit * push).sum(dim=2), (normal, unit, push)
