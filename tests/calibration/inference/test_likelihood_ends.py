"""Likelihood intervals, on problems with a closed-form solution."""

from __future__ import annotations

import numpy as np
import pytest
from toy_problems import Curve, mooney_problem, of_curve

from calibration.inference import Estimate, Polished, Problem, identify, polish, profile
from calibration.parameters import parametrisation
from tisim import Material, laws

SLOPE = 12.0  # derivative of the reading by the inverse square of the locking stretch
# readings are these combinations of the three unknowns, with unit noise; PRIOR is the sd of the last unknown
READINGS = np.repeat([[1.0, 0.0, 0.0], [1.0, 1.2, 0.3], [0.0, 1.2, 0.3]], 10, axis=0)
PRIOR = 1.1
P = parametrisation("arruda-boyce")


def unknowns(m: Material) -> np.ndarray:
    """100 log G, SLOPE / locking^2 and log(K / G)."""
    moduli = laws.get("arruda-boyce").moduli(m.parameters)
    locking = float(m.parameters["locking"])  # type: ignore[arg-type]
    return np.array(
        [
            100.0 * np.log(moduli.shear_modulus),
            SLOPE / locking**2,
            np.log(moduli.bulk_modulus / moduli.shear_modulus),
        ]
    )


def read(m: Material) -> np.ndarray:
    return READINGS @ unknowns(m)


def problem(locking: float, **options: object) -> tuple[Problem, np.ndarray]:
    truth = np.log([2e4, 300.0, locking])
    y = read(P.material(truth)) + np.random.default_rng(0).normal(0.0, 0.5, len(READINGS))
    return of_curve(P, Curve(read, y, **options)), truth  # type: ignore[arg-type]


def fitted(
    locking: float, *, reduced_chi2: float = 1.0, **options: object
) -> tuple[Problem, Polished, dict[str, Estimate], dict[str, Estimate]]:
    """The problem, its optimum, and its estimates by linear theory and by the likelihood."""
    made, truth = problem(locking, **options)
    end = polish(made, truth, tolerance=1e-8)
    known = identify(P, end.u, end.jacobian, reduced_chi2=reduced_chi2)
    return (
        made,
        end,
        {e.name: e for e in known.estimates},
        {e.name: e for e in profile(made, end, known)},
    )


def sd(scale: float = 1.0) -> float:
    """Standard deviation of SLOPE / locking^2, with only the prior on the other unknowns."""
    information = READINGS.T @ READINGS / scale + np.diag([0.0, 0.0, PRIOR**-2.0])
    return float(np.linalg.inv(information)[1, 1] ** 0.5)


def rise(end: float, best: float, scale: float = 1.0) -> float:
    """Square root of the increase in chi-square from the best locking stretch to another."""
    return abs(SLOPE / end**2 - SLOPE / best**2) / sd(scale)


@pytest.mark.parametrize("scale", [1.0, 3.0])
@pytest.mark.parametrize("locking", [4.0, 5.0, 6.0])
def test_ends_are_where_chi_square_has_risen(locking: float, scale: float) -> None:
    """The reduced chi-square of a misfit reduces the weight of the data."""
    _, _, linear, every = fitted(locking, reduced_chi2=scale)
    found = every["locking"]
    assert rise(found.low, found.value, scale) == pytest.approx(1.96, abs=0.1)
    at_the_end = rise(20.0, found.value, scale)
    if at_the_end < 1.96:
        assert found.high == pytest.approx(20.0) or at_the_end > 1.8
    else:
        assert rise(found.high, found.value, scale) == pytest.approx(1.96, abs=0.1)
    assert (found.value, found.sd) == (linear["locking"].value, linear["locking"].sd)


def test_linear_theory_would_miss_them() -> None:
    _, _, linear, _ = fitted(4.0)
    assert rise(linear["locking"].low, linear["locking"].value) > 2.4
    assert rise(linear["locking"].high, linear["locking"].value) < 1.6


def test_bars_are_those_of_the_data_alone_and_no_wider_than_the_bounds_tell() -> None:
    """Wide standard deviations are limited to that of the bounds."""
    _, end, linear, _ = fitted(4.5)
    best = float(np.exp(end.u[2]))
    assert linear["locking"].sd == pytest.approx(best**2 / (2.0 * SLOPE) * sd(), rel=0.03)
    _, _, linear, _ = fitted(20.0, reduced_chi2=50.0)
    assert linear["locking"].sd == pytest.approx(np.log(20.0 / 1.2) / np.sqrt(12.0))


def test_what_a_prior_decides_is_left_alone() -> None:
    _, _, linear, found = fitted(3.0)
    assert found["bulk_ratio"] == linear["bulk_ratio"]


def test_nothing_is_solved_where_all_is_identified() -> None:
    def sharp(m: Material) -> np.ndarray:
        return 1e3 * unknowns(m)[:2]

    curve = Curve(sharp, sharp(P.material(np.log([2e4, 300.0, 2.0]))))
    made = of_curve(P, curve)
    end = polish(made, np.log([2e4, 300.0, 2.0]))
    known = identify(P, end.u, end.jacobian, reduced_chi2=1.0)
    solved = len(curve.batches)
    assert profile(made, end, known) == known.estimates
    assert len(curve.batches) == solved


def test_an_end_without_answer_stops_short_of_it() -> None:
    """If the law has no equilibrium beyond a stretch, the interval ends there."""
    fails = lambda m: m.parameters["locking"] > 4.5  # noqa: E731
    _, _, _, found = fitted(4.0, fails=fails)
    assert 4.5 <= found["locking"].high <= 5.0
    assert rise(found["locking"].low, found["locking"].value) == pytest.approx(1.96, abs=0.1)


def test_a_best_point_at_its_bound_has_one_end() -> None:
    beyond = Material(law="mooney-rivlin", parameters={"c10": -2e3, "c01": 14e3, "bulk": 1e6})
    s = np.linspace(1.05, 2.5, 30)
    y = 2.0 * (s - s**-2) * (-2e3 + 14e3 / s) / 1e3
    made = mooney_problem(y)
    p = made.parametrisation
    assert beyond.parameters["c10"] < 0.0  # type: ignore[operator]
    end = polish(made, p.start(shear=2e4))
    known = identify(p, end.u, end.jacobian, reduced_chi2=1.0)
    share = {e.name: e for e in profile(made, end, known)}["second_share"]
    assert share.high == pytest.approx(1.0)
    assert share.low < share.value


def test_an_end_that_nothing_leads_to_stays_that_of_linear_theory() -> None:
    _, end, _, _ = fitted(4.0)
    most = 1.0003 * float(np.exp(end.u[2]))
    _, _, linear, found = fitted(4.0, fails=lambda m: m.parameters["locking"] > most)
    assert found["locking"].high == pytest.approx(linear["locking"].high)
    assert found["locking"].high > 1.1 * most
