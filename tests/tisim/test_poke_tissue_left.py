"""Thickness of the tissue between an indenter of 2.5 mm radius and the nearest rigid body."""

from __future__ import annotations

import numpy as np
import pytest

import tisim
from tisim.problems.indentation.rod import tissue_left

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=6e5)
BOX = tisim.BoxInclusion(size=(0.012, 0.012, 0.010), centre=(0.0, 0.0, 0.005))


@pytest.mark.parametrize(
    ("inclusion", "tip", "gap", "nearest"),
    [
        (None, (0.0, 0.0, 0.012), 0.012, "base"),
        (BOX, (0.0, 0.0, 0.012), 0.002, "inclusion"),
        (BOX, (0.010, 0.0, 0.004), 0.0015, "inclusion"),  # the shaft is beside the box
        (BOX, (0.010, 0.0, 0.001), 0.001, "base"),
        (BOX, (0.030, 0.0, 0.012), 0.012, "base"),
        (BOX, (0.0, 0.0, 0.009), 0.0, "inclusion"),  # not below 0
    ],
)
def test_it_is_the_gap_to_the_nearest_rigid_body(
    inclusion: tisim.Inclusion | None, tip: tuple[float, float, float], gap: float, nearest: str
) -> None:
    scene = tisim.Poke(material=SOFT, block=tisim.Block(inclusion=inclusion))
    left, where = tissue_left(scene, np.array(tip), np.array([0.0, 0.0, -1.0]))
    assert left == pytest.approx(gap, abs=1e-9)
    assert where == nearest


def test_a_tilted_rod_is_nearest_with_its_edge() -> None:
    """At 45 degrees: the edge is a torus with the radii 1.5 and 1 mm."""
    scene = tisim.Poke(material=SOFT)
    left, where = tissue_left(scene, np.array([0.0, 0.0, 0.012]), np.array([1.0, 0.0, -1.0]))
    # the centre of the torus's tube is 1 mm behind the tip
    lowest = 0.012 + (0.001 - 0.0015) * np.sqrt(0.5) - 0.001
    assert (left, where) == (pytest.approx(lowest, abs=2e-5), "base")
