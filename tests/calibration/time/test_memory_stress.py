"""Stress of history-dependent materials along the course of a record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from timed_coupons import CYCLES, RELAXATION, SOLID, trial

import tisim
from benchmarks.blind.timed.material import Fibres, Prony
from calibration.experiment.model import CouponMode, CouponTrial
from calibration.measurements.homogeneous import nominal_stress, predicted
from calibration.measurements.homogeneous._memory_stress import stresses_along
from calibration.measurements.homogeneous._record import Record, records_of
from calibration.measurements.indentation._memory_force import loads
from tisim.course import Course
from tisim.parts import respond

PRONY = tisim.Prony(fractions=SOLID.prony.fractions, times=SOLID.prony.times)
MULLINS = tisim.OgdenRoxburgh(r=1.8, m=1500.0, beta=0.15)
OGDEN = {"mu": SOLID.mu, "alpha": SOLID.alpha, "bulk": 3e7}
MATERIAL = tisim.Material(law="ogden", parameters=OGDEN, viscosity=PRONY, softening=MULLINS)


def record(made: CouponTrial) -> Record:
    (found,) = records_of([made], courses=True)
    return found


def stress(material: tisim.Material, of: Record) -> np.ndarray:
    return predicted(material, [(of, of.stretch)])[0]


@pytest.mark.parametrize("mode", ["uniaxial", "equibiaxial", "planar"])
@pytest.mark.parametrize("course", [RELAXATION, CYCLES])
def test_the_stress_is_the_blind_laboratorys(mode: CouponMode, course: object) -> None:
    made = record(trial("t", mode, course))  # type: ignore[arg-type]
    assert np.abs(stress(MATERIAL, made) - made.stress).max() < 5e-4 * np.abs(made.stress).max()


# the laboratory's solution for a strip with shear is slow
_OBLIQUE = [
    pytest.param(mode, parts, marks=[pytest.mark.slow] if mode == "uniaxial" and parts else [])
    for mode in ("uniaxial", "equibiaxial", "planar")
    for parts in ((), ("viscosity",), ("softening",), ("viscosity", "softening"))
]


@pytest.mark.parametrize(("mode", "parts"), _OBLIQUE)
def test_fibres_beside_other_parts_are_the_blind_laboratorys(
    mode: CouponMode, parts: tuple[str, ...]
) -> None:
    """The strip shears and its lateral stretches differ; viscosity and softening make both history-dependent.

    The law is neo-Hookean (Ogden's with alpha 2), whose kernels compile in a quarter of the time.
    """
    angle = float(np.radians(35.0))
    solid = replace(
        SOLID,
        mu=(3e4,),
        alpha=(2.0,),
        prony=SOLID.prony if "viscosity" in parts else Prony(),
        softening=SOLID.softening if "softening" in parts else None,
        fibres=Fibres(k1=1.5e4, k2=0.8, angle=angle),
    )
    fibres = tisim.HolzapfelGasserOgden(direction=(np.cos(angle), np.sin(angle), 0.0), k1=1.5e4, k2=0.8)
    material = replace(
        tisim.material_from_moduli("neo-hookean", shear_modulus=3e4, bulk_modulus=3e7),
        fibres=fibres,
        viscosity=PRONY if "viscosity" in parts else None,
        softening=MULLINS if "softening" in parts else None,
    )
    made = record(trial("t", mode, CYCLES, solid=solid))
    assert np.abs(stress(material, made) - made.stress).max() < 1e-3 * np.abs(made.stress).max()


def test_a_strip_with_oblique_fibres_is_tisims() -> None:
    """The strip shears, relaxes and softens."""
    direction = (float(np.cos(0.6)), float(np.sin(0.6)), 0.0)
    material = tisim.Material(
        law="ogden",
        parameters=OGDEN,
        viscosity=PRONY,
        softening=MULLINS,
        fibres=tisim.HolzapfelGasserOgden(direction=direction, k1=1.5e4, k2=0.8),
    )
    course = Course(start=1.0, growth=0.3).ramp(to=1.5, duration=5.0).hold(20.0).ramp(to=1.05, duration=5.0)
    simulated = tisim.simulate(tisim.Coupon(material=material, course=course))
    assert simulated.nominal_stress is not None
    assert simulated.time is not None
    time = np.concatenate([[0.0], simulated.time])
    stretch = np.array([course.value(t) for t in time])
    made = CouponTrial(
        id="t", material="M", mode="uniaxial", stretch=stretch, stress=stretch, time=time, stress_sd=1.0
    )
    own = stress(material, record(made))[1:]
    assert np.abs(own - simulated.nominal_stress).max() < 2e-3 * simulated.nominal_stress.max()


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_a_test_without_an_answer_leaves_the_others_alone() -> None:
    """Stiff fibres at a stretch of 4 have no finite stress; the test to 1.2 beside it is what it is alone."""
    material = replace(
        tisim.material_from_moduli("neo-hookean", shear_modulus=2e4, bulk_modulus=1e6),
        fibres=tisim.HolzapfelGasserOgden(direction=(1.0, 1.0, 0.0), k1=1e4, k2=30.0),
        viscosity=PRONY,
    )
    tests = []
    for top in (1.2, 4.0):
        stretch = np.linspace(1.0, top, 20)
        time = np.linspace(0.0, 10.0, 20)
        made = record(
            CouponTrial(
                id="t",
                material="M",
                mode="uniaxial",
                stretch=stretch,
                stress=stretch,
                time=time,
                stress_sd=1.0,
            )
        )
        assert made.course is not None
        tests.append(("uniaxial", made.course, made.course.stretch))
    (alone,) = stresses_along(material, tests[:1])
    beside, lost = stresses_along(material, tests)
    assert np.isfinite(alone).all()
    assert beside == pytest.approx(alone, rel=1e-9)
    assert np.isnan(lost).any()


def test_a_cylinder_that_its_platens_have_left_recovers_freely() -> None:
    """At small strain the reference is a spring with the material's relaxation, by other code."""
    time = np.concatenate(
        [np.linspace(0.0, 1.0, 21), np.linspace(1.5, 11.0, 60), np.linspace(11.1, 13.0, 60)]
    )
    strain = 1e-3 * np.interp(time, [0.0, 1.0, 5.0, 5.2, 6.0, 8.0, 13.0], [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0])
    trial_ = CouponTrial(
        id="t", material="M", mode="uniaxial", stretch=1.0 - strain, stress=-strain, time=time, stress_sd=1.0
    )
    made = record(trial_)
    assert made.course is not None
    plain = tisim.Material(law="ogden", parameters=OGDEN, viscosity=PRONY)
    pushed = replace(made, course=replace(made.course, pushes=True))
    pulled, own = stress(plain, made), stress(plain, pushed)
    met = np.zeros(1)
    load = loads(PRONY.spectrum(), made.course.time, 1.0 - made.course.stretch, met)[:, 0]
    expected = -3.0 * SOLID.shear_modulus * made.course.means(load)
    assert pulled.max() > 0.05 * np.abs(own).max()
    assert own.max() < 1e-4 * np.abs(own).max()
    assert np.abs(own - expected).max() < 3e-3 * np.abs(expected).max()
    assert np.abs(own - np.minimum(pulled, 0.0)).max() > 0.01 * np.abs(own).max()


def test_simple_shear_is_tisims() -> None:
    time = np.linspace(0.0, 20.0, 101)
    shear = np.interp(time, [0.0, 2.0, 12.0, 14.0, 20.0], [0.0, 0.8, 0.8, 0.1, 0.6])
    F = np.tile(np.eye(3), (101, 1, 1))
    F[:, 0, 2] = shear
    made = CouponTrial(
        id="t", material="M", mode="simple-shear", stretch=1.0 + shear, stress=shear, time=time, stress_sd=1.0
    )
    own = stress(MATERIAL, record(made))
    theirs = respond(MATERIAL, time, F).stress[:, 0, 0, 2]
    assert np.abs(own - theirs).max() < 1e-3 * np.abs(theirs).max()
    # rows at the corners need no refinement: differences come from the finer steps only
    assert np.abs(theirs).max() > 1e4


def test_coarse_rows_are_refined() -> None:
    fine = record(trial("t", "uniaxial", RELAXATION))
    made = trial("t", "uniaxial", RELAXATION)
    some = np.unique(np.concatenate([np.arange(0, 30, 10), np.arange(29, made.stretch.size)]))
    assert made.time is not None
    coarse = replace(made, stretch=made.stretch[some], stress=made.stress[some], time=made.time[some])
    ends = stress(MATERIAL, fine)[29:]
    assert np.abs(stress(MATERIAL, record(coarse))[-ends.size :] - ends).max() < 1e-3 * np.abs(ends).max()


def test_noise_of_the_stretch_in_a_hold_softens_nothing() -> None:
    time = np.concatenate([np.linspace(0.0, 5.0, 50), np.linspace(5.0, 200.0, 2001)[1:]])
    stretch = np.interp(time, [0.0, 5.0], [1.0, 1.5])
    noise = 3e-4 * np.random.default_rng(3).standard_normal(time.size)
    exact, noisy = (
        record(
            CouponTrial(
                id="t",
                material="M",
                mode="uniaxial",
                stretch=s,
                stress=s - 1.0,
                time=time,
                stress_sd=1.0,
                stretch_sd=3e-4,
            )
        )
        for s in (stretch, stretch + noise)
    )
    left = stress(MATERIAL, noisy) - stress(MATERIAL, exact)
    assert abs(left[-50:].mean()) < 0.003 * stress(MATERIAL, exact)[-1]


def test_a_record_that_begins_on_its_ramp_began_at_rest() -> None:
    made = trial("t", "uniaxial", RELAXATION)
    assert made.time is not None
    some = np.arange(2, made.stretch.size)
    late = replace(made, stretch=made.stretch[some], stress=made.stress[some], time=made.time[some])
    whole = stress(MATERIAL, record(made))
    assert np.abs(stress(MATERIAL, record(late)) - whole[2:]).max() < 1e-4 * whole.max()


def test_a_specimen_remembers_its_earlier_tests() -> None:
    first = trial("first", "uniaxial", CYCLES, specimen="A")
    second = trial("second", "uniaxial", RELAXATION, specimen="A")
    other = trial("other", "uniaxial", RELAXATION, specimen="B")
    softened, virgin = records_of([first, second, other], courses=True)[1:]
    mullins = replace(MATERIAL, viscosity=None)
    at = int(np.argmax(virgin.stretch >= 1.5)) - 5
    assert stress(mullins, softened)[at] < 0.95 * stress(mullins, virgin)[at]
    peak = CYCLES.pieces[2].to
    free = peak**-0.5
    F = np.array(
        [np.diag([peak, free, free]), np.diag([virgin.stretch[at], *2 * [virgin.stretch[at] ** -0.5]])]
    )
    P = respond(mullins, [0.0, 0.0], F).stress[1, 0]
    expected = P[0, 0] - P[2, 2] * F[1, 2, 2] / F[1, 0, 0]
    assert stress(mullins, softened)[at] == pytest.approx(expected, rel=1e-3)


def test_means_of_long_records_are_those_of_the_stress() -> None:
    """A hold of 2000 rows: points of a fit are means, compared with means of the model."""
    time = np.concatenate([np.linspace(0.0, 2.0, 40), np.linspace(2.0, 200.0, 2001)[1:]])
    stretch = np.interp(time, [0.0, 2.0], [1.0, 1.4])
    whole = CouponTrial(
        id="t", material="M", mode="uniaxial", stretch=stretch, stress=stretch - 1.0, time=time, stress_sd=1.0
    )
    thinned = record(whole)
    assert thinned.points < 200
    assert thinned.course is not None
    every = thinned.course.rows
    fine = replace(
        thinned,
        course=replace(
            thinned.course,
            first=np.arange(every.size),
            count=np.ones(every.size),
            kept=np.arange(every.size),
            owner=np.minimum(np.searchsorted(every, np.arange(thinned.course.time.size)), every.size - 1),
        ),
        stretch=stretch,
    )
    rows = stress(MATERIAL, fine)
    first = thinned.course.first
    means = np.add.reduceat(rows, first) / np.diff(np.append(first, every.size))
    assert stress(MATERIAL, thinned) == pytest.approx(means, rel=1e-9)
    # points of a hold are denser while the stress changes faster
    held = thinned.time[thinned.time > 2.0]
    assert np.diff(held)[-1] > 10.0 * np.diff(held)[0]


def test_a_material_without_memory_has_the_stress_of_its_law() -> None:
    made = record(trial("t", "uniaxial", RELAXATION))
    plain = replace(MATERIAL, viscosity=None, softening=None)
    assert stress(plain, made) == pytest.approx(nominal_stress(plain, "uniaxial", made.stretch), rel=1e-12)


def test_fractions_of_zero_and_softening_of_none_change_nothing() -> None:
    made = record(trial("t", "planar", CYCLES))
    nothing = replace(
        MATERIAL,
        viscosity=tisim.Prony(fractions=(0.0,), times=(5.0,)),
        softening=tisim.OgdenRoxburgh(r=1e9, m=1e3),
    )
    stiff = {**OGDEN, "bulk": 3e10}
    law = nominal_stress(tisim.Material(law="ogden", parameters=stiff), "planar", made.stretch)
    assert stress(nothing, made) == pytest.approx(law, rel=1e-4, abs=1.0)
