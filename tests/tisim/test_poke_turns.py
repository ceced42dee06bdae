"""Indentations whose rod rotates over time, and paths that leave the block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim
from tisim.problems.indentation import system as contact
from tisim.problems.indentation import turning
from tisim.problems.indentation.solve import solve_poke

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=6e5)
TILT = (float(np.sin(np.radians(20.0))), 0.0, -float(np.cos(np.radians(20.0))))
DOWN = (0.0, 0.0, -1.0)
IN = tisim.Course(frames=(1.0, 2.0, 3.0)).ramp(to=2e-3, duration=1.0).hold(1.0).hold(1.0)
POKE = tisim.Poke(material=SOFT, refinement=0.5, course=IN, friction=0.3)


def force(result: tisim.Result) -> np.ndarray:
    assert result.ok, result.message
    assert result.rod_force is not None
    return result.rod_force


def test_a_rod_that_turns_aside_is_pushed_back_and_comes_back_to_where_it_was() -> None:
    """Frames: straight, tilted by 20 degrees, straight again."""
    scene = replace(POKE, turns=((1.0, DOWN), (2.0, TILT), (3.0, DOWN)), friction=0.0)
    found = tisim.simulate(scene)
    tilted = tisim.simulate(replace(POKE, direction=TILT, friction=0.0))
    turned = force(found)
    small = 0.02 * np.linalg.norm(turned[0])
    # without friction and history only the pose matters
    assert turned[1] == pytest.approx(force(tilted)[-1], rel=0.05, abs=small)
    assert np.linalg.norm(turned[1] - turned[0]) > 5.0 * small
    assert turned[2] == pytest.approx(turned[0], abs=small)
    assert found.rod_tip is not None
    assert tilted.rod_tip is not None
    assert found.rod_tip[1] == pytest.approx(tilted.rod_tip[-1], abs=1e-12)
    assert found.cost.steps >= tilted.cost.steps + 2  # a rotation takes several load steps


def gap_to_rod(from_tip: np.ndarray) -> np.ndarray:
    """Distance (n,) [m] of points (n, 3), relative to the tip, from an indenter that points down."""
    aside, ahead = np.hypot(from_tip[:, 0], from_tip[:, 1]), -from_tip[:, 2]
    edge, core = POKE.rod.edge_radius, POKE.rod.radius - POKE.rod.edge_radius
    return np.asarray(np.hypot(np.maximum(aside - core, 0.0), np.maximum(ahead + edge, 0.0)) - edge)


def test_a_sticking_surface_follows_the_rods_own_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sticking point follows the indenter's rotation, which is not counted as slip.

    With a fourth of the elastic slip in use, which gives way by a sixth of the motion at this low pressure.
    """
    monkeypatch.setattr(contact, "ELASTIC_SLIP", 0.25 * contact.ELASTIC_SLIP)
    scene = replace(POKE, turns=((1.0, DOWN), (2.0, TILT)), friction=50.0, refinement=0.8)
    found = solve_poke(scene)
    assert found.ok, found.message
    assert found.rod_tip is not None
    x, tip = found.positions, found.rod_tip
    R = turning.rotation(np.array(DOWN), np.array(TILT))
    from_tip = x[0] - tip[0]
    before, after = gap_to_rod(from_tip), gap_to_rod((x[1] - tip[1]) @ R)
    edge, core = POKE.rod.edge_radius, POKE.rod.radius - POKE.rod.edge_radius
    # at the rounded edge the rotation is tangential to the surface; behind it the edge lifts off
    touching = (before < 0.06 * edge) & (after < 0.06 * edge)
    assert touching.sum() > 0.9 * (before < 0.06 * edge).sum()
    assert (np.hypot(from_tip[touching, 0], from_tip[touching, 1]) > 1.3 * core).sum() >= 4
    wanted = tip[1] + from_tip[touching] @ R.T
    moved = np.linalg.norm(wanted - x[0][touching], axis=1)
    assert (np.linalg.norm(x[1][touching] - wanted, axis=1) < 0.15 * moved).all()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"course": None, "turns": ((1.0, TILT),)}, r"Poke\.turns: expected none without a course"),
        ({"turns": (1.0, TILT)}, r"Poke\.turns: expected pairs of a time \[s\] and a direction"),
        ({"turns": ((0.5, TILT),)}, r"Poke\.turns: expected rising times above 0 s at which a piece of the"),
        ({"turns": ((2.0, TILT), (1.0, DOWN))}, r"Poke\.turns: expected rising times above 0 s"),
        ({"turns": ((1.0, (1.0, 0.0, -0.5)),)}, r"Poke\.turns: expected a push within 45 degrees"),
        (
            {"course": None, "depth": 0.01, "site": (0.049, 0.0), "direction": TILT},
            r"Poke\.direction: expected a path within the body's sides \(x -50 to 50, y -50 to 50 mm\)",
        ),
        (
            {"site": (0.0, -0.0497), "turns": ((1.0, (0.0, -0.3, -1.0)),)},
            r"Poke\.turns: expected a path within the body's sides .* y = -50\.3 mm",
        ),
    ],
)
def test_turns_and_paths_that_cannot_be_are_refused(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence) as error:
        tisim.simulate(replace(POKE, **changes))  # type: ignore[arg-type]
    assert "\n" not in str(error.value)
