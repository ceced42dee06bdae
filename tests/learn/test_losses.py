"""The loss computed by hand: two frames, two points."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from learn.models import Response
from learn.training import Recipe
from learn.training.recipe import _log_error, loss_of

DEPTH = (0.002, 0.008)  # m
WRONG_MM = np.array([[3.0, 1.0], [0.5, 2.0]])  # frame, point
AWAY_MM = np.array([0.0, 6.0])


def _loss(**recipe: Any) -> tuple[float, float]:
    """Loss of the displacement [mm] and of the force; predicted forces are twice and half the true ones."""
    points = torch.tensor([[0.0, 0.0, 0.0], [AWAY_MM[1] * 1e-3, 0.0, 0.0]], dtype=torch.float64)
    displacement = torch.zeros(2, 2, 3)
    displacement[..., 1] = torch.tensor(WRONG_MM * 1e-3, dtype=torch.float32)
    batch: Any = SimpleNamespace(
        displacement=torch.zeros(2, 2, 3),
        start=torch.zeros(2, 3, dtype=torch.float64),
        depth=torch.tensor(DEPTH, dtype=torch.float64),
        force=torch.tensor([1.0, 4.0]),
    )
    scene: Any = SimpleNamespace(points=points)
    statistics: Any = SimpleNamespace(force_rms=2.0)
    found = loss_of(
        [(Response(displacement=displacement, force=torch.tensor([2.0, 2.0])), batch, scene)],
        Recipe(**recipe),
        statistics,
    )
    return float(found.displacement), float(found.force)


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("near", "width"), [(0.0, 4.0), (60.0, 4.0), (20.0, 6.0)])
def test_displacement_weighs_the_near_and_the_shallow(power: float, near: float, width: float) -> None:
    of_point = 1 + near * np.exp(-0.5 * (AWAY_MM / width) ** 2)
    weight = of_point * np.array(DEPTH)[:, None] ** -power
    found, _ = _loss(near_weight=near, near_width_mm=width, depth_power=power)
    assert found == pytest.approx((weight * WRONG_MM).sum() / weight.sum(), rel=2e-3)


def test_a_force_of_the_wrong_sign_has_a_slope_towards_the_truth() -> None:
    """The logarithm alone has none: a network that begins there would never learn the force."""
    ratio = torch.tensor([-1.0, 0.0, 0.02, 0.05, 0.5, 2.0], dtype=torch.float64, requires_grad=True)
    error = _log_error(ratio)
    error.sum().backward()
    assert ratio.grad is not None
    assert (ratio.grad[:5] < 0).all()
    assert ratio.grad[5] > 0
    np.testing.assert_allclose(error[3:].detach(), np.abs(np.log([0.05, 0.5, 2.0])))
    assert (np.diff(error[:5].detach().numpy()) < 0).all()


def test_force_in_logarithms_or_squares() -> None:
    assert _loss(force_loss="log")[1] == pytest.approx(np.log(2.0), rel=1e-6)
    assert _loss(force_loss="square")[1] == pytest.approx((0.5**2 + 1.0**2) / 2, rel=1e-6)
