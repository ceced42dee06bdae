"""Resampled fits: coordinates that only one group constrains are eliminated, which changes no result."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from calibration.diagnosis.engine import resampling
from calibration.diagnosis.engine.resampling import RIDGE, Groups, Resampled

GROUPS, EACH, OWN, SHARED = 7, 20, 2, 4


@dataclass
class Linear:
    """The part of a fit that resampling uses."""

    z: np.ndarray
    jacobian: np.ndarray


def fit_with_own_coordinates(seed: int) -> tuple[Linear, Groups]:
    """Shared coordinates, then OWN per group; the prior couples two of these, and alone constrains one."""
    random = np.random.default_rng(seed)
    n = SHARED + OWN * GROUPS
    rows = np.zeros((GROUPS * EACH, n))
    rows[:, : SHARED - 1] = random.standard_normal(
        (len(rows), SHARED - 1)
    )  # only the prior constrains the last one
    for g in range(GROUPS):
        here = slice(EACH * g, EACH * (g + 1))
        own = slice(SHARED + OWN * g, SHARED + OWN * (g + 1))
        rows[here, own] = random.standard_normal((EACH, OWN)) * (1e3, 1e-2)
    prior = np.diag(random.uniform(0.1, 1.0, n))
    prior[SHARED, SHARED + OWN] = 0.4
    jacobian = np.vstack([rows, prior])
    of_row = np.r_[np.repeat(np.arange(GROUPS), EACH), np.full(n, -1)]
    names = tuple(f"test {g}" for g in range(GROUPS))
    fit = Linear(z=random.standard_normal(len(jacobian)), jacobian=jacobian)
    return fit, Groups(over="tests", of_row=of_row, names=names)


def test_elimination_gives_what_the_whole_system_gives() -> None:
    fit, groups = fit_with_own_coordinates(1)
    drawn = groups.draws(20, seed=2)
    assert (drawn == 0.0).any()  # only the prior constrains a group that is not drawn
    found = Resampled(fit, groups).replicates(drawn)  # type: ignore[arg-type]
    size = np.linalg.norm(fit.jacobian, axis=0)
    scaled = fit.jacobian / size
    for k, times in enumerate(drawn):
        weight = np.where(groups.of_row < 0, 1.0, times[groups.of_row])
        whole = (scaled.T * weight) @ scaled + RIDGE * np.eye(scaled.shape[1])
        slope = scaled.T @ (weight * fit.z)
        moves = -np.linalg.solve(whole, slope)
        taken = np.trace(np.linalg.solve(whole, (scaled.T * weight**2) @ scaled))
        assert found.moves[k] == pytest.approx(moves / size, rel=1e-8, abs=1e-12)
        assert found.chi2[k] == pytest.approx(weight @ fit.z**2 + slope @ moves, rel=1e-9)
        assert found.expected[k] == pytest.approx(weight.sum() - taken, rel=1e-9)


def test_what_is_solved_in_each_replicate_is_what_groups_share(monkeypatch: pytest.MonkeyPatch) -> None:
    fit, groups = fit_with_own_coordinates(3)
    sizes = []
    solve = np.linalg.solve

    def watched(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        sizes.append(a.shape[-1])
        return np.asarray(solve(a, b))

    monkeypatch.setattr(resampling.np.linalg, "solve", watched)
    Resampled(fit, groups).replicates(groups.draws(5, seed=0))  # type: ignore[arg-type]
    assert sizes == [SHARED + 2]  # and the two that the prior couples
