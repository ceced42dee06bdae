"""Load steps of an indentation: their accuracy, and the effect of a rejected step on the next."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import tisim
from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.damped import solve_step
from tisim.problems.indentation.solve import solve_poke
from tisim.problems.indentation.system import PokeSystem
from tisim.result import Status


def shallow(depth: float) -> tisim.Poke:
    return tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        depth=depth,
        frame_spacing=0.0003,
        refinement=0.5,
    )


Refuse = Callable[[float, bool], bool]  # of depth [m] and of True if the step ends in a frame


def refusing(monkeypatch: pytest.MonkeyPatch, refuse: Refuse) -> list[dict[str, Any]]:
    """Let steps fail if `refuse` is true for them; return the list of all requested steps."""
    asked: list[dict[str, Any]] = []

    def solve(
        system: PokeSystem, block: CondensedBlock, x: Any, **options: Any
    ) -> tuple[Outcome, Status | None]:
        asked.append({"depth": system.depth, **options})
        if refuse(system.depth, options["kept"]):
            return Outcome(x, Status.NOT_CONVERGED, 1.0, 5), Status.NOT_CONVERGED
        return solve_step(system, block, x, **options)

    monkeypatch.setattr("tisim.problems.indentation.solve.solve_step", solve)
    return asked


def test_frames_are_solved_to_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    count = iter(range(100))
    asked = refusing(monkeypatch, lambda *_: next(count) in (1, 2))
    result = solve_poke(shallow(0.0006))
    assert result.ok
    assert result.cost.step_cuts == 2
    # the third attempted step, which was rejected, was a frame
    assert result.load == pytest.approx([0.00033, 0.0006])
    assert (result.residual <= 5e-4).all()
    for one in asked:
        assert one["tolerance"] == pytest.approx(5e-4 if one["kept"] else 6e-3)
    assert sum(one["kept"] for one in asked) >= 2
    assert any(not one["kept"] for one in asked)


def test_a_frame_without_equilibrium_is_tried_again_further_on(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = refusing(monkeypatch, lambda depth, kept: kept and depth < 0.00031)
    result = solve_poke(shallow(0.0008))
    assert result.ok
    assert result.cost.step_cuts == 1
    # a tenth of the spacing further on, and the next one a full spacing after it
    assert result.load == pytest.approx([0.00033, 0.00063, 0.0008])
    tried = [1e3 * one["depth"] for one in asked if one["kept"]]
    assert tried == pytest.approx([0.3, 0.33, 0.63, 0.8])


def test_the_last_depth_is_not_put_off(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = refusing(monkeypatch, lambda depth, _: depth > 0.00059)
    result = solve_poke(shallow(0.0006))
    assert result.status is Status.NOT_CONVERGED
    assert result.load == pytest.approx([0.0003])
    tried = [one["depth"] for one in asked]
    first = next(k for k, depth in enumerate(tried) if depth > 0.00059)
    assert tried[first + 1] < tried[first]  # the step is cut at once


def test_no_step_goes_beyond_the_depth_asked_for() -> None:
    """This also holds if the next frame would lie slightly beyond the final depth."""
    result = solve_poke(shallow(0.00059))
    assert result.load == pytest.approx([0.0003, 0.00059])
