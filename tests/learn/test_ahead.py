"""What lies ahead of the indenter: the way to what is rigid, in torch and one poke at a time."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from learn.models import Scene, make_scene
from learn.models import _ahead as ahead

RADIUS, HEIGHT = 2.5e-3, 0.032
SIDE = (np.arange(40) + 0.5) * 2e-3 - 0.04
DEPTHS = (np.arange(128) + 0.5) * HEIGHT / 128
X, Y, Z = np.meshgrid(SIDE, SIDE, -DEPTHS, indexing="ij")  # the surface at z = 0


def _scene(rigid: NDArray[np.bool_], turn: Rotation | None = None) -> Scene:
    points = np.stack([X, Y, 0 * Z], axis=3)[:, :, 0].reshape(-1, 3)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    return make_scene(
        points=turn.apply(points) if turn else points,
        normals=turn.apply(normals) if turn else normals,
        profile=np.where(rigid, 255, 0).astype(np.uint8).reshape(1, len(points), -1),
        level_depth=DEPTHS,
        rod_radius=RADIUS,
        rod_edge=1e-3,
    )


def _blocked(scene: Scene, start: NDArray[np.float64], push: NDArray[np.float64]) -> torch.Tensor:
    offset = scene.points - torch.from_numpy(start)
    return ahead.blocked(
        offset[:, None], scene.normals, torch.log(scene.area), ahead.layers_of(scene.rigid),
        torch.from_numpy(push)[None], scene.height,
    )  # fmt: skip


def _invariants(scene: Scene, push: NDArray[np.float64], depth: float, site: Any = (0.0, 0.0, 0.0)) -> Any:
    """`of_path` (widths, 8): logarithm and inverse of the clear way, depth over it, and blocked at BEYOND."""
    deep = torch.tensor([depth / RADIUS], dtype=torch.float64)
    found = ahead.of_path(_blocked(scene, np.array(site), push), deep, RADIUS)
    return torch.stack(found).reshape(len(ahead.WIDTHS), -1).numpy()


def _inclined(degrees: float, heading: float = 0.0) -> NDArray[np.float64]:
    lean, turn = np.radians([degrees, heading])
    return np.array([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), -np.cos(lean)])


@pytest.mark.parametrize("degrees", [0.0, 40.0])
def test_the_way_to_a_layer_is_its_cover_along_the_push(degrees: float) -> None:
    found = _invariants(_scene(Z < -0.009), _inclined(degrees), 4.5e-3)
    way = 9e-3 / np.cos(np.radians(degrees)) / RADIUS
    np.testing.assert_allclose(found[:, 1], 1 / way, rtol=0.03)
    np.testing.assert_allclose(found[:, 0], np.log(way / 4), atol=0.03)
    np.testing.assert_allclose(found[:, 2], 4.5e-3 / RADIUS / way, rtol=0.03)
    # 0 to 4 mm before the tip it is soft, 8 mm before it rigid
    np.testing.assert_allclose(found[:, 3:], np.tile([0, 0, 0, 0, 1], (2, 1)), atol=0.01)


def test_a_wall_beside_the_contact_is_ahead_of_a_push_towards_it_alone() -> None:
    """The cover below the contact is the same for both: half of the tissue 10 mm aside is rigid."""
    scene = _scene(X > 0.01)
    towards, away = (_invariants(scene, _inclined(45, heading), 8e-3) for heading in (0.0, 180.0))
    # the axis is at the wall after 14.1 mm: half of its neighbourhood is blocked there, all of it soon after
    at_wall = _invariants(scene, _inclined(45), 10e-3 * np.sqrt(2) - 8e-3)
    assert at_wall[:, 7] == pytest.approx([0.5, 0.5], abs=0.12)
    assert (away[:, 3:] < 1e-3).all()
    # 8 mm further it is 1.3 mm within: the normal distribution's parts beyond 1.3 of 1.5 and of 3 mm
    assert towards[:, 7] == pytest.approx([0.81, 0.67], abs=0.03)
    assert (towards[:, 1] > 1.8 * away[:, 1]).all()


def test_a_push_beside_a_rim_is_told_from_one_onto_it() -> None:
    """By the means over columns near the axis: within 3 mm of the rim they pass from free to blocked."""
    scene = _scene((X > 0) & (Z < -0.006))
    sites = np.arange(-4e-3, 4.1e-3, 1e-3)
    found = np.array([_invariants(scene, _inclined(0), 6e-3, (x, 0, 0))[0, 5] for x in sites])
    assert (np.diff(found) > 0).all()
    assert found[0] < 0.02
    assert found[-1] > 0.98


def test_turning_the_scene_changes_nothing() -> None:
    rigid = (X > 0.004) & (Z < -0.006)
    push, site = _inclined(30, 20), np.array([1e-3, -2e-3, 0])
    turn = Rotation.from_rotvec([0.4, -1.1, 2.0])
    expected = _invariants(_scene(rigid), push, 6e-3, site)
    found = _invariants(_scene(rigid, turn), turn.apply(push), 6e-3, turn.apply(site))
    np.testing.assert_allclose(found, expected, atol=2e-6)


@pytest.mark.parametrize("site", [(0.0, 0.0), (0.012, -0.02), (0.036, 0.03)])
@pytest.mark.parametrize("degrees", [0.0, 20.0, 45.0])
def test_one_poke_at_a_time_has_the_same_samples(site: tuple[float, float], degrees: float) -> None:
    """Also where the way leaves the block at its side."""
    scene = _scene((np.hypot(X - 0.01, Y) < 0.012) & (Z < -0.007))
    start, push = np.array([*site, 0.0]), _inclined(degrees, 35)
    encoded: Any = SimpleNamespace(scene=scene, layers=ahead.layers_of(scene.rigid))
    found = ahead.OneContact(scene, encoded.layers[:, 0])((scene.points.numpy() - start).T, push)
    np.testing.assert_allclose(found, _blocked(scene, start, push)[:, 0], atol=1e-6)
