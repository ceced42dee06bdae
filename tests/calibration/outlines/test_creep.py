"""Photographs of creeping beams: curves of elastic beams against viscoelastic ones, and required input."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment import Experiment, read
from calibration.experiment.model import BeamTrial
from calibration.measurements._state import State
from calibration.measurements.outlines._creep import compliance
from calibration.measurements.outlines.model import OutlineModel
from calibration.parameters import parametrisation
from calibration.study import measurements, parts
from tisim import Prony

CREEPS = Path(__file__).parents[3] / "datasets" / "measured" / "bench" / "creeps"
NEO = parametrisation("neo-hookean")


def one_beam() -> Experiment:
    """The cantilever of 50 mm of the stiffest material."""
    whole = read(CREEPS)
    return replace(whole, trials=tuple(t for t in whole.trials if t.id == "S0-cantilever-050"))


def model_of(law: str) -> tuple[OutlineModel, NDArray[np.float64]]:
    """A model over time, with the start of its search."""
    experiment = one_beam()
    form = parts.with_parts(parametrisation(law), ("prony:1",), experiment, "S0")
    data = measurements(experiment, "S0", form, workers=1)
    assert data.outlines is not None
    return data.outlines.model, data.law.start(shear=24e3)


def test_curves_follow_a_beam_that_creeps() -> None:
    """Changes by a stiffer material and by slower, larger relaxation agree to 2 % of the largest change.

    The error of the curves, from large rotations, is below 5 % of the creep; it is corrected at the fitted
    state.
    """
    model, u = model_of("neo-hookean")
    assert model._creep is not None
    states = [State(u=v) for v in (u, u + np.array([0.2, 0, 0, 0]), u + np.array([0, 0, 0.2, 0.2]))]
    exact = np.array(model.solutions.values(states))
    quick = np.array(model._creep.values(model.records, states))
    for k in (1, 2):
        change = exact[k] - exact[0]
        assert np.abs(quick[k] - quick[0] - change).max() < 0.02 * np.abs(change).max(), k
    first, *_, last = (p.rows for p in model.records)
    creep = np.abs(exact[0][last] - exact[0][first]).max()
    assert creep > 1e-4
    assert 0.0 < np.abs(quick[0] - exact[0]).max() < 0.05 * creep
    model.update_nuisances(states[0], rough=True)
    np.testing.assert_allclose(model._misfit(states[:1])[0], exact[0], atol=1e-12)


def test_a_law_with_further_constants_is_followed_step_by_step() -> None:
    model, _ = model_of("ogden")
    assert model._creep is None


def test_compliance_of_a_standard_linear_solid() -> None:
    """J(t) = 1 - g/(1 + g) exp(-t/((1 + g) tau)), times the long-time modulus; also as two equal terms."""
    time = np.array([0.0, 0.3, 5.0, 400.0])
    expected = 1.0 - 0.4 / 1.4 * np.exp(-time / (1.4 * 2.0))
    np.testing.assert_allclose(
        compliance(Prony(fractions=(0.4,), times=(2.0,)).spectrum(), time), expected, rtol=1e-12
    )
    twice = Prony(fractions=(0.1, 0.3), times=(2.0, 2.0 + 1e-9)).spectrum()
    np.testing.assert_allclose(compliance(twice, time), expected, rtol=1e-8)


def test_one_time_shows_one_modulus() -> None:
    experiment = one_beam()
    trials = [replace(t, captures=t.captures[:1]) for t in experiment.trials if isinstance(t, BeamTrial)]
    with pytest.raises(InputError, match=r"S0-cantilever-050: --time prony:1: .* at two times or more"):
        parts.check(replace(experiment, trials=tuple(trials)), ["S0"], ("prony:1",))
    with pytest.raises(InputError, match=r"--damage: expected no outlines, since a beam that hangs still"):
        parts.check(experiment, ["S0"], ("mullins",))


def test_bulk_modulus_is_held_unless_it_is_asked_for() -> None:
    held, free = (
        measurements(one_beam(), "S0", NEO, workers=1, free_bulk_ratio=f).law for f in (False, True)
    )
    assert [c.held for c in held.coordinates] == [False, True]
    assert not any(c.held for c in free.coordinates)
    assert held.believed().prior()[1][1] == free.prior()[1][1]
