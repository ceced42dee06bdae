"""The laboratory's creeping beams against the correspondence principle, statics, and finite differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.blind.beams.model import Beam, Resolution, mesh
from benchmarks.blind.beams.solver import Shape, solve
from benchmarks.blind.timed.beams import _with_history, hang, isochoric
from benchmarks.blind.timed.convolution import Memory
from benchmarks.blind.timed.material import Prony

Array = NDArray[np.float64]
PRONY = Prony(fractions=(0.3, 0.2), times=(0.5, 20.0))
TIMES = (0.0, 0.2, 1.0, 10.0, 100.0, 1000.0)
STIFF = Beam(length=0.03, bridge=False, mu=300e3)  # its tip deflection is 55 micrometres
SOFT = Beam(length=0.05, bridge=False, mu=20e3)
COARSE = Resolution(first=0.004, longest=0.01)


def sinking(shapes: list[Shape]) -> Array:
    """Vertical displacement of the tip [m], positive upwards."""
    return np.array([s.edges(np.array([1.0]))[:, 0, 1].mean() for s in shapes])


def test_a_stiff_cantilever_creeps_by_the_creep_function() -> None:
    tip = sinking(hang(STIFF, PRONY, TIMES, resolution=COARSE))
    assert tip / tip[-1] == pytest.approx(PRONY.compliance(np.array(TIMES)), rel=4e-4)


def test_a_soft_cantilever_goes_from_its_instantaneous_to_its_long_time_equilibrium() -> None:
    tip = sinking(hang(SOFT, PRONY, (0.0, 2.0, 2000.0), resolution=COARSE))
    at_once = replace(SOFT, mu=1.5 * SOFT.mu, bulk_ratio=SOFT.bulk_ratio / 1.5)
    statics = sinking([solve(b, resolution=COARSE) for b in (at_once, SOFT)])
    assert tip[[0, 2]] == pytest.approx(statics, abs=2e-8)
    assert -tip[0] < -tip[1] < -tip[2]
    assert -tip[2] > 0.005


def test_the_time_steps_of_a_creeping_beam_are_fine_enough() -> None:
    default, fine = (
        sinking(hang(SOFT, PRONY, (0.3, 3.0), resolution=COARSE, **finer)) for finer in ({}, {"growth": 0.05})
    )
    assert default == pytest.approx(fine, rel=1e-4)


def test_convolution_is_of_second_order_in_the_time_step() -> None:
    """For S = sin t, against the closed-form memory integral, with equal steps."""

    def error(steps: int) -> float:
        memory, total = Memory(PRONY, (1,)), 0.0
        times = np.linspace(0.0, 4.0, steps + 1)
        for dt, stress in zip(np.diff(times), np.sin(times[1:]), strict=True):
            scale, history = memory.begin(float(dt))
            total = float((scale * stress + history)[0])
            memory.accept(np.array([stress]))
        g, tau, t = np.array(PRONY.fractions), np.array(PRONY.times), 4.0
        q = g * tau * (np.cos(t) + tau * np.sin(t) - np.exp(-t / tau)) / (1 + tau**2)
        return abs(total - np.sin(t) - float(q.sum()))

    assert error(40) / error(80) == pytest.approx(4.0, rel=0.05)


def test_the_tangent_of_the_history_is_its_forces_slope() -> None:
    model = mesh(STIFF, COARSE)
    rng = np.random.default_rng(2)
    x = model.rest + 3e-4 * rng.standard_normal(model.rest.shape)
    here = x.reshape(-1, 3)[model.element]
    history = isochoric(model.bricks, here, model.mu, 0.0)
    way = rng.standard_normal(here.shape)
    h = 1e-7
    ahead, back = (_with_history(model.bricks, here + s * h * way, history)[0] for s in (1, -1))
    _, matrix = _with_history(model.bricks, here, history)
    slope = np.einsum("eaibk,ebk->eai", matrix, way)
    assert (ahead - back) / (2 * h) == pytest.approx(slope, abs=1e-6 * np.abs(slope).max())


def test_the_isochoric_stress_is_the_energys_slope() -> None:
    model = mesh(STIFF, COARSE)
    rng = np.random.default_rng(3)
    here = (model.rest + 3e-4 * rng.standard_normal(model.rest.shape)).reshape(-1, 3)[model.element]
    way = rng.standard_normal(here.shape)

    def energy(x: Array) -> float:
        F = np.matmul(model.bricks.gradient, x[:, None])
        bar = np.linalg.det(F) ** (-2 / 3) * np.einsum("eqij,eqij->eq", F, F) - 3
        return float((model.bricks.weight * model.mu / 2 * (bar + 0.7 * bar**2)).sum())

    force, _ = _with_history(model.bricks, here, isochoric(model.bricks, here, model.mu, 0.7))
    h = 1e-7
    slope = (energy(here + h * way) - energy(here - h * way)) / (2 * h)
    assert slope == pytest.approx(float((force * way).sum()), rel=1e-6)


def test_convolution_is_exact_for_a_ramp_and_a_jump() -> None:
    memory = Memory(PRONY, (1,))
    total = []
    now, stress = 0.0, 2.0
    for time in (0.0, 0.3, 1.7, 9.0):  # a jump to 2, then a rate of 5
        scale, history = memory.begin(time - now)
        now, stress = time, 2.0 + 5.0 * time
        total.append(float((scale * stress + history)[0]))
        memory.accept(np.array([stress]))
    t = np.array([0.0, 0.3, 1.7, 9.0])[:, None]
    g, tau = np.array(PRONY.fractions), np.array(PRONY.times)
    q = g * (2.0 * np.exp(-t / tau) + 5.0 * tau * (1.0 - np.exp(-t / tau)))
    assert total == pytest.approx(2.0 + 5.0 * t[:, 0] + q.sum(axis=1), rel=1e-13)


def test_clamps_that_yield_are_refused() -> None:
    with pytest.raises(ValueError, match="clamps that hold"):
        hang(replace(STIFF, compliance=1e-3), PRONY, (1.0,))
