"""Interpolation between simulated amplitudes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calibration.measurements.indentation._forward import node_weights

NODES = (-0.4, -0.2, 0.0, 0.2, 0.4)


@given(a=st.floats(-0.4, 0.4), curve=st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_a_parabola_is_met(a: float, curve: tuple[float, float, float]) -> None:
    parabola = np.polynomial.Polynomial(curve)
    found = sum(part * parabola(node) for node, part in node_weights(NODES, a, straight=False))
    assert found == pytest.approx(parabola(a), abs=1e-9)


def test_what_lies_at_a_node_weights_goes_on_without_a_jump() -> None:
    """For a fourth power, steps of a thousandth of the range change the interpolant by less than 3e-4."""
    at = np.linspace(-0.5, 0.5, 1001)
    found = [sum(p * n**4 for n, p in node_weights(NODES, a, straight=False)) for a in at]
    assert np.abs(np.diff(found)).max() < 3e-4
    assert np.interp(NODES, at, found) == pytest.approx([n**4 for n in NODES], abs=1e-9)


@pytest.mark.parametrize("a", [-0.3, 0.1, 0.7])
def test_lines_use_two_nodes(a: float) -> None:
    parts = node_weights(NODES, a, straight=True)
    assert len(parts) == 2
    assert sum(p * n for n, p in parts) == pytest.approx(a)


def test_of_two_nodes_there_is_a_line() -> None:
    assert dict(node_weights((0.0, 1.0), 0.3, straight=False)) == pytest.approx({0.0: 0.7, 1.0: 0.3})
