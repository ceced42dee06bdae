"""Indentation with every law: balance of forces, and equal forces at small strain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import tisim
from tisim import laws
from tisim.problems.indentation.solve import solve_poke

SHEAR, BULK = 20e3, 600e3


SHALLOW, DEEP = 0.04e-3, 2e-3


def poked(law: str, depth: float, *, element: Any = "default") -> tisim.Result:
    """Result at a depth, at 20 degrees on a coarse mesh."""
    angle = np.radians(20.0)
    return solve_poke(
        tisim.Poke(
            material=tisim.material_from_moduli(law, shear_modulus=SHEAR, bulk_modulus=BULK),
            direction=(float(np.sin(angle)), 0.0, -float(np.cos(angle))),
            depth=depth,
            frame_spacing=depth / 2,
            refinement=0.5,
            element=element,
        )
    )


def size(result: tisim.Result) -> float:
    """Magnitude of the final indenter force [N]."""
    return float(np.linalg.norm(result.rod_force[-1]))


@pytest.fixture(scope="module")
def neo_hookean() -> tuple[float, float]:
    return size(poked("neo-hookean", SHALLOW)), size(poked("neo-hookean", DEEP))


@pytest.mark.parametrize("law", [name for name in laws.names() if name != "neo-hookean"])
def test_a_law_pokes(law: str, neo_hookean: tuple[float, float]) -> None:
    # this law softens in compression: beyond 1 mm it converges on linear hexahedra only
    element = "hex8" if law == "st-venant-kirchhoff" else "default"
    shallow, deep = (poked(law, depth, element=element) for depth in (SHALLOW, DEEP))
    if element == "hex8":
        neo_hookean = size(poked("neo-hookean", SHALLOW, element=element)), neo_hookean[1]
    for found, depth in ((shallow, SHALLOW), (deep, DEEP)):
        assert found.ok
        assert found.load[-1] == pytest.approx(depth)
        assert np.linalg.norm(found.rod_force - found.support_force, axis=1).max() < 0.01 * size(found)
        assert (found.min_jacobian > 0).all()
    assert size(shallow) == pytest.approx(neo_hookean[0], rel=0.03)  # depends on the moduli only
    assert size(deep) != pytest.approx(neo_hookean[1], rel=1e-4)  # depends on the law
    low, high = (0.5, 0.7) if law == "st-venant-kirchhoff" else (0.9, 1.2)
    assert low < size(deep) / neo_hookean[1] < high
