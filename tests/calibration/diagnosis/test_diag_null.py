"""Null distributions: p-values are uniform on noise and small on structure; the tail follows exact theory."""

from __future__ import annotations

import numpy as np
import pytest
from fake_model import FakeModel, library, noise, waves
from scipy.stats import chi2, kstest

from calibration.diagnosis.engine.null import DRAWS, EVERYTHING, MaxImprovement, Null
from calibration.diagnosis.engine.screening import Screen, screen
from calibration.measurements._baseline import LARGEST, SCATTER, SPECIMENS, scatter_basis
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State

ROWS = 72


@pytest.fixture(scope="module")
def null() -> Null:
    return Null(ROWS, {"waves": waves(7), "edges": np.eye(ROWS)[:, ::12]}, seed=3)


@pytest.fixture(scope="module")
def jacobian() -> np.ndarray:
    return FakeModel().by_u


def fitted(z: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    return np.asarray(z - jacobian @ np.linalg.lstsq(jacobian, z, rcond=None)[0])


def test_p_of_noise_is_uniform(null: Null, jacobian: np.ndarray) -> None:
    p = [null.lack_of_fit(fitted(noise(k), jacobian), jacobian).p_value for k in range(60)]
    assert kstest(p, "uniform").pvalue > 0.01
    assert min(p) > 1e-3


def test_each_test_alone_is_that_of_the_chi_square(null: Null, jacobian: np.ndarray) -> None:
    z = 1.1 * fitted(noise(200), jacobian)
    found = null.lack_of_fit(z, jacobian)
    assert set(found.each) == {EVERYTHING, "waves", "edges"}
    exact = float(chi2.sf(z @ z, ROWS - 2))
    assert found.each[EVERYTHING] == pytest.approx(exact, abs=4.0 * np.sqrt(exact / DRAWS))
    free = np.linalg.qr(jacobian)[0]
    span = np.linalg.qr(waves(7) - free @ (free.T @ waves(7)))[0]
    exact = float(chi2.sf(np.sum((span.T @ z) ** 2), 7))
    assert found.each["waves"] == pytest.approx(exact, abs=4.0 * np.sqrt(exact / DRAWS))
    # the combined p-value exceeds the smallest of the tests, and at most by the number of tests
    smallest = min(found.each.values())
    assert 0.9 * smallest <= found.p_value <= 3.3 * smallest


def test_specimens_may_differ_by_a_bad_lab_s_scatter(jacobian: np.ndarray) -> None:
    """Scatter of the size LARGEST, instead of SCATTER, counts as noise; more is detected."""
    null = Null(ROWS, scatter_basis(ROWS, ROWS - 6, 6), seed=4)
    spread = np.zeros(ROWS)
    spread[-6:] = np.sqrt(chi2.ppf(0.5, 6) / 6) * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    p = [null.lack_of_fit(part * spread, jacobian).each[SPECIMENS] for part in (LARGEST / SCATTER, 3.0)]
    assert p[0] == pytest.approx(0.5, abs=0.05)
    assert p[1] < 1e-3
    assert scatter_basis(ROWS, ROWS, 0) == {}


def test_a_pattern_is_seen_where_the_whole_sum_sees_nothing(null: Null, jacobian: np.ndarray) -> None:
    hidden = waves(7)[:, 3] / np.linalg.norm(waves(7)[:, 3])
    p, whole = [], []
    for k in range(10):
        found = null.lack_of_fit(fitted(noise(300 + k) + 7.0 * hidden, jacobian), jacobian)
        p.append(found.p_value)
        whole.append(found.each[EVERYTHING])
    assert max(p) < 0.01
    assert np.median(whole) > np.median(p)


def test_the_strongest_test_is_named(null: Null, jacobian: np.ndarray) -> None:
    edge = fitted(9.0 * np.eye(ROWS)[:, 24], jacobian)
    assert null.lack_of_fit(edge, jacobian).worst == "edges"
    bend = fitted(1.2 * waves(7)[:, 4], jacobian)
    assert null.lack_of_fit(bend, jacobian).worst == "waves"


def test_what_the_fit_could_do_is_not_counted(null: Null, jacobian: np.ndarray) -> None:
    # with many more coordinates the residuals are smaller, and p is unchanged
    many = np.column_stack([jacobian, np.random.default_rng(5).standard_normal((ROWS, 40))])
    z = fitted(noise(400), many)
    assert z @ z < 55.0
    assert null.lack_of_fit(z, many).p_value > 0.05
    assert null.lack_of_fit(z, jacobian).p_value > 0.99  # taken for a fit of two coordinates: too good


def test_p_is_never_zero(null: Null, jacobian: np.ndarray) -> None:
    found = null.lack_of_fit(fitted(100.0 * noise(1), jacobian), jacobian)
    assert 0.0 < found.p_value <= 2.0 / DRAWS


def test_what_is_beyond_all_draws_costs_none(jacobian: np.ndarray) -> None:
    """Beyond all draws the number of tests bounds p; closer to noise the draws determine it."""
    null = Null(ROWS, {"waves": waves(7), "edges": np.eye(ROWS)[:, ::12]}, seed=3)
    plain = null.lack_of_fit(fitted(noise(1), jacobian), jacobian)
    null.noise[:] = np.nan
    far = null.lack_of_fit(fitted(3.0 * noise(1), jacobian), jacobian)
    assert 1.0 / (DRAWS + 1) <= far.p_value < 0.001 < plain.p_value
    assert set(far.each) == set(plain.each)
    assert min(far.each.values()) == 1.0 / (DRAWS + 1)  # the smallest p that draws can give
    with np.errstate(invalid="ignore"):
        assert null.lack_of_fit(fitted(noise(1), jacobian), jacobian).p_value != plain.p_value


def test_without_patterns_the_whole_sum_is_the_test(jacobian: np.ndarray) -> None:
    alone = Null(ROWS, {}, seed=0).lack_of_fit(fitted(noise(2), jacobian), jacobian)
    assert set(alone.each) == {EVERYTHING}
    assert alone.worst == EVERYTHING
    assert alone.p_value == pytest.approx(alone.each[EVERYTHING], abs=2.0 / DRAWS)


def test_draws_differ_by_seed_and_only_by_it() -> None:
    assert (Null(5, {}, seed=1).noise == Null(5, {}, seed=1).noise).all()
    assert (Null(5, {}, seed=1).noise != Null(5, {}, seed=2).noise).any()


def independent(count: int) -> Screen:
    return Screen(
        candidates=tuple(Candidate(effect=f"e{k}") for k in range(count)),
        directions=np.eye(ROWS)[:, :count],
        sizes=np.ones(count),
        upwards=np.zeros(count, dtype=bool),
        free=np.zeros((ROWS, 0)),
    )


def test_the_best_of_independent_candidates_is_that_of_theory(null: Null) -> None:
    gains = null.max_improvement(independent(8))
    for gain in (2.0, 4.0, 7.0, 10.0, 15.0, 25.0, 40.0):
        exact = -np.expm1(8.0 * np.log1p(-chi2.sf(gain, 1)))
        # the height of the tail has the error of the draws' 1 % quantile
        error = np.sqrt((1.0 - exact) / (max(exact, 0.01) * DRAWS))
        assert gains.p_value(gain) == pytest.approx(exact, rel=4.0 * error), gain


def test_alike_candidates_count_once(null: Null) -> None:
    alike = independent(8)
    same = Screen(
        candidates=alike.candidates,
        directions=np.repeat(alike.directions[:, :1], 8, axis=1),
        sizes=alike.sizes,
        upwards=alike.upwards,
        free=alike.free,
    )
    once = null.max_improvement(independent(1))
    for gain in (1.0, 5.0, 12.0, 30.0):
        assert null.max_improvement(same).p_value(gain) == once.p_value(gain)


def test_chance_is_counted_among_the_draws(null: Null) -> None:
    model = FakeModel(scoped=tuple(library()))
    screened = screen(model.linearise(State(u=model.truth), model.candidates), model.effects)
    best = np.array([screened.penalised(row).max() for row in null.noise])
    gains = null.max_improvement(screened)
    for gain in (1.0, 5.0, 9.0):
        assert gains.p_value(gain) == pytest.approx((np.sum(best >= gain) + 1) / (DRAWS + 1))
    assert np.mean(best > gains.threshold(0.05)) == pytest.approx(0.05, abs=1e-3)


def test_chance_falls_on_and_on(null: Null) -> None:
    gains = null.max_improvement(independent(20))
    gain = np.linspace(0.0, 80.0, 801)
    found = np.array([gains.p_value(g) for g in gain])
    assert (np.diff(found) <= 0.0).all()
    assert (np.diff(found[gain > gains.drawn[-1]]) < 0.0).all()  # beyond the largest draw
    assert 0.0 < found[-1] < 1e-12
    assert found[0] == 1.0


def test_no_candidates_gain_nothing(null: Null) -> None:
    none = null.max_improvement(independent(0))
    assert none.p_value(0.0) == 1.0
    assert isinstance(none, MaxImprovement)
