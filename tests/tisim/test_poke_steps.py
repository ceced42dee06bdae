"""Load steps of a poke: how well each is solved, and what a refused one costs the next."""

from __future__ import annotations

from typing import Any

import pytest

import tisim
from tisim._newton import Outcome
from tisim._poke import solve_poke
from tisim._poke_condensed import CondensedBlock
from tisim.result import Status


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
    result = solve_poke(
        tisim.Poke(
            material=tisim.material_from_moduli("neo-hookean", shear=30e3, bulk=600e3),
            depth=0.0006,
            frame_spacing=0.0003,
            refinement=0.5,
        )
    )
    assert result.ok
    assert result.cost.step_cuts == 2
    assert result.load == pytest.approx([0.0003, 0.0006])
    assert (result.residual <= 5e-4).all()
    assert [one["max_iterations"] for one in asked[:5]] == [40, 40, 80, 120, 40]
    for one in asked:
        assert one["tolerance"] == pytest.approx(5e-4 if one["kept"] else 3e-3)
    assert sum(one["kept"] for one in asked) >= 2
    assert any(not one["kept"] for one in asked)
