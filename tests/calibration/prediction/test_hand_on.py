"""Effects as parts of a material: the part has the effect's stress and reproduces the record."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_experiment import experiment
from scipy.special import erf

import tisim
from benchmarks.blind.timed.coupons import respond
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Solid
from calibration.diagnosis._handed_on import _together
from calibration.diagnosis.catalogue import effects_of, true_parameter
from calibration.diagnosis.effects._material_parts import branches, one_time, softening_of, viscosity_of
from calibration.diagnosis.effects.release.material import CREEP_TIMES
from calibration.diagnosis.engine.fitting import fit
from calibration.experiment.model import CouponTrial
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements._state import State
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.homogeneous.stress import nominal_stresses

G = 3e4


def relaxation(part: HandedOn, time: np.ndarray) -> np.ndarray:
    """Relaxation modulus of a part over the modulus of the fit."""
    assert isinstance(part.part, tisim.Prony)
    spectrum = part.part.spectrum()
    return part.modulus_ratio * np.array([spectrum.modulus(t) for t in time])


def test_a_decades_relaxation_is_two_terms_a_decade() -> None:
    part = viscosity_of(lambda t: 1.0 - 0.06 * np.log10(t), first=1.0, last=1000.0)
    at = np.geomspace(1.0, 1000.0, 31)
    np.testing.assert_allclose(relaxation(part, at), 1.0 - 0.06 * np.log10(at), atol=0.004)
    assert isinstance(part.part, tisim.Prony)
    np.testing.assert_allclose(np.diff(np.log10(part.part.times)), 0.5)
    assert "between 1 and 1e+03 s" in part.remarks[0]


def test_one_time_is_a_fraction_of_the_instantaneous_modulus() -> None:
    part = one_time(0.3, 5.0, first=0.1, last=60.0)
    at = np.array([0.0, 5.0, 500.0])
    np.testing.assert_allclose(relaxation(part, at), 1.0 - 0.3 * (1.0 - np.exp(-at / 5.0)), rtol=1e-12)
    said = one_time(0.3, 500.0, first=0.1, last=60.0).remarks
    assert any("outside" in text and "500" in text for text in said)


def test_two_spectra_of_a_material_add_up() -> None:
    a = one_time(0.2, 5.0, first=0.1, last=60.0)
    b = viscosity_of(lambda t: 1.0 - 0.05 * np.log10(t / 0.1), first=0.1, last=60.0)
    whole = _together(a, b)
    assert whole is not None
    at = np.geomspace(0.1, 60.0, 9)
    np.testing.assert_allclose(relaxation(whole, at), relaxation(a, at) + relaxation(b, at) - 1.0, rtol=1e-9)
    assert _together(one_time(0.6, 1.0, first=0.1, last=9.0), one_time(0.5, 2.0, first=0.1, last=9.0)) is None


def test_a_vibrations_branches_keep_its_storage_modulus() -> None:
    times, reference = np.array(CREEP_TIMES), 0.03
    part = branches(np.full(len(times), 0.02), times, reference=reference, first=reference, last=100.0)
    assert isinstance(part.part, tisim.Prony)
    s = part.part.spectrum()
    slow = (s.times / reference) ** 2
    storage = s.equilibrium + float(np.sum(s.strengths * slow / (1.0 + slow)))
    assert part.modulus_ratio * storage == pytest.approx(1.0, rel=1e-12)


def test_a_modulus_that_relaxes_to_nothing_has_no_spectrum() -> None:
    part = viscosity_of(lambda t: 1.0 - 0.5 * np.log10(t), first=1.0, last=1000.0)
    assert part.part is None
    assert "relaxes to nothing" in part.remarks[0]


def test_softening_is_ogden_and_roxburghs() -> None:
    part = softening_of(lambda w: 0.4 * erf(1.0 - w) / erf(1.0), energy=2e3)
    assert isinstance(part.part, tisim.OgdenRoxburgh)
    assert part.part.r == pytest.approx(erf(1.0) / 0.4, rel=1e-3)
    assert part.part.beta == pytest.approx(1.0, rel=1e-3)
    straight = softening_of(lambda w: 0.3 * (1.0 - w), energy=2e3).part
    assert isinstance(straight, tisim.OgdenRoxburgh)
    w = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(erf((1.0 - w) / straight.beta) / straight.r, 0.3 * (1.0 - w), atol=0.015)


def test_fibres_have_the_effects_stress() -> None:
    """Stress of a strip along them: derivative of k1/2 (s^2 - 1)^2 by its stretch s."""
    effect = effects_of("homogeneous")["anisotropy"]
    assert effect.hands_on is not None
    part = effect.hands_on(Occurrence(amplitude=0.5, variant=None, shear_modulus=G, records=())).part
    assert isinstance(part, tisim.HolzapfelGasserOgden)
    assert (part.k2, part.direction) == (0.0, (1.0, 0.0, 0.0))
    s = np.linspace(1.0, 1.5, 6)
    np.testing.assert_allclose(2.0 * part.k1 * s * (s**2 - 1.0), 0.5 * 0.5 * G * s * (s**2 - 1.0))


def handed_law(name: str, amplitude: float) -> tuple[str, dict[str, float]]:
    effect = effects_of("homogeneous")[name]
    assert effect.hands_on is not None
    found = effect.hands_on(Occurrence(amplitude=amplitude, variant=None, shear_modulus=G, records=()))
    assert found.law is not None
    law, parameters = found.law(G, 3e3 * G)
    return law, dict(parameters)


def test_a_laws_form_is_a_law_with_the_effects_stress() -> None:
    """The Mooney-Rivlin law agrees with baseline and effect in tension; the constants of two other laws."""
    law, parameters = handed_law("second-invariant", 0.3)
    s = np.linspace(1.05, 1.8, 5)
    (stress,) = nominal_stresses(tisim.Material(law=law, parameters=dict(parameters)), [("uniaxial", s)])
    effect = effects_of("homogeneous")["second-invariant"]
    more = effect.extra(s, 0.3, SimpleNamespace(mode="uniaxial"))  # type: ignore[attr-defined]
    np.testing.assert_allclose(stress, G * (s - s**-2 + more), rtol=3e-3)
    assert handed_law("strain-stiffening", 0.4) == ("yeoh", {"mu": G, "stiffening": 0.4, "bulk": 3e3 * G})
    law, parameters = handed_law("limited-extensibility", 0.04)
    assert law == "eight-chain"
    assert parameters == pytest.approx({"mu": G, "locking": 5.0, "bulk": 3e3 * G})


def test_earlier_names_of_parameters_are_understood() -> None:
    assert true_parameter("relaxation", "loss") == "fraction_of_modulus"
    assert true_parameter("relaxation", "part_of_modulus") == "fraction_of_modulus"
    assert true_parameter("creep", "per_decade") == "per_decade"


TERMS = (1.0, 5.0, 25.0, 125.0, 625.0)
SOLID = Solid(mu=(G,), alpha=(2.0,), prony=Prony(fractions=(0.05,) * len(TERMS), times=TERMS))
PULL = Course(start=1.0, samples=20).ramp(1.3, 0.03).hold(300.0)
NOISE = 0.004


def made_record() -> CouponTrial:
    """A ramp and a hold, integrated by the blind laboratory."""
    made = respond(SOLID, "uniaxial", PULL, tolerance=1e-5)
    sd = NOISE * float(made.stress.max())
    stress = made.stress + sd * np.random.default_rng(3).standard_normal(made.stress.size)
    return CouponTrial(
        id="pull",
        material="M",
        mode="uniaxial",
        stretch=made.stretch,
        stress=stress,
        time=made.time,
        stress_sd=sd,
    )


def test_a_record_comes_back_from_the_part_that_was_found_in_it() -> None:
    """`tisim.Coupon` on the record's course with the card's material, against the elastic baseline."""
    trial = made_record()
    effects = {"rate-dependence": effects_of("homogeneous")["rate-dependence"]}
    model = HomogeneousModel(experiment(trial), effects=effects)  # type: ignore[arg-type]
    base = fit(model, State(u=model.start()))
    (candidate,) = model.candidates
    found = fit(model, base.state, [candidate])
    part = model.hands_on(candidate, found.state)["M"]
    rms = {}
    for name, state, viscosity, ratio in (
        ("baseline", base.state, None, 1.0),
        ("extended", found.state, part.part, part.modulus_ratio),
    ):
        modulus = ratio * model.shear_moduli(state.u)["M"]
        material = replace(
            tisim.material_from_moduli("neo-hookean", shear_modulus=modulus, bulk_modulus=3e3 * G),
            viscosity=viscosity,
        )
        times = tuple(float(t) for t in trial.time[1:])  # type: ignore[index]
        course = tisim.Course(start=1.0, frames=times).ramp(to=1.3, speed=0.03).hold(300.0)
        (result,) = tisim.simulate([tisim.Coupon(material=material, course=course)])
        assert result.ok
        assert result.nominal_stress is not None
        rms[name] = float(np.sqrt(np.mean((result.nominal_stress - trial.stress[1:]) ** 2)))
    sd = trial.stress_sd
    assert sd is not None
    assert rms["baseline"] > 6.0 * sd
    assert rms["extended"] < 1.5 * sd
