"""Homogeneous tests of time-dependent materials against closed forms and independent quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.optimize import OptimizeResult, minimize
from scipy.special import erf

from benchmarks.blind.timed.coupons import respond
from benchmarks.blind.timed.course import Course, cycles
from benchmarks.blind.timed.material import Fibres, Prony, Softening, Solid

NEO = Solid(mu=(20e3,), alpha=(2.0,))
OGDEN = Solid(mu=(15e3, -4e3), alpha=(3.0, -2.0))
PRONY = Prony(fractions=(0.4, 0.25), times=(0.8, 15.0))
SUDDEN = 1e-6  # [s], much shorter than all relaxation times: practically a step


def nominal(solid: Solid, mode: str, s: float) -> float:
    """dW/ds along the mode's path over the number of driven axes, by a central difference; no fibres."""

    def energy(x: float) -> float:
        path = {"uniaxial": (x, x**-0.5, x**-0.5), "planar": (x, 1.0, 1 / x), "equibiaxial": (x, x, x**-2)}
        return float(solid.energy(np.array(path[mode])))

    h = 1e-5
    return (energy(s + h) - energy(s - h)) / (2 * h) / (2.0 if mode == "equibiaxial" else 1.0)


@pytest.mark.parametrize("mode", ["uniaxial", "planar", "equibiaxial"])
@pytest.mark.parametrize("solid", [NEO, OGDEN], ids=["neo-hookean", "ogden"])
def test_a_step_relaxes_by_the_relaxation_function_at_any_stretch(solid: Solid, mode: str) -> None:
    course = Course(start=1.0).ramp(1.7, 0.7 / SUDDEN).hold(60.0)
    times = SUDDEN + np.array([0.0, 0.1, 1.0, 10.0, 60.0])
    found = respond(replace(solid, prony=PRONY), mode, course, times).stress
    elastic = nominal(solid, mode, 1.7)
    assert found == pytest.approx(elastic * PRONY.modulus(times - SUDDEN), rel=2e-6)


@pytest.mark.parametrize("solid", [NEO, OGDEN], ids=["neo-hookean", "ogden"])
def test_a_ramp_and_hold_is_the_hereditary_integral(solid: Solid) -> None:
    """Q_i = g_i int exp(-(t - s)/tau_i) dS/ds ds, for each component, by adaptive quadrature."""
    rate, top, end = 0.1, 1.6, 6.0

    def second(stretch: float, axis: int) -> float:
        return float(solid.deviator(np.array([stretch, stretch**-0.5, stretch**-0.5]))[axis])

    def q(time: float, axis: int) -> float:
        total = 0.0
        for g, tau in zip(PRONY.fractions, PRONY.times, strict=True):

            def inside(s: float, tau: float = tau) -> float:
                x, h = 1.0 + rate * s, 1e-6
                slope = (second(x + h, axis) - second(x - h, axis)) / (2 * h) * rate
                return float(np.exp(-(time - s) / tau) * slope)

            total += g * quad(inside, 0.0, min(time, end), epsabs=1e-6, epsrel=1e-11)[0]
        return total

    course = Course(start=1.0).ramp(top, rate).hold(20.0)
    for time in (2.0, 6.0, 9.0):
        s = min(1.0 + rate * time, top)
        along, across = (second(s, axis) + q(time, axis) for axis in (0, 2))
        expected = s * along - across / s**2
        found = respond(replace(solid, prony=PRONY), "uniaxial", course, np.array([time])).stress[0]
        assert found == pytest.approx(expected, rel=1e-7)


def test_a_ramp_of_a_neo_hookean_sheet_by_exponential_integrals() -> None:
    """S_1 = mu/3 (1 - s^-6), S_3 = -2 mu/3 (s^6 - 1): powers of s with closed-form memory integrals."""
    mu, rate, tau, g, time = 20e3, 0.05, 2.0, 0.5, 8.0
    course = Course(start=1.0).ramp(1.4, rate)
    solid = replace(NEO, prony=Prony(fractions=(g,), times=(tau,)))
    found = respond(solid, "equibiaxial", course, np.array([time])).stress[0]
    s, k = 1.0 + rate * time, 1.0 / (tau * rate)
    # int exp(k x) x^-7 dx by parts, down to the exponential integral Ei(k x) = -E1(-k x)
    ei = [_ei(k * x) for x in (1.0, s)]

    def power(n: int) -> float:
        """int_1^s exp(k (x - s)) x^-n dx."""
        if n == 1:
            return (ei[1] - ei[0]) * np.exp(-k * s)
        edge = np.exp(k * (1.0 - s)) - s ** (1 - n)
        return (edge + k * power(n - 1)) / (n - 1)

    # int exp(k (x - s)) x^5 dx as a polynomial: P' + k P = x^5
    coefficients, c = np.zeros(6), 1.0 / k
    for n in range(5, -1, -1):
        coefficients[n] = c
        c = -c * n / k
    poly = np.polynomial.polynomial.polyval(np.array([1.0, s]), coefficients)
    fifth = poly[1] - np.exp(k * (1.0 - s)) * poly[0]
    q1 = g * mu / 3.0 * 6.0 * power(7)
    q3 = -g * 2.0 * mu / 3.0 * 6.0 * fifth
    along = mu / 3.0 * (1.0 - s**-6) + q1
    thick = -2.0 * mu / 3.0 * (s**6 - 1.0) + q3
    assert found == pytest.approx(s * along - thick * s**-5, rel=1e-8)


