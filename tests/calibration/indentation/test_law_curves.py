"""Shape coordinates of laws: the coordinates, beside the modulus, that change an indentation's force."""

from __future__ import annotations

import numpy as np
import pytest

import tisim
from calibration.measurements.indentation._curve_cache import CurveCache
from calibration.measurements.indentation._law_curves import LawCurves
from calibration.measurements.indentation._scene import BULK_RATIO, SHEAR
from calibration.parameters import Parametrisation, parametrisation

LAWS = [(name, 1) for name in tisim.laws.names()] + [("ogden", 2), ("ogden", 3)]


def curves(law: Parametrisation) -> LawCurves:
    return LawCurves(law, [], CurveCache(1))


@pytest.mark.parametrize(("law", "terms"), LAWS)
def test_the_shape_is_all_but_the_modulus(law: str, terms: int) -> None:
    """For random coordinates, a stiffer material has the same shape, and both share one simulation."""
    p = parametrisation(law, terms=terms)
    found = curves(p)
    rng = np.random.default_rng(3)
    for _ in range(20):
        u = p.start(shear=1e4) + rng.uniform(-0.5, 0.5, len(p.names)) * p.spread
        stiffer = u + [np.log(7.0) if n.startswith("shear") else 0.0 for n in p.names]
        np.testing.assert_allclose(found._shape(stiffer), found._shape(u), atol=1e-7)
        assert len(found._shape(u)) == len(p.names) - 1
        for at in (u, stiffer):
            moduli = tisim.laws.get(p.law).moduli(found._material(at).parameters)
            assert moduli.shear_modulus == pytest.approx(SHEAR)
            ratio = p.moduli(at).bulk_modulus / p.moduli(at).shear_modulus
            assert moduli.bulk_modulus / SHEAR == pytest.approx(ratio)


@pytest.mark.parametrize(("law", "terms"), LAWS)
def test_a_held_bulk_ratio_is_that_of_a_diagnosis(law: str, terms: int) -> None:
    p = parametrisation(law, terms=terms).holding("bulk_ratio")
    found = curves(p)
    u = p.start(shear=1e4) + [np.log(1.01) if n == "bulk_ratio" else 0.0 for n in p.names]
    assert len(found._shape(u)) == len(p.names) - 1 - ("bulk_ratio" in p.names)
    moduli = tisim.laws.get(p.law).moduli(found._material(u).parameters)
    assert moduli.bulk_modulus / moduli.shear_modulus == pytest.approx(BULK_RATIO)


@pytest.mark.parametrize(("law", "terms"), LAWS)
def test_a_step_moves_one_coordinate(law: str, terms: int) -> None:
    p = parametrisation(law, terms=terms)
    found, u = curves(p), p.start(shear=1e4)
    for i, k in enumerate(found._free):
        step = found._shape(found._moved(u, k)) - found._shape(u)
        assert step[i] != 0.0
        np.testing.assert_allclose(np.delete(step, i), 0.0, atol=1e-7)


def test_steps_stay_in_range() -> None:
    share = parametrisation("mooney-rivlin")
    found, high = curves(share), np.array([np.log(1e4), np.log(3.0), 1.0])
    for k in found._free:
        values = share.values(found._moved(high, k))
        assert all(c.low <= values[c.name] <= c.high for c in share.coordinates), values
