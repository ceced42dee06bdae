"""Load steps of a poke: how well each is solved, and what a refused one costs the next."""

from __future__ import annotations

from typing import Any

import pytest

import tisim
from tisim.nonlinear.newton import Outcome
from tisim.problems.indentation.condensed import CondensedBlock
from tisim.problems.indentation.solve import solve_poke
from tisim.result import Status


def shallow(depth: float) -> tisim.Poke:
    return tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        depth=depth,
        frame_spacing=0.0003,
        refinement=0.5,
    )


def test_frames_are_solved_to_the_tolerance_and_refused_steps_more_patiently(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[dict[str, Any]] = []

    solve = CondensedBlock.solve

    def refusing_two(self: CondensedBlock, x: Any, **options: Any) -> Outcome:
        asked.append(options)
        if len(asked) in (2, 3):
            return Outcome(x, Status.NOT_CONVERGED, 1.0, 5)
        return solve(self, x, **options)

    monkeypatch.setattr(CondensedBlock, "solve", refusing_two)
    result = solve_poke(shallow(0.0006))
    assert result.ok
    assert result.cost.step_cuts == 2
    # the third step that was tried, and refused, was a frame
    assert result.load == pytest.approx([0.00033, 0.0006])
    assert (result.residual <= 5e-4).all()
    assert [one["max_iterations"] for one in asked[:5]] == [40, 40, 80, 120, 40]
    for one in asked:
        assert one["tolerance"] == pytest.approx(5e-4 if one["kept"] else 6e-3)
    assert sum(one["kept"] for one in asked) >= 2
    assert any(not one["kept"] for one in asked)


def test_a_frame_without_equilibrium_is_tried_again_further_on(monkeypatch: pytest.MonkeyPatch) -> None:
    solve = CondensedBlock.solve
    asked: list[tuple[float, bool]] = []

    def refusing_a_frame(self: CondensedBlock, x: Any, **options: Any) -> Outcome:
        depth = self._system.depth
        asked.append((round(depth * 1e3, 6), options["kept"]))
        if options["kept"] and depth < 0.00031:
            return Outcome(x, Status.NOT_CONVERGED, 1e-3, 40)
        return solve(self, x, **options)

    monkeypatch.setattr(CondensedBlock, "solve", refusing_a_frame)
    result = solve_poke(shallow(0.0008))
    assert result.ok
    assert result.cost.step_cuts == 1
    # a tenth of the spacing later, and the next one a spacing after that
    assert result.load == pytest.approx([0.00033, 0.00063, 0.0008])
    tried = [depth for depth, kept in asked if kept]
    assert tried == pytest.approx([0.3, 0.33, 0.63, 0.8])


def test_the_last_depth_is_not_put_off(monkeypatch: pytest.MonkeyPatch) -> None:
    solve = CondensedBlock.solve
    tried: list[float] = []

    def refusing_the_end(self: CondensedBlock, x: Any, **options: Any) -> Outcome:
        tried.append(self._system.depth)
        if self._system.depth > 0.00059:
            return Outcome(x, Status.NOT_CONVERGED, 1e-3, 40)
        return solve(self, x, **options)

    monkeypatch.setattr(CondensedBlock, "solve", refusing_the_end)
    result = solve_poke(shallow(0.0006))
    assert result.status is Status.NOT_CONVERGED
    assert result.load == pytest.approx([0.0003])
    first = next(k for k, depth in enumerate(tried) if depth > 0.00059)
    assert tried[first + 1] < tried[first]  # the step is cut at once


def test_no_step_goes_beyond_the_depth_asked_for() -> None:
    """Nor where the next frame would lie a little beyond it."""
    result = solve_poke(shallow(0.00059))
    assert result.load == pytest.approx([0.0003, 0.00059])
