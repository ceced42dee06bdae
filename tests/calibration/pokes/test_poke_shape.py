"""Materials as scale and shape: the inverse of the search coordinates."""

from __future__ import annotations

import numpy as np
import pytest

import tisim
from calibration.parameters import parametrisation
from calibration.pokes import _shape

LAWS = [(name, 1) for name in tisim.laws.names()] + [("ogden", 2), ("ogden", 3)]


@pytest.mark.parametrize(("law", "terms"), LAWS)
def test_values_are_the_inverse(law: str, terms: int) -> None:
    """For random coordinates: values come back, and none of them is the scale's."""
    p = parametrisation(law, terms=terms)
    rng = np.random.default_rng(3)
    for _ in range(20):
        u = p.start(shear=1e4) + rng.uniform(-0.5, 0.5, len(p.names)) * p.spread
        material = p.material(u)
        found = _shape.values(material)
        assert found == pytest.approx(p.values(u), rel=1e-6)
        stiffer = p.material(u + [np.log(7.0) if n.startswith("shear") else 0.0 for n in p.names])
        np.testing.assert_allclose(_shape.shape(stiffer), _shape.shape(material), atol=1e-7)
        assert len(_shape.shape(material)) == len(p.names) - 1


@pytest.mark.parametrize(("law", "terms"), LAWS)
def test_a_step_moves_one_coordinate(law: str, terms: int) -> None:
    p = parametrisation(law, terms=terms)
    material = p.material(p.start(shear=1e4))
    for i, name in enumerate(_shape.shape_names(material)):
        step = _shape.shape(_shape.moved(material, name)) - _shape.shape(material)
        assert step[i] != 0.0
        np.testing.assert_allclose(np.delete(step, i), 0.0, atol=1e-7)


def test_steps_stay_in_range() -> None:
    share = parametrisation("mooney-rivlin")
    high = share.material([np.log(1e4), np.log(3.0), 1.0])
    for name in _shape.shape_names(high):
        values = _shape.values(_shape.moved(high, name))
        assert all(c.low <= values[c.name] <= c.high for c in share.coordinates), values


def test_what_coordinates_cannot_give_is_refused() -> None:
    one = tisim.Material(law="ogden", parameters={"mu": (2e4, -1e3), "alpha": (2.0, 4.0), "bulk": 1e6})
    with pytest.raises(ValueError, match="ogden: expected parameters"):
        _shape.values(one)
