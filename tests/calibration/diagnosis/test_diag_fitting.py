"""Fits of baseline and amplitudes to a formula with a known minimum."""

from __future__ import annotations

import numpy as np
import pytest
from fake_model import FakeModel, effect, library, noise

from calibration.diagnosis.engine.fitting import TOLERANCE, fit
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State

BEND, SLOPE = Candidate(effect="bend"), Candidate(effect="slope")


def start(model: FakeModel) -> State:
    return State(u=model.start())


def test_moduli_and_amplitudes_are_those_of_least_squares() -> None:
    model = FakeModel(hidden=6.0 * library()["bend"], drawn=noise(1))
    found = fit(model, start(model), (BEND, SLOPE))
    whole = np.column_stack([model.by_u, library()["bend"], library()["slope"]])
    best = np.linalg.lstsq(whole, model.data, rcond=None)[0]
    assert found.converged
    assert found.state.u == pytest.approx(best[:2], abs=1e-8)
    assert [found.state.amplitudes[c] for c in (BEND, SLOPE)] == pytest.approx(best[2:], abs=1e-8)
    assert found.chi2 == pytest.approx(np.sum((whole @ best - model.data) ** 2), rel=1e-10)
    sd = np.sqrt(np.diag(np.linalg.inv(whole.T @ whole)))
    assert found.covariance() == pytest.approx(np.linalg.inv(whole.T @ whole), rel=1e-6)
    assert found.amplitude(SLOPE) == pytest.approx((best[3], sd[3]), rel=1e-6)


def test_a_curved_response_is_followed_to_its_minimum() -> None:
    model = FakeModel(hidden=0.0, bent=0.02)
    model.data = model.predicted(State(u=np.array([0.8, -0.4]), amplitudes={BEND: 5.0}))
    found = fit(model, start(model), (BEND,))
    assert found.converged
    assert found.chi2 < TOLERANCE
    assert found.state.amplitudes[BEND] == pytest.approx(5.0, abs=0.3)
    assert found.state.u == pytest.approx([0.8, -0.4], abs=0.02)


def test_a_fit_starts_from_the_amplitudes_that_are_known() -> None:
    model = FakeModel(hidden=6.0 * library()["bend"])
    begun = State(u=model.truth, amplitudes={BEND: 6.0, SLOPE: 3.0})
    found = fit(model, begun, (BEND,))  # the slope is not a candidate: it is removed
    assert set(found.state.amplitudes) == {BEND}
    assert found.state.amplitudes[BEND] == pytest.approx(6.0)
    assert model.solves == 0  # the start is the minimum


@pytest.mark.parametrize(("bounds", "hidden", "ends"), [((0.0, 4.0), 9.0, 4.0), ((0.0, 4.0), -5.0, 0.0)])
def test_an_amplitude_stays_within_its_bounds_and_the_rest_is_fitted_beside_it(
    bounds: tuple[float, float], hidden: float, ends: float
) -> None:
    model = FakeModel(effects={"bend": effect("bend", bounds=bounds)}, hidden=hidden * library()["bend"])
    found = fit(model, start(model), (BEND, SLOPE))
    held = np.column_stack([model.by_u, library()["slope"]])
    best = np.linalg.lstsq(held, model.data - ends * library()["bend"], rcond=None)[0]
    assert found.converged
    assert found.state.amplitudes[BEND] == ends
    assert found.state.amplitudes[SLOPE] == pytest.approx(best[2], abs=0.05)


def test_a_start_out_of_bounds_is_brought_inside() -> None:
    model = FakeModel(effects={"bend": effect("bend", bounds=(0.0, 4.0))}, hidden=3.0 * library()["bend"])
    found = fit(model, State(u=model.truth, amplitudes={BEND: 50.0}), (BEND,))
    assert found.converged
    assert found.state.amplitudes[BEND] == pytest.approx(3.0, abs=1e-6)


def test_where_the_derivatives_lie_the_fit_says_so() -> None:
    class Lying(FakeModel):
        def linearise(self, state, candidates):  # type: ignore[no-untyped-def]
            true = super().linearise(state, candidates)
            return type(true)(
                state=true.state,
                z=true.z,
                by_u=-true.by_u,
                columns=-true.columns,
                candidates=true.candidates,
            )

    model = Lying()
    found = fit(model, start(model))
    assert not found.converged
    assert found.message.startswith("no step lowers chi-square")
    assert found.state.u == pytest.approx(model.start())


def test_too_few_steps_are_said() -> None:
    """Steps that lower chi-square by more than 0.1 count a fifth, since the fit is still converging."""
    model = FakeModel(truth=np.array([9.0, -9.0]))  # a step of u is at most 0.7
    found = fit(model, start(model), max_steps=2)
    assert not found.converged
    assert found.message == "not converged in 10 steps"
    assert np.abs(found.state.u).max() == pytest.approx(7.0)
    assert fit(model, start(model), max_steps=40).converged


def test_states_without_an_answer_are_stepped_around() -> None:
    model = FakeModel(truth=np.array([1.0, -0.5]), no_answer=lambda s: s.u[0] > 0.5)
    found = fit(model, start(model), max_steps=30)
    assert found.state.u[0] <= 0.5
    assert found.state.u[0] > 0.45  # as near as possible
    assert np.isfinite(found.chi2)
    assert not found.converged


def test_a_start_without_an_answer_is_an_error() -> None:
    model = FakeModel(no_answer=lambda _: True)
    with pytest.raises(ValueError, match="no answer"):
        fit(model, start(model))


def test_an_amplitude_that_does_nothing_stays_where_it_is() -> None:
    shapes = library() | {"nothing": np.zeros(72)}
    model = FakeModel(shapes=shapes, drawn=noise(2))
    nothing = Candidate(effect="nothing")
    found = fit(model, State(u=model.start(), amplitudes={nothing: 2.0}), (nothing,))
    assert found.converged
    assert found.state.amplitudes[nothing] == 2.0
    assert np.isfinite(found.covariance()).all()


def test_columns_of_very_different_scale_are_fitted_together() -> None:
    shapes = library()
    shapes["bend"] = 1e-9 * shapes["bend"]
    effects = {"bend": effect("bend", bounds=(-1e12, 1e12))}
    model = FakeModel(shapes=shapes, effects=effects, hidden=6e9 * shapes["bend"])
    found = fit(model, start(model), (BEND,))
    assert found.converged
    assert found.state.amplitudes[BEND] == pytest.approx(6e9, rel=1e-6)
    whole = np.column_stack([model.by_u, 1e9 * shapes["bend"]])
    sd = 1e9 * np.sqrt(np.linalg.inv(whole.T @ whole)[2, 2])
    assert found.amplitude(BEND)[1] == pytest.approx(sd, rel=1e-3)


def test_labels() -> None:
    model = FakeModel()
    assert fit(model, start(model)).label == "baseline"
    assert fit(model, start(model), (BEND, SLOPE)).label == "bend + slope"
    assert Candidate(effect="void", at="S0-50", position=0.3).label == "void of S0-50 at 30%"