def _ei(x: float) -> float:
    """Ei(x) = gamma + ln x + int_0^x (e^t - 1)/t dt, x > 0."""
    return float(np.euler_gamma + np.log(x) + quad(lambda t: np.expm1(t) / t if t else 1.0, 0.0, x)[0])


def test_the_exponential_integral_of_the_test_above() -> None:
    assert _ei(2.0) == pytest.approx(4.954234356001890, rel=1e-10)  # Abramowitz and Stegun, table 5.1


def test_small_oscillation_has_storage_and_loss_modulus() -> None:
    """First harmonic of the response to a triangular wave over that of the wave: 3 (G' + i G'')."""
    period, size, rounds = 4.0, 1e-4, 30
    speed = 4.0 * size / period
    course = Course(start=1.0).ramp(1.0 + size, speed)
    for _ in range(rounds):
        course = course.ramp(1.0 - size, speed).ramp(1.0 + size, speed)
    end = course.corners()[0][-1]
    times = end - period + (np.arange(400) + 0.5) / 400 * period
    solid = replace(NEO, prony=Prony(fractions=(0.4, 0.25), times=(0.3, 3.0)))
    found = respond(solid, "uniaxial", course, times, tolerance=1e-10)
    wave = np.exp(-2j * np.pi * times / period)
    modulus = (found.stress @ wave) / ((found.stretch - 1.0) @ wave) / 3.0
    x = 2.0 * np.pi / period * np.array([0.3, 3.0])
    g = np.array([0.4, 0.25])
    storage, loss = 20e3 * (1.0 + g @ (x**2 / (1.0 + x**2))), 20e3 * (g @ (x / (1.0 + x**2)))
    assert modulus.real == pytest.approx(storage, rel=1e-3)
    assert modulus.imag == pytest.approx(loss, rel=1e-3)


def test_mullins_loops_by_hand() -> None:
    """Neo-Hookean, uniaxial: P = eta mu (s - s^-2), W = mu/2 (s^2 + 2/s - 3)."""
    mu, r, m, beta = 20e3, 2.2, 3e3, 0.15
    solid = replace(NEO, softening=Softening(r=r, m=m, beta=beta))
    found = respond(solid, "uniaxial", cycles(Course(start=1.0), (1.4, 1.8, 1.6), 1.0, 0.1))
    s = found.stretch
    energy = mu / 2 * (s**2 + 2 / s - 3)
    largest = np.maximum.accumulate(energy)
    eta = 1.0 - erf((largest - energy) / (m + beta * largest)) / r
    assert found.stress == pytest.approx(eta * mu * (s - s**-2), rel=1e-12, abs=1e-6)
    assert found.largest == pytest.approx(largest, rel=1e-12)
    assert (eta[: 40 + 1] == 1.0).all()
    assert eta.min() < 0.75


def test_a_viscous_material_relaxes_what_softening_leaves() -> None:
    """After a step in stretch, a hold and a step half-way back, eta jumps, and the jump in stress relaxes."""
    soft = Softening(r=2.0, m=4e3)
    solid = replace(NEO, prony=PRONY, softening=soft)
    sudden = Course(start=1.0).ramp(1.8, 0.8 / SUDDEN).hold(300.0).ramp(1.4, 0.4 / SUDDEN).hold(300.0)
    end = sudden.corners()[0][-1]
    found = respond(solid, "planar", sudden, np.array([end])).stress[0]
    energy = [float(NEO.energy(np.array([s, 1.0, 1 / s]))) for s in (1.4, 1.8)]
    eta = float(soft.eta(np.array(energy[0]), np.array(energy[1])))
    assert found == pytest.approx(eta * nominal(NEO, "planar", 1.4), rel=1e-6)


