"""Distance from the indenter's surface, and points in contact that lie on it."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from scipy.spatial import KDTree

from learn.models import Pokes, make_scene
from learn.models import _contact as indenter
from learn.models._contact import Contact

RADIUS, EDGE = 2.5e-3, 1e-3


def _outline(edge: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Densely sampled points (ahead of the tip, aside) of the rod's surface, in rod radii."""
    turn = np.linspace(0, np.pi / 2, 4000)
    rounded = np.column_stack([edge * (np.cos(turn) - 1), 1 - edge + edge * np.sin(turn)])
    flat = np.column_stack([np.zeros(4000), np.linspace(0, 1 - edge, 4000)])
    side = np.column_stack([np.linspace(-6, -edge, 40000), np.ones(40000)])
    return np.concatenate([flat, rounded, side])


@pytest.mark.parametrize("edge", [0.4, 1.0])  # flat tip and hemisphere
def test_distance_from_the_rod_is_that_of_its_nearest_surface_point(edge: float) -> None:
    random = np.random.default_rng(0)
    ahead, aside = random.uniform(-2, 2, 300), random.uniform(0, 3, 300)
    expected, _ = KDTree(_outline(edge)).query(np.column_stack([ahead, aside]))
    found, of_a, of_s = indenter.distance(torch.from_numpy(ahead), torch.from_numpy(aside), edge)
    rounded = (ahead + edge > 0) & (aside > 1 - edge)
    inside = np.where(rounded, np.hypot(ahead + edge, aside - 1 + edge) < edge, (ahead < 0) & (aside < 1))
    # inside the rod the distance is to the nearer of two faces, unless the nearest point is on the edge
    plain = ~inside | rounded | (np.minimum(-ahead, 1 - aside) < edge / 4)
    np.testing.assert_allclose(found.numpy()[plain], np.where(inside, -expected, expected)[plain], atol=2e-3)
    step = 1e-6
    there, _, _ = indenter.distance(torch.from_numpy(ahead + step), torch.from_numpy(aside), edge)
    np.testing.assert_allclose(of_a.numpy()[plain], ((there - found) / step).numpy()[plain], atol=1e-3)
    there, _, _ = indenter.distance(torch.from_numpy(ahead), torch.from_numpy(aside + step), edge)
    np.testing.assert_allclose(of_s.numpy()[plain], ((there - found) / step).numpy()[plain], atol=1e-3)


def _contact(points: torch.Tensor, depth: float = 4e-3) -> Contact:
    """Contact of one inclined poke; points (n, 3) [rod radii] from first touch, along x, y and ahead."""
    push = torch.tensor([0.6, 0.0, -0.8], dtype=torch.float64)
    x, y = torch.tensor([0.8, 0.0, 0.6], dtype=torch.float64), torch.tensor([0.0, 1, 0], dtype=torch.float64)
    place = RADIUS * (points[:, :1] * x + points[:, 1:2] * y + points[:, 2:] * push)
    start = torch.tensor([0.3, -0.2, 1.0], dtype=torch.float64)
    scene = make_scene(
        points=(start + place).numpy(),
        normals=np.tile([0.0, 0.0, 1.0], (len(place), 1)),
        profile=np.zeros((1, len(place), 16), dtype=np.uint8),
        level_depth=np.linspace(0, 0.03, 16),
        rod_radius=RADIUS,
        rod_edge=EDGE,
    )
    poke = Pokes(
        geometry=torch.zeros(1, dtype=torch.int64),
        start=start[None],
        direction=push[None],
        depth=torch.tensor([depth], dtype=torch.float64),
        modulus=torch.ones(1, dtype=torch.float64),
    )
    return Contact(scene, poke)


def test_a_point_under_the_end_moves_with_the_rod_from_where_they_met() -> None:
    under = torch.tensor([[0.0, 0.0, 0.2], [0.3, 0.4, 1.0], [0.5, 0.0, 0.0], [0.0, 0.0, 2.0]])
    contact = _contact(under.double())
    nothing = torch.zeros(4, 1, 3)
    u = indenter.held(contact.place, nothing, nothing, torch.tensor([1.0, 0.0]).expand(4, 1, 2))
    way = (u * contact.push).sum(dim=2)[:, 0] * 4e-3
    expected = torch.tensor([4e-3 - 0.2 * RADIUS, 4e-3 - RADIUS, 4e-3, 0])  # the last is not reached
    torch.testing.assert_close(way, expected, atol=1e-8, rtol=0)
    torch.testing.assert_close(u.norm(dim=2)[:, 0] * 4e-3, expected, atol=1e-8, rtol=0)


def test_points_land_on_the_surface_and_far_ones_are_left_alone() -> None:
    random = torch.Generator().manual_seed(0)
    points = torch.rand(200, 3, generator=random, dtype=torch.float64) * 2 - 1
    contact = _contact(points)
    aim = torch.rand(200, 1, 3, generator=random) * 0.02 - 0.01
    along = contact.push * (contact.depth - contact.along - 0.05 * points[:, 2:].float())[..., None]
    moved = indenter.held(
        contact.place, along / contact.depth, aim, torch.tensor([0.0, 1.0]).expand(200, 1, 2)
    )
    place = contact.r + contact.depth[:, None] * moved
    ahead = (place * contact.push).sum(dim=2)
    aside = (place - ahead[..., None] * contact.push).norm(dim=2)
    gap, _, _ = indenter.distance(ahead - contact.depth, aside, contact.edge)
    near = contact.aside[:, 0] < 0.8
    assert float(gap[near].abs().max()) < 1e-3  # rod radii
    far = _contact(points + torch.tensor([8.0, 0, 0], dtype=torch.float64))
    free = indenter.held(far.place, along, aim, torch.tensor([1.0, 1.0]).expand(200, 1, 2))
    torch.testing.assert_close(free, along + aim)
