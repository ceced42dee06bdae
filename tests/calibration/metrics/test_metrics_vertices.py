"""The vertex variants by hand, and the bias from volume nodes in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from calibration.metrics import vertex_distance, vertex_hd95


def test_by_hand() -> None:
    a = np.array([[0.0, 0, 0], [1, 0, 0], [4, 0, 0]])
    b = np.array([[0.0, 0, 0], [1, 2, 0]])
    # a to b: 0, 1 (to the first), sqrt(13) (to the second); b to a: 0, 2
    assert vertex_distance(a, b) == pytest.approx(((0 + 1 + np.sqrt(13)) / 3 + (0 + 2) / 2) / 2)
    assert vertex_distance(b, a) == pytest.approx(vertex_distance(a, b))
    there, back = 1 + 0.9 * (np.sqrt(13) - 1), 0.95 * 2
    assert vertex_hd95(a, b) == pytest.approx((there + back) / 2)


def test_volume_nodes_are_a_third_of_the_radius_away_from_their_own_surface() -> None:
    """Uniform nodes of a disc are R/3 from its rim on average, and 95 % lie within R (1 - sqrt(0.05))."""
    R = 0.01
    k = np.arange(20_000) + 0.5
    radius, turn = R * np.sqrt(k / len(k)), k * np.pi * (3 - np.sqrt(5))
    nodes = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), 0 * k])
    phi = np.linspace(0, 2 * np.pi, 8_000, endpoint=False)
    rim = R * np.column_stack([np.cos(phi), np.sin(phi), 0 * phi])
    assert vertex_distance(nodes, rim) == pytest.approx(R / 6, rel=0.03)
    assert vertex_hd95(nodes, rim) == pytest.approx(R * (1 - np.sqrt(0.05)) / 2, rel=0.03)


@pytest.mark.parametrize("shape", [(0, 3), (5, 2), (5,)])
def test_other_shapes_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="first points: expected shape"):
        vertex_distance(np.zeros(shape), np.zeros((4, 3)))
