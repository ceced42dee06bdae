"""Stress without a mesh, against tisim's cube of elements and closed forms of incompressible laws."""

from __future__ import annotations

import coupon_cases as made
import numpy as np
import pytest

import tisim
from calibration.measurements.homogeneous import nominal_stress, nominal_stresses

G = 3e4
LAWS = {
    "st-venant-kirchhoff": None,
    "neo-hookean": None,
    "stable-neo-hookean": None,
    "mooney-rivlin": None,
    "arruda-boyce": None,
    "ogden": {"mu": (2e4, -4e3, 5.0), "alpha": (1.7, -2.1, 7.0), "bulk": 20 * G},
}


def _material(law: str, ratio: float = 20.0) -> tisim.Material:
    own = LAWS[law]
    if own is None:
        return tisim.material_from_moduli(law, shear_modulus=G, bulk_modulus=ratio * G)
    return tisim.Material(law=law, parameters=own)


@pytest.mark.parametrize("mode", made.MODES)
@pytest.mark.parametrize("law", LAWS)
def test_agrees_with_finite_elements(law: str, mode: made.CouponMode) -> None:
    # St Venant-Kirchhoff's cube buckles at large compression, and loses equilibrium early in tension
    stretches = (0.95, 1.05, 1.1) if law == "st-venant-kirchhoff" else (0.7, 0.95, 1.3, 2.0)
    solver = tisim.Solver(tolerance=1e-11)
    scene = tisim.Coupon(material=_material(law), mode=mode, stretches=stretches, solver=solver)
    (cube,) = tisim.simulate([scene])
    assert cube.ok
    np.testing.assert_allclose(
        nominal_stress(_material(law), mode, stretches), cube.nominal_stress, rtol=1e-6
    )


_CLOSED = {
    "mooney-rivlin": (
        lambda k: {"c10": 1e4, "c01": 4e3, "bulk": 2.8e4 * k},
        lambda mode, s: made.mooney(1e4, 4e3, mode, s),
    ),
    "neo-hookean": (
        lambda k: {"mu": 2e4, "lam": 2e4 * k},
        lambda mode, s: made.mooney(1e4, 0.0, mode, s),
    ),
    "stable-neo-hookean": (
        lambda k: {"mu": 2e4, "lam": 2e4 * k},
        lambda mode, s: made.mooney(1e4, 0.0, mode, s),
    ),
    "arruda-boyce": (
        lambda k: {"mu": 2e4, "locking": 3.0, "bulk": 2e4 * k},
        lambda mode, s: made.arruda_boyce(2e4, 3.0, mode, s),
    ),
    "ogden": (
        lambda k: {"mu": (2e4, -4e3), "alpha": (1.7, -2.1), "bulk": 2e4 * k},
        lambda mode, s: made.ogden((2e4, -4e3), (1.7, -2.1), mode, s),
    ),
}


@pytest.mark.parametrize("mode", made.MODES)
@pytest.mark.parametrize("law", _CLOSED)
def test_tends_to_the_incompressible_closed_form(law: str, mode: made.CouponMode) -> None:
    """The difference decreases as 1/K."""
    parameters, closed = _CLOSED[law]
    s = np.array([0.5, 0.8, 1.2, 2.0, 3.0])
    exact = closed(mode, s)
    off = [
        np.abs(nominal_stress(tisim.Material(law=law, parameters=parameters(k)), mode, s) / exact - 1).max()
        for k in (1e3, 1e4, 1e5)
    ]
    if mode == "simple-shear":  # isochoric for any K
        assert max(off) < 1e-12
    else:
        assert off[2] < 1e-3
        np.testing.assert_allclose([off[0] / off[1], off[1] / off[2]], 10.0, rtol=0.2)


def test_rest_is_free_of_stress() -> None:
    for law in LAWS:
        for mode in made.MODES:
            assert abs(nominal_stress(_material(law), mode, [1.0])[0]) < 1e-9 * G


def test_no_state_with_free_sides_is_nan() -> None:
    """The lateral stretch of St Venant-Kirchhoff in uniaxial tension, l^2 = 1 - nu (s^2 - 1), has a limit."""
    material = _material("st-venant-kirchhoff", 1000.0)
    nu = (3 * 1000 - 2) / (2 * (3 * 1000 + 1))
    last = np.sqrt(1 + 1 / nu)
    found = nominal_stress(material, "uniaxial", [1.0, 0.995 * last, 1.005 * last, 3.0])
    assert np.isfinite(found).tolist() == [True, True, False, False]
    # E = 2 G (1 + nu) times the Green strain times the stretch
    s = 0.995 * last
    np.testing.assert_allclose(found[1], 2 * G * (1 + nu) * s * (s**2 - 1) / 2, rtol=1e-9)


def test_curves_solved_together_are_those_solved_alone() -> None:
    material = _material("ogden")
    curves = [(mode, np.linspace(0.8, 2.5, 4 + k)) for k, mode in enumerate(made.MODES)]
    together = nominal_stresses(material, curves)
    for (mode, s), stress in zip(curves, together, strict=True):
        np.testing.assert_array_equal(stress, nominal_stress(material, mode, s))
    assert nominal_stress(material, "planar", 1.5).shape == ()
    assert nominal_stress(material, "planar", np.ones((2, 3))).shape == (2, 3)
    assert nominal_stresses(material, []) == []


@pytest.mark.parametrize(
    ("mode", "stretch", "says"),
    [
        ("biaxial", [1.1], "mode: expected one of uniaxial"),
        ("planar", [1.1, 0.0], "planar: expected stretches above 0, got 0"),
        ("uniaxial", [np.nan], "uniaxial: expected finite stretches"),
    ],
)
def test_bad_input_is_one_sentence(mode: str, stretch: list[float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        nominal_stress(_material("neo-hookean"), mode, stretch)  # type: ignore[arg-type]
