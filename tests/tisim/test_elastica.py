"""A slender cantilever against the large-deflection elastica."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from static_cases import deflection, neo_hookean

from tisim.bodies import Circle, Rectangle
from tisim.problems.beam.solve import solve_beam
from tisim.scene import Beam

LENGTH, RATIO, DENSITY, G = 0.1, 1000.0, 1000.0, 9.81


def elastica(bending, line, tip):
    """End displacement (dx, dz) [m] of EI theta'' = -(q (L - s) + F) cos(theta), loads downwards.

    Bending stiffness EI [N m2], line load q [N/m], tip force F [N]; theta is the angle below the horizontal.
    """

    def slope(s, y):
        return np.vstack([y[1], -(line * (LENGTH - s) + tip) / bending * np.cos(y[0])])

    s = np.linspace(0, LENGTH, 200)
    start = np.vstack([s / LENGTH, np.full_like(s, 1 / LENGTH)])
    found = solve_bvp(slope, lambda a, b: np.array([a[0], b[1]]), s, start, tol=1e-8)
    assert found.success
    fine = np.linspace(0, LENGTH, 20001)
    theta = found.sol(fine)[0]
    return np.trapezoid(np.cos(theta), fine) - LENGTH, -np.trapezoid(np.sin(theta), fine)


CIRCLE, FLAT = Circle(radius=0.001), Rectangle(width=0.0016, height=0.0012)


@pytest.mark.parametrize(
    ("section", "mu", "tip"),
    [(CIRCLE, 2e6, 0.0), (CIRCLE, 5e5, 0.0), (CIRCLE, 2e6, 2e-3), (FLAT, 2.5e6, -1e-3)],
    ids=["bent", "hanging", "tip force", "flat, tip force up"],
)
def test_thin_cantilever_is_the_elastica(section, mu, tip):
    young = 9 * RATIO / (3 * RATIO + 1) * mu
    if isinstance(section, Circle):
        area, inertia = np.pi * section.radius**2, np.pi * section.radius**4 / 4
    else:
        area, inertia = section.width * section.height, section.width * section.height**3 / 12
    wanted = elastica(young * inertia, DENSITY * area * G, tip)
    scene = Beam(
        material=neo_hookean(mu, RATIO),
        length=LENGTH,
        section=section,
        tip_force=(0.0, 0.0, -tip),
        axial_element_size=0.004,
    )
    result = solve_beam(scene)
    found = deflection(result)[[0, 2]]
    assert np.linalg.norm(wanted) > 0.25 * LENGTH
    # the rod extends by 1e-3, and the clamp shortens it by a fraction of a radius
    assert np.abs(found - wanted).max() < 0.005 * np.linalg.norm(wanted)
    assert result.support_force[0, 2] == pytest.approx(DENSITY * area * LENGTH * G + tip, rel=1e-5)
