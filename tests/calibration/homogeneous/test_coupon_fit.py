"""Fits recover the true parameters within their intervals, and report what the data do not determine."""

from __future__ import annotations

from dataclasses import replace

import coupon_cases as made
import numpy as np
import pytest

from calibration.measurements.homogeneous import percent_error
from calibration.parameters import parametrisation
from studies.coupons.fit import FitStatus, fit_coupons

S = np.linspace(1.02, 3.0, 25)
# the true laws are incompressible: K/G at its upper bound
STIFF = {"bulk_ratio": 5000.0}
TRUTHS = {
    "neo-hookean": (lambda m, s: made.mooney(1.5e4, 0.0, m, s), {"shear_modulus": 3e4}),
    "mooney-rivlin": (
        lambda m, s: made.mooney(1.2e4, 3e3, m, s),
        {"shear_modulus": 3e4, "second_share": 0.2},
    ),
    "arruda-boyce": (lambda m, s: made.arruda_boyce(2e4, 3.5, m, s), {"locking": 3.5}),
    "ogden": (lambda m, s: made.ogden((1.5e4,), (3.0,), m, s), {"shear_modulus": 2.25e4, "alpha": 3.0}),
}


@pytest.mark.parametrize("law", TRUTHS)
def test_intervals_hold_the_truth(law: str) -> None:
    """95 % intervals for 12 noise draws: at least 80 % contain the truth."""
    closed, truth = TRUTHS[law]
    inside, widths = [], []
    for seed in range(12):
        trials = [
            made.coupon(m, S, closed, stress_sd=400.0, seed=100 * seed + k)
            for k, m in enumerate(("uniaxial", "equibiaxial", "planar"))
        ]
        fit = fit_coupons(parametrisation(law), trials, starts=1, held=STIFF)
        assert fit.status is FitStatus.CONVERGED
        assert fit.identification is not None
        for e in fit.identification.estimates:
            if e.name in truth:
                inside.append(e.low <= truth[e.name] <= e.high)
                widths.append((e.high - e.low) / truth[e.name])
    assert np.mean(inside) >= 0.8
    assert np.max(widths) < 0.2  # intervals are narrow, too


def test_two_ogden_terms_are_found_again() -> None:
    mu, alpha = (1.6e4, -2e3), (2.0, -3.0)
    trials = [
        made.coupon(m, S, lambda m, s: made.ogden(mu, alpha, m, s), relative=0.003, seed=k)
        for k, m in enumerate(("uniaxial", "equibiaxial", "planar"))
    ]
    fit = fit_coupons(parametrisation("ogden", terms=2), trials, starts=3, evolution=600, held=STIFF)
    assert fit.identification is not None
    found = {e.name: e for e in fit.identification.estimates}
    order = sorted((1, 2), key=lambda p: -found[f"shear_modulus_{p}"].value)
    for p, G, a in zip(order, (1.6e4, 3e3), alpha, strict=True):
        assert found[f"shear_modulus_{p}"].low < G < found[f"shear_modulus_{p}"].high
        assert found[f"alpha_{p}"].low < a < found[f"alpha_{p}"].high
        assert found[f"alpha_{p}"].sd < 0.5
    assert fit.reached >= 2
    assert all(percent_error(t, fit.material()) < 1.0 for t in trials)


def test_what_the_data_do_not_decide_is_flagged() -> None:
    closed, _ = TRUTHS["mooney-rivlin"]
    trials = [made.coupon("planar", S, closed, stress_sd=400.0)]
    fit = fit_coupons(parametrisation("mooney-rivlin"), trials, starts=1)
    # planar tension depends on C10 + C01 only, and never on K/G
    assert fit.undecided["bulk_ratio"] == "held"
    assert fit.undecided["second_share"] in ("not identified", "at a bound")
    assert "shear_modulus" not in fit.undecided
    free = fit_coupons(parametrisation("neo-hookean"), trials, starts=1, held={})
    assert free.undecided == {"bulk_ratio": "not identified"}


def test_a_neo_hookean_curve_leaves_the_locking_stretch_to_its_bound() -> None:
    trials = [made.coupon("uniaxial", np.linspace(0.9, 1.2, 20), TRUTHS["neo-hookean"][0], stress_sd=200.0)]
    fit = fit_coupons(parametrisation("arruda-boyce"), trials, starts=1)
    assert "locking" in fit.undecided


def test_the_same_seed_gives_the_same_fit() -> None:
    trials = [made.coupon(m, S, TRUTHS["ogden"][0], relative=0.01) for m in ("uniaxial", "planar")]
    law = parametrisation("ogden")
    first, second = (fit_coupons(law, trials, starts=1, evolution=60, seed=3) for _ in range(2))
    np.testing.assert_array_equal(first.u, second.u)
    assert first.evaluations == second.evaluations


def test_a_law_without_an_answer_is_a_status() -> None:
    trials = [made.coupon("equibiaxial", S, TRUTHS["neo-hookean"][0], stress_sd=400.0)]
    fit = fit_coupons(parametrisation("st-venant-kirchhoff"), trials, starts=3)
    assert fit.status is FitStatus.NO_ANSWER
    assert (fit.unanswered, fit.starts, fit.reached) == (3, 3, 0)
    assert np.isnan(fit.u).all()
    with pytest.raises(ValueError, match="st-venant-kirchhoff: no answer"):
        fit.material()


def test_bad_calls_are_one_sentence() -> None:
    trials = [made.coupon("planar", S, TRUTHS["neo-hookean"][0], stress_sd=400.0)]
    with pytest.raises(ValueError, match="at least one coupon"):
        fit_coupons(parametrisation("neo-hookean"), [])
    with pytest.raises(ValueError, match="neo-hookean: has no coordinate locking"):
        fit_coupons(parametrisation("neo-hookean"), trials, held={"locking": 3.0})
    with pytest.raises(ValueError, match="coupons of one material, got made, other"):
        fit_coupons(parametrisation("neo-hookean"), [trials[0], replace(trials[0], material="other")])


def test_where_the_law_is_wrong_the_intervals_widen() -> None:
    """A stiffening curve fitted by the neo-Hookean law: the misfit, not the small noise, sets the width."""
    trials = [made.coupon("uniaxial", S, TRUTHS["ogden"][0], stress_sd=10.0)]
    fit = fit_coupons(parametrisation("neo-hookean"), trials, starts=1, held=STIFF)
    assert fit.identification is not None
    assert fit.identification.scale == pytest.approx(fit.chi2 / (fit.points - 1))
    (shear,) = (e for e in fit.identification.estimates if e.name == "shear_modulus")
    assert shear.high / shear.low > 1.05
