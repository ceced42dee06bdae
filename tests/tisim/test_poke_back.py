"""Retraction of the indenter: if the surface slid during loading, unloading is softer."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tisim

TABLE = json.loads(
    (Path(__file__).parents[2] / "benchmarks" / "blind" / "indentation" / "forces.json").read_text(
        encoding="utf-8"
    )
)
SHEAR = 1e4
BLOCK = tisim.Block(size=(0.1, 0.1, 0.012))
ROD = tisim.Rod(radius=4e-3, edge_radius=1.6e-3)


def poke(friction: float, *, back: float | None = 0.5e-3, refinement: float = 1.0) -> tisim.Result:
    soft = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR)
    scene = tisim.Poke(
        material=soft,
        block=BLOCK,
        rod=ROD,
        depth=3e-3,
        retract_to=back,
        friction=friction,
        frame_spacing=0.5e-3,
        refinement=refinement,
    )
    (result,) = tisim.simulate([scene], workers=1)
    return result


@pytest.fixture(scope="module")
def there_and_back() -> tisim.Result:
    """To 3 mm at a friction coefficient of 0.1, and back to a depth between two frames, on a coarse mesh."""
    return poke(0.1, back=0.4e-3, refinement=0.6)


def missing(result: tisim.Result, depth: np.ndarray) -> np.ndarray:
    """Relative loss of force on unloading at these depths, 1 - F_unload / F_load."""
    turn = int(np.argmax(result.load))
    force = -result.rod_force[:, 2]
    into = np.interp(depth, result.load[: turn + 1], force[: turn + 1])
    back = np.interp(depth, result.load[turn:][::-1], force[turn:][::-1])
    return np.asarray(1.0 - back / into)


def test_what_sliding_takes_agrees_with_axisymmetric_elements(there_and_back: tisim.Result) -> None:
    """FElupe at a friction coefficient of 0.1 loses up to 3.5 % of the force.

    The table is made by `python -m benchmarks.blind.indentation.make_table --only "thin friction 0.1"`. The
    loss is in error by 0.3 % of the force on this mesh as on the default one.
    """
    result = there_and_back
    assert result.status is tisim.Status.CONVERGED
    table = TABLE["thin friction 0.1"]
    depth, into, back = (np.array(table[k]) for k in ("depth", "in", "out"))
    at = (depth[:-1] > 0.7) & (depth[:-1] < 2.9)
    theirs = 1.0 - back[at] / into[:-1][at]
    assert theirs.max() > 0.03
    assert missing(result, 1e-3 * depth[:-1][at]) == pytest.approx(theirs, abs=0.008)


@pytest.mark.slow
def test_where_nothing_slides_the_way_back_is_the_way_there() -> None:
    """Without sliding the forces of loading and unloading agree to 0.1 % at a refinement of 1.2."""
    result = poke(0.6, refinement=1.2)
    assert result.status is tisim.Status.CONVERGED
    assert missing(result, np.linspace(0.6e-3, 2.9e-3, 12)) == pytest.approx(0.0, abs=1e-3)


def test_frames_of_the_way_back_are_equilibria_at_even_depths(there_and_back: tisim.Result) -> None:
    result = there_and_back
    into = np.arange(0.5, 3.1, 0.5)
    assert 1e3 * result.load == pytest.approx([*into, *into[:-1][::-1], 0.4])
    size = np.linalg.norm(result.rod_force, axis=1)
    assert (np.linalg.norm(result.rod_force - result.support_force, axis=1) < 2e-3 * size).all()
    assert result.rod_tip[:, 2] == pytest.approx(0.012 - result.load)


@pytest.mark.parametrize("back", [-1e-4, 3e-3, float("nan")])
def test_a_rod_is_drawn_back_to_between_the_surface_and_its_depth(back: float) -> None:
    with pytest.raises(ValueError, match="retract_to: expected a depth"):
        poke(0.1, back=back)
