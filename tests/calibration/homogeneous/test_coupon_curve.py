"""A material's stress curve as a spline agrees with the solved stresses."""

from __future__ import annotations

import coupon_cases as made
import numpy as np
import pytest

import tisim
from calibration.measurements.homogeneous import nominal_stress
from calibration.measurements.homogeneous._curve import LAST, Curve

G = 3e4
RUBBER = tisim.material_from_moduli("neo-hookean", shear_modulus=G, bulk_modulus=3e3 * G)


@pytest.mark.parametrize("mode", made.MODES)
def test_a_curve_has_the_stresses_that_are_solved_for(mode: made.CouponMode) -> None:
    stretch = np.exp(np.random.default_rng(0).uniform(-1.2, 1.8, (3, 40)))
    found = Curve(RUBBER, mode).at(stretch)
    np.testing.assert_allclose(found, nominal_stress(RUBBER, mode, stretch), rtol=1e-7, atol=1e-9 * G)
    assert found.shape == stretch.shape


def test_its_slope_is_good_for_finite_differences() -> None:
    """The finite-difference step of a diagnosis is 1e-4."""
    stretch, step = np.linspace(0.5, 3.0, 60), 1e-4
    curve = Curve(RUBBER, "uniaxial")
    slope = (curve.at(stretch + step) - curve.at(stretch)) / step
    solved = [nominal_stress(RUBBER, "uniaxial", s) for s in (stretch + step, stretch)]
    np.testing.assert_allclose(slope, (solved[0] - solved[1]) / step, rtol=1e-5)


def test_beyond_its_ends_it_is_solved_for() -> None:
    stretch = np.array([1.1, np.exp(LAST + 0.3)])
    expected = nominal_stress(RUBBER, "uniaxial", stretch)
    np.testing.assert_array_equal(Curve(RUBBER, "uniaxial").at(stretch), expected)


def test_a_law_without_stress_somewhere_is_solved_for_elsewhere() -> None:
    """The St Venant-Kirchhoff law has no equilibrium at large tension."""
    material = tisim.material_from_moduli("st-venant-kirchhoff", shear_modulus=G, bulk_modulus=20 * G)
    stretch = np.array([0.95, 1.05, 4.0])
    found = Curve(material, "equibiaxial").at(stretch)
    np.testing.assert_array_equal(found, nominal_stress(material, "equibiaxial", stretch))
    assert np.isfinite(found[:2]).all()
    assert not np.isfinite(found[2])
