"""Contact under a round tip is stiff enough that its penetration does not reduce the force."""

from __future__ import annotations

import pytest

import tisim


def test_a_ball_sinks_in_by_little() -> None:
    """Hertz's maximum pressure at 1 mm under a ball of 4 mm is 1.3 shear moduli.

    With a contact stiffness of 200 shear moduli over 0.4 radii the penetration is 0.0104 mm; over the whole
    radius it would be 0.025 mm.
    """
    soft = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=2e5)
    ball = tisim.Rod(radius=4e-3, tip="hemisphere")
    poke = tisim.Poke(material=soft, depth=1e-3, rod=ball, refinement=1.3, frame_spacing=1e-3)
    (result,) = tisim.simulate([poke], workers=1)
    assert result.status is tisim.Status.CONVERGED
    assert result.penetration[-1] == pytest.approx(1.3 * 0.4 * ball.radius / 200, rel=0.1)