@pytest.mark.parametrize("angle", [0.0, 30.0, 60.0, 90.0])
def test_fibres_at_four_angles_make_the_energy_least(angle: float) -> None:
    """Lateral stretch and shear minimise W, and the stress is the derivative of the minimum."""
    mu, k1, k2, a = 20e3, 15e3, 0.8, np.radians(angle)

    def energy(s: float, sides: NDArray[np.float64]) -> float:
        """W of F = [[s, shear, 0], [0, lateral, 0], [0, 0, 1/(s lateral)]] over mu, from the formulas."""
        F = np.array([[s, sides[1], 0.0], [0.0, sides[0], 0.0], [0.0, 0.0, 1.0 / (s * sides[0])]])
        over = max(float(((F @ [np.cos(a), np.sin(a), 0.0]) ** 2).sum()) - 1.0, 0.0)
        return float(0.5 * ((F**2).sum() - 3.0) + k1 / mu / (2 * k2) * np.expm1(k2 * over**2))

    def least(s: float) -> OptimizeResult:
        begin = np.array([s**-0.5, 0.0])
        return minimize(
            lambda x: energy(s, x), begin, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-16}
        )

    solid = replace(NEO, fibres=Fibres(k1=k1, k2=k2, angle=a))
    found = respond(solid, "uniaxial", Course(start=1.0, samples=8).ramp(1.5, 0.1))
    for k in (3, 8):
        s, h = float(found.stretch[k]), 3e-4
        assert [found.lateral[k], found.shear[k]] == pytest.approx(least(s).x, abs=1e-6)
        assert found.stress[k] == pytest.approx(
            mu * (least(s + h).fun - least(s - h).fun) / (2 * h), rel=2e-6
        )
    oblique = angle in (30.0, 60.0)
    assert (abs(found.shear[-1]) > 0.01) == oblique
    assert (np.abs(found.lateral - found.stretch**-0.5).max() > 1e-3) == oblique


def test_viscous_oblique_fibres_begin_with_the_instantaneous_answer() -> None:
    """A relaxation time far beyond the test gives 1 + g times the elastic stress, and the same shear."""
    solid = replace(NEO, fibres=Fibres(k1=15e3, k2=0.8, angle=0.6))
    course = Course(start=1.0).ramp(1.4, 0.2)
    elastic = respond(solid, "uniaxial", course)
    slow = respond(
        replace(solid, prony=Prony(fractions=(0.5,), times=(1e6,))), "uniaxial", course, tolerance=1e-7
    )
    assert slow.stress == pytest.approx(1.5 * elastic.stress, rel=1e-5)
    assert slow.shear == pytest.approx(elastic.shear, abs=1e-6)


def test_viscous_fibres_relax_to_the_long_time_stress_and_lateral_stretch() -> None:
    solid = replace(NEO, fibres=Fibres(k1=15e3, k2=0.8, angle=0.6))
    course = Course(start=1.0).ramp(1.4, 0.2).hold(400.0)
    slow, fast = (
        respond(x, "uniaxial", course, tolerance=1e-7) for x in (solid, replace(solid, prony=PRONY))
    )
    assert fast.stress[-1] == pytest.approx(slow.stress[-1], rel=1e-6)
    assert fast.lateral[-1] == pytest.approx(slow.lateral[-1], rel=1e-6)
    assert fast.shear[-1] == pytest.approx(slow.shear[-1], rel=1e-6)
    ramp = fast.time <= 2.0
    assert (fast.stress[ramp][1:] > 1.2 * slow.stress[ramp][1:]).all()
    assert np.abs(fast.lateral[ramp] - slow.lateral[ramp]).max() > 1e-4


def test_the_creep_function_is_the_inverse_of_the_relaxation_function() -> None:
    """int_0^t G(t - s) dJ(s) = 1."""
    for time in (0.1, 2.0, 40.0):
        s = np.linspace(0.0, 1.0, 4001) ** 3 * time
        j = PRONY.compliance(s)
        middle = 0.5 * (s[1:] + s[:-1])
        whole = j[0] * PRONY.modulus(np.array(time)) + PRONY.modulus(time - middle) @ np.diff(j)
        assert whole == pytest.approx(1.0, abs=1e-6)


def test_times_beyond_the_course_are_refused() -> None:
    with pytest.raises(ValueError, match="beyond the end"):
        respond(NEO, "planar", Course(start=1.0).ramp(1.1, 0.1), np.array([2.0]))
