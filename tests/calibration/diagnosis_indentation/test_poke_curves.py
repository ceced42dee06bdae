"""Curves of two meshes combined: forces of the finer one, and relative changes of the coarser one."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from poke_records import trial

from calibration.measurements.indentation import TOGETHER
from calibration.measurements.indentation._curve import COARSE, FINE, Curve, changed, deepened, smoothed
from calibration.measurements.indentation._forward import at_depths
from calibration.measurements.indentation._noise import nuisances
from calibration.measurements.indentation._record import records_of


def made(depth: np.ndarray, along: np.ndarray, *, side: float, finer: float = 0.0) -> Curve:
    return Curve(
        depth=depth,
        along=along,
        across=np.column_stack([side * along, np.zeros_like(along)]),
        reached=float(depth[-1]),
        finer=finer,
        round_tip=False,
        status="converged",
        core_seconds=0.0,
    )


RADIUS = 4e-3
DEEP = np.linspace(0.25e-3, 6e-3, 24)
SHORT = DEEP[:12]


def test_deeper_than_the_finer_mesh_the_ratio_at_its_end_holds() -> None:
    """The coarser mesh is 4 % too stiff at all depths, so that the result continues the finer curve."""
    whole = deepened(made(SHORT, 1e-2 * SHORT, side=0.1, finer=3e-3), made(DEEP, 1.04e-2 * DEEP, side=0.1))
    assert whole.at(DEEP) == pytest.approx(1e-2 * DEEP, rel=1e-6)
    assert whole.sides(DEEP)[:, 0] == pytest.approx(1e-3 * DEEP, rel=1e-6)
    assert whole.reached == pytest.approx(6e-3)
    assert whole.finer == pytest.approx(3e-3)


def test_a_change_counts_in_proportion() -> None:
    """10 % more on the coarser mesh is 10 % more on the finer one.

    A lateral force that both curves of the coarser mesh have is no change.
    """
    fine = made(DEEP, 1e-2 * DEEP, side=0.0, finer=6e-3)
    coarse = made(DEEP, 1.04e-2 * DEEP, side=0.02)
    change = made(DEEP, 1.1 * 1.04e-2 * DEEP, side=0.02)
    found = changed(fine, [(change, coarse, COARSE)], RADIUS)
    assert found.at(DEEP) == pytest.approx(1.1e-2 * DEEP, rel=1e-6)
    assert found.sides(DEEP)[:, 0] == pytest.approx(0.1 * 0.02 * 1e-2 * DEEP, rel=1e-6)


def test_a_change_on_the_finer_mesh_is_carried_on_by_the_coarser_one() -> None:
    """10 % more on the finer mesh, 20 % more on the coarser mesh below the end of the finer."""
    fine, coarse = made(SHORT, 1e-2 * SHORT, side=0.0, finer=3e-3), made(DEEP, 1.04e-2 * DEEP, side=0.0)
    pairs = [
        (made(SHORT, 1.1e-2 * SHORT, side=0.0), fine, FINE),
        (made(DEEP, 1.2 * 1.04e-2 * DEEP, side=0.0), coarse, COARSE),
    ]
    found = changed(deepened(fine, coarse), pairs, RADIUS)
    assert found.at(DEEP) == pytest.approx(np.where(SHORT[-1] >= DEEP, 1.1e-2, 1.2e-2) * DEEP, rel=1e-6)
    assert found.reached == pytest.approx(6e-3)


def test_cells_that_come_to_touch_elsewhere_are_no_change() -> None:
    """An oscillation of 1 % per cell of the contact, on a smooth change of up to 20 %."""
    depth = np.linspace(0.125e-3, 4e-3, 32)
    width = np.sqrt(depth / 4e-3)
    truth = 1.0 - 0.2 * width**3
    found = smoothed(width, truth + 0.01 * np.sin(2.0 * np.pi * width / 0.2), 0.08)
    inside = (width > 0.35) & (width < 0.9)
    assert np.abs(found - truth)[inside].max() < 5e-3
    assert np.abs(found - truth)[inside].mean() < 2.5e-3


def test_in_retraction_the_same_fraction_is_lost_at_the_same_fraction_of_the_depth() -> None:
    lost = np.array([[0.1, 0.0], [0.5, 0.04], [1.0, 0.0]])
    curve = replace(made(DEEP, 1e-2 * DEEP, side=0.0), retraction_loss=lost)
    for turn in (2e-3, 5e-3):
        depth = turn * np.array([0.05, 0.5, 0.75, 1.0])
        assert curve.retracting(depth, np.full(4, turn)) / curve.at(depth) == pytest.approx(
            [1.0, 0.96, 0.98, 1.0]
        )


def test_the_common_mesh_error_is_smaller_where_the_finer_mesh_reaches() -> None:
    """The factor common to all forces is the finer mesh's up to its end, the coarser mesh's below."""
    time = np.linspace(0.0, 6.0, 60)
    (record,) = records_of([trial("p", time, 1e-3 * time, time, depth_sd=0.0)])
    force = np.full(record.points, 2.0)
    curve = made(DEEP, 1e-2 * DEEP, side=0.0, finer=3e-3)
    follow = [partial(at_depths, record, 1.0)]
    together = nuisances([record], [curve], [force], [0.0 * force], follow, [0.0])[0][:, 0]
    assert together == pytest.approx(2.0 * TOGETHER / np.where(record.depth <= 3e-3, FINE, COARSE) ** 2)
