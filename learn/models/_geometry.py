"""The geometry encoder: what lies under and around each point, computed once, whatever the poke."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from learn.models._stencil import Stencil, stencil
from learn.models.scene import Scene

RADII = (6.2e-3, 12.4e-3, 25e-3)  # m
BINS = 16  # of the profile's levels


@dataclass(frozen=True, eq=False)
class Encoded:
    """k inclusions under n points. code (n, k, c): invariant; vectors (3, n, k, v): they turn with the scene;
    clear (n, k): share of each column that lies above the inclusion.

    stencils: the cloud's neighbourhoods at `RADII`. scene: what was encoded.
    """

    scene: Scene
    stencils: tuple[Stencil, ...]
    code: Tensor
    vectors: Tensor
    clear: Tensor


def stencils_of(scene: Scene) -> tuple[Stencil, ...]:
    """The cloud's neighbourhoods; they depend on its points alone."""
    points = scene.points.cpu().numpy()
    return tuple(stencil(points, radius).to(scene.points.device) for radius in RADII)


class GeometryEncoder(nn.Module):
    """Two rounds of messages over three scales, then the slopes of the code as vectors."""

    def __init__(self, *, profile: int = 8, code: int = 24, vectors: int = 8) -> None:
        super().__init__()
        self.profile = nn.Sequential(nn.Linear(BINS + 2, 32), nn.SiLU(), nn.Linear(32, profile))
        wide = profile + 1
        self.first = _Round(wide, 16)
        self.second = _Round(16 + 1, code)
        self.narrow = nn.Linear(code, vectors)
        self.n_code, self.n_vectors = code, vectors * 2

    def forward(self, scene: Scene, stencils: tuple[Stencil, ...]) -> Encoded:
        """Codes and vectors of every inclusion of the scene."""
        levels = scene.rigid.shape[2]
        binned = scene.rigid.reshape(*scene.rigid.shape[:2], BINS, levels // BINS).mean(dim=3)
        # how much soft tissue lies above the inclusion, and how much of the column is rigid
        clear = (scene.rigid.cumsum(dim=2) < 0.5).float().mean(dim=2, keepdim=True)
        share = scene.rigid.mean(dim=2, keepdim=True)
        values = self.profile(torch.cat([binned, clear, share], dim=2)).permute(1, 0, 2)
        normals = scene.normals.float().T[:, :, None, None]
        # a constant beside the values: its slope is where the cloud ends
        h = torch.nn.functional.silu(self.first(_with_one(values), stencils, normals))
        code = self.second(_with_one(h), stencils, normals)
        thin = self.narrow(code)
        vectors = torch.cat([slopes(s, thin) for s in stencils[1:]], dim=3)
        return Encoded(scene, stencils, code, vectors, clear[..., 0].T)


class _Round(nn.Module):
    """Means and slopes at every scale into a small network at each point."""

    def __init__(self, wide: int, out: int) -> None:
        super().__init__()
        self.mix = nn.Sequential(nn.Linear(wide * (1 + 3 * len(RADII)), 48), nn.SiLU(), nn.Linear(48, out))

    def forward(self, values: Tensor, stencils: tuple[Stencil, ...], normals: Tensor) -> Tensor:
        parts = [values]
        for s in stencils:
            slope = slopes(s, values)
            parts += [means(s, values), slope.square().sum(dim=0), (slope * normals).sum(dim=0)]
        out: Tensor = self.mix(torch.cat(parts, dim=2))
        return out


def means(s: Stencil, values: Tensor) -> Tensor:
    """Neighbourhood means of (n, b, c)."""
    n, b, c = values.shape
    return s.mean(values.reshape(n, b * c)).reshape(n, b, c)


def slopes(s: Stencil, values: Tensor) -> Tensor:
    n, b, c = values.shape
    return s.slope(values.reshape(n, b * c)).reshape(3, n, b, c)


def _with_one(values: Tensor) -> Tensor:
    return torch.cat([values, torch.ones_like(values[..., :1])], dim=2)
