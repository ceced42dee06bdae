"""Compression tests: curves between simulations, identification of platens, repeats, refusals, Ecoflex."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

import tisim
from calibration.errors import InputError
from calibration.experiment import CouponTrial, read
from calibration.measurements.compression import Cylinder, PressCurves, press_curves
from studies.compression.fit import Repeats, fit_press, repeats, sampled

CYLINDER = Cylinder(radius=0.025, height=0.030)
COARSE = 0.5
NOISE = Repeats(relative_sd=0.01, tests=5, strains=(0.05, 0.5))
ROOT = Path(__file__).resolve().parents[3]
MEASURED = Path(os.environ.get("TISIM_MEASURED", ROOT.parent / "shared" / "measured"))
ECOFLEX = MEASURED / "real" / "silicone-compression" / "experiment"


@lru_cache
def bonded() -> PressCurves:
    return press_curves("neo-hookean", "bonded", CYLINDER, refinement=COARSE)


def trial(stretch: np.ndarray, stress: np.ndarray, name: str = "made", mode: str = "uniaxial") -> CouponTrial:
    return CouponTrial(id=name, material="M", mode=mode, stretch=stretch, stress=stress)  # type: ignore[arg-type]


def mooney(stretch: np.ndarray, c10: float, c01: float) -> np.ndarray:
    """Nominal stress of an incompressible Mooney-Rivlin body between frictionless platens, in closed form."""
    return 2.0 * (stretch - stretch**-2) * (c10 + c01 / stretch)


def made_bonded(shear: float, ratio: float, slack: float) -> CouponTrial:
    stretches = np.linspace(0.99, 0.38, 25)
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=shear, bulk_modulus=ratio * shear)
    scene = tisim.Press(
        material=material, radius=0.025, height=0.030, stretches=tuple(stretches), refinement=COARSE
    )
    (run,) = tisim.simulate([scene], workers=1)
    assert run.ok
    return trial(np.append(1.0, stretches - slack), np.append(0.0, run.nominal_stress))


def test_curves_between_the_nodes_are_what_a_run_gives() -> None:
    values = {"shear_modulus": 23e3, "bulk_ratio": 90.0}
    stretches = (0.93, 0.78, 0.57)  # beyond, so coarse a mesh rolls onto the platen in jumps
    scene = tisim.Press(
        material=bonded().material(values), radius=0.025, height=0.030, stretches=stretches, refinement=COARSE
    )
    (run,) = tisim.simulate([scene], workers=1)
    np.testing.assert_allclose(bonded().stress(stretches, values), run.nominal_stress, rtol=5e-3)


@pytest.mark.parametrize(
    ("law", "name", "value"), [("mooney-rivlin", "second_share", 0.33), ("ogden", "alpha", 2.7)]
)
def test_curves_with_a_shape_constant_are_the_coupons(law: str, name: str, value: float) -> None:
    curves = press_curves(law, "free", CYLINDER)
    values = {"shear_modulus": 23e3, "bulk_ratio": 150.0, name: value}
    stretches = (0.93, 0.78, 0.57, 0.42)
    (coupon,) = tisim.simulate(
        [tisim.Coupon(material=curves.material(values), stretches=stretches)], workers=1
    )
    np.testing.assert_allclose(curves.stress(stretches, values), coupon.nominal_stress, rtol=5e-3)


def test_made_bonded_data_give_their_modulus_and_slack_back_and_free_platens_do_not_fit() -> None:
    data = made_bonded(23e3, 200.0, 0.004)
    right = fit_press(data, bonded(), last_strain=0.6, noise=NOISE)
    assert right.error < 0.005
    assert right.values["shear_modulus"] == pytest.approx(23e3, rel=0.01)
    assert right.slack == pytest.approx(0.004, abs=5e-4)
    free = press_curves("neo-hookean", "free", CYLINDER)
    wrong = fit_press(data, free, last_strain=0.6, noise=NOISE)
    assert wrong.error > 10 * right.error
    assert wrong.chi_square == pytest.approx((wrong.error / 0.01) ** 2)


def test_made_free_data_give_their_constants_back_and_look_nearly_bonded() -> None:
    stretch = np.linspace(1.0, 0.38, 200)
    data = trial(stretch, mooney(stretch, 9e3, 3e3))
    found = fit_press(data, press_curves("mooney-rivlin", "free", CYLINDER), last_strain=0.55, noise=NOISE)
    assert found.error < 0.005
    assert found.values["shear_modulus"] == pytest.approx(24e3, rel=0.02)
    assert found.values["second_share"] == pytest.approx(0.25, abs=0.03)
    # the shapes are similar: the modulus distinguishes them, if it is known independently
    plain = trial(stretch, mooney(stretch, 12e3, 0.0))
    wrong = fit_press(plain, bonded(), last_strain=0.55, noise=NOISE)
    assert 0.005 < wrong.error < 0.05
    assert wrong.values["shear_modulus"] == pytest.approx(0.77 * 24e3, rel=0.07)


def test_the_scatter_of_repeats() -> None:
    stretch = np.linspace(1.0, 0.4, 100)
    tests = [trial(stretch, f * mooney(stretch, 1e4, 0.0)) for f in (0.98, 1.0, 1.02)]
    found = repeats(tests, (0.05, 0.5))
    assert found.tests == 3
    assert found.relative_sd == pytest.approx(0.02, rel=1e-6)
    with pytest.raises(InputError, match="at least two"):
        repeats(tests[:1], (0.05, 0.5))


def test_an_unloading_after_it_leaves_the_first_loading_as_it_was() -> None:
    stretch = np.linspace(1.0, 0.4, 100)
    stress = mooney(stretch, 1e4, 0.0)
    alone = sampled(trial(stretch, stress), (0.05, 0.5))
    both = trial(np.concatenate([stretch, stretch[::-1]]), np.concatenate([stress, 0.8 * stress[::-1]]))
    np.testing.assert_array_equal(sampled(both, (0.05, 0.5)), alone)


def test_what_is_no_compression_test_is_refused() -> None:
    stretch = np.linspace(1.0, 0.8, 30)
    with pytest.raises(InputError, match=r"made: expected compressive strains from 0\.05 to 0\.5"):
        fit_press(trial(stretch, mooney(stretch, 1e4, 0.0)), bonded(), last_strain=0.5, noise=NOISE)
    with pytest.raises(InputError, match="negative"):
        fit_press(trial(stretch, -mooney(stretch, 1e4, 0.0)), bonded(), last_strain=0.15, noise=NOISE)
    with pytest.raises(InputError, match="uniaxial"):
        fit_press(trial(stretch, stretch, mode="planar"), bonded(), last_strain=0.15, noise=NOISE)


def test_curves_do_not_reach_beyond_their_runs() -> None:
    short = press_curves("st-venant-kirchhoff", "bonded", CYLINDER, refinement=COARSE)
    assert short.runs_short == short.runs
    assert 0.7 < short.reached < 0.95
    with pytest.raises(ValueError, match="no curve below stretch"):
        short.stress(0.5, {"shear_modulus": 1e4, "bulk_ratio": 100.0})


@pytest.mark.skipif(not ECOFLEX.is_dir(), reason=f"no measured data at {ECOFLEX} (TISIM_MEASURED)")
def test_ecoflex_repeats_scatter_little_and_both_platens_are_weighed() -> None:
    trials = {t.id: t for t in read(ECOFLEX).trials if isinstance(t, CouponTrial)}
    again = [t for name, t in trials.items() if name.startswith("EF30")]
    noise = repeats(again, (0.05, 0.3))
    assert noise.tests == 5
    assert 0.003 < noise.relative_sd < 0.02
    for name in ("EF10-0T-A1", "EF30-0T-A3", "EF50-0T-A1"):
        fits = [
            fit_press(trials[name], curves, last_strain=0.3, noise=noise)
            for curves in (bonded(), press_curves("neo-hookean", "free", CYLINDER))
        ]
        held, slid = (fit.values["shear_modulus"] for fit in fits)
        # the bonded force ratio of this shape is 1.4, so that the bonded fit has a smaller modulus
        assert 1.25 < slid / held < 1.7
        assert max(fit.error for fit in fits) < 0.1
