"""Forces of viscoelastic indentation from the elastic curve: other code, closed forms, limits."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from benchmarks.blind.timed.indentation import load
from calibration.measurements.indentation._memory_force import loads, stiffnesses, thresholds
from tisim import Prony

Array = NDArray[np.float64]


def ball(depth: Array) -> Array:
    return np.asarray(np.maximum(depth, 0.0) ** 1.5)


def followed(prony: Prony, time: Array, depth: Array) -> Array:
    met = thresholds(float(depth.max()))
    return np.asarray(loads(prony.spectrum(), time, depth, met[:-1]) @ stiffnesses(met, ball(met)))


def test_a_sphere_on_a_half_space_is_that_of_other_finite_elements() -> None:
    """In loading, from the elastic curve of the same elements (Lee and Radok)."""
    stored = load()
    elastic, viscous = stored["half-space, elastic"], stored["half-space, loading, finer"]
    speed = 1e-4
    depth, force = speed * np.array(elastic["time"]), np.array(elastic["force"])
    curve = PchipInterpolator(depth, force ** (2.0 / 3.0))
    prony = Prony(**{k: tuple(v) for k, v in viscous["push"]["prony"].items()})
    time, expected = np.array(viscous["time"]), np.array(viscous["force"])
    met = thresholds(speed * time[-1])
    springs = stiffnesses(met, np.asarray(curve(met)) ** 1.5)
    found = loads(prony.spectrum(), time, speed * time, met[:-1]) @ springs
    assert np.abs(found - expected).max() < 1.5e-3 * expected.max()


def test_retraction_is_tings() -> None:
    """Ting: F(t) = int_0^t1 G(t - s) dF/ds ds with the contact of t1: int_t1^t G(t - s) d' ds = 0."""
    prony = Prony(fractions=(1.5,), times=(2.0,))
    turn, end = 3.0, 5.0
    time = np.linspace(0.0, end, 401)

    def relaxing(t: Array) -> Array:
        return np.asarray(1.0 + 1.5 * np.exp(-t / 2.0))

    def pushed(since: float, now: float) -> float:
        """Hereditary integral of the depth, with speed 1 up to the turn and -1 after it."""
        s = np.linspace(since, turn, 2001)
        back = np.linspace(turn, now, 2001)
        return float(np.trapezoid(relaxing(now - s), s) - np.trapezoid(relaxing(now - back), back))

    found = followed(prony, time, np.minimum(time, 2.0 * turn - time))
    for at in (3.2, 3.5, 3.8):
        width = brentq(pushed, 0.0, turn, args=(at,))
        s = np.linspace(0.0, width, 4001)
        expected = np.trapezoid(relaxing(at - s) * 1.5 * np.sqrt(s), s)
        assert np.interp(at, time, found) == pytest.approx(expected, rel=5e-3)
    left = float(brentq(lambda t: pushed(0.0, t), turn, end))
    assert np.interp(left - 0.1, time, found) > 0.0
    assert (found[time > left + 0.05] == 0.0).all()  # zero before the indenter is back at the surface
    assert left < 2.0 * turn - 0.3


def test_a_spring_that_was_left_is_met_again_where_it_has_recovered_to() -> None:
    prony = Prony(fractions=(2.0,), times=(10.0,))
    time = np.linspace(0.0, 8.0, 801)
    depth = np.interp(time, [0.0, 1.0, 2.0, 3.0, 4.0, 8.0], [0.0, 1.0, 0.0, 0.0, 1.0, 1.0])
    (own,) = loads(prony.spectrum(), time, depth, np.zeros(1)).T
    again = time[(time > 3.0) & (own > 0.0)][0]
    assert own.max() == pytest.approx(own[time <= 1.0].max())
    assert again > 3.05  # its surface has not fully recovered
    assert own[-1] == pytest.approx(1.0 + 2.0 * np.exp(-0.45), rel=0.1)


@pytest.mark.parametrize("fraction", [0.0, 0.7])
def test_what_does_not_relax_in_time_has_the_elastic_force(fraction: float) -> None:
    """Both limits: a time far beyond the test adds stiffness, one far below it has no effect."""
    time = np.linspace(0.0, 2.0, 101)
    depth = 1e-3 * np.minimum(time, 2.0 - time)
    for tau, factor in ((1e9, 1.0 + fraction), (1e-9, 1.0)):
        found = followed(Prony(fractions=(fraction,), times=(tau,)), time, depth)
        assert np.abs(found - factor * ball(depth)).max() < 2e-3 * ball(depth).max()
