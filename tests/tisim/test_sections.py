"""Sizes and moments of sections against closed forms and against sums over a fine grid."""

import numpy as np
import pytest

from tisim import Circle, Rectangle

CIRCLE, RECTANGLE = Circle(radius=0.010), Rectangle(width=0.012, height=0.020)


def test_sizes_and_moments_of_a_circle_are_the_closed_forms():
    assert (CIRCLE.half_width, CIRCLE.half_height) == (0.010, 0.010)
    assert CIRCLE.area == pytest.approx(np.pi * 1e-4, rel=1e-15)
    assert CIRCLE.second_moment("y") == pytest.approx(np.pi / 4.0 * 1e-8, rel=1e-15)
    assert CIRCLE.second_moment("z") == CIRCLE.second_moment("y")


def test_sizes_and_moments_of_a_rectangle_are_the_closed_forms():
    assert (RECTANGLE.half_width, RECTANGLE.half_height) == (0.006, 0.010)
    assert RECTANGLE.area == pytest.approx(2.4e-4, rel=1e-15)
    assert RECTANGLE.second_moment("y") == pytest.approx(0.012 * 0.020**3 / 12.0, rel=1e-15)
    assert RECTANGLE.second_moment("z") == pytest.approx(0.020 * 0.012**3 / 12.0, rel=1e-15)


@pytest.mark.parametrize("section", [CIRCLE, RECTANGLE])
def test_area_and_moments_are_the_integrals_over_the_section(section):
    n = 2000
    middle = (np.arange(n) + 0.5) / n * 2.0 - 1.0
    y, z = np.meshgrid(section.half_width * middle, section.half_height * middle, indexing="ij")
    inside = np.hypot(y, z) < section.radius if isinstance(section, Circle) else np.ones_like(y, dtype=bool)
    cell = 4.0 * section.half_width * section.half_height / n**2
    assert section.area == pytest.approx(cell * inside.sum(), rel=1e-4)
    assert section.second_moment("y") == pytest.approx(cell * (z**2)[inside].sum(), rel=1e-4)
    assert section.second_moment("z") == pytest.approx(cell * (y**2)[inside].sum(), rel=1e-4)


def test_scaled_sizes_are_multiples_and_grown_edges_move_outward():
    assert CIRCLE.scaled(1.5) == Circle(radius=1.5 * 0.010)
    assert RECTANGLE.scaled(1.5) == Rectangle(width=1.5 * 0.012, height=1.5 * 0.020)
    assert CIRCLE.grown(1e-3) == Circle(radius=0.010 + 1e-3)
    assert RECTANGLE.grown(-1e-3) == Rectangle(width=0.012 - 2e-3, height=0.020 - 2e-3)
    for section in (CIRCLE, RECTANGLE):
        bigger = section.grown(2e-3)
        assert bigger.half_width - section.half_width == pytest.approx(2e-3)
        assert bigger.half_height - section.half_height == pytest.approx(2e-3)
