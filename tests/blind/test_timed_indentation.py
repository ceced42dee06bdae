"""Stored indentations of a viscous layer (FElupe) against Hertz, Lee and Radok, and holds in closed form."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from benchmarks.blind.timed.cases import draw_indentation, pushes_of
from benchmarks.blind.timed.indentation import CHECKS, load, stored_force

Array = NDArray[np.float64]
HALF_SPACE = CHECKS["half-space, loading"]
RADIUS, PRONY = HALF_SPACE.layer.rod, HALF_SPACE.prony
SPEED = float(HALF_SPACE.course.last / HALF_SPACE.course.corners()[0][-1])


def stored(name: str) -> tuple[Array, Array]:
    """Times [s], and forces over the long-time modulus [m2]."""
    entry = load()[name]
    return np.array(entry["time"]), np.array(entry["force"])


def hereditary(time: float, force: Callable[[Array], Array]) -> float:
    """int_0^t (1 + sum g_i exp(-(t - s)/tau_i)) dF(s) of an elastic force F(s) over the modulus."""
    s = np.linspace(0.0, 1.0, 4001) ** 2 * time
    return float(PRONY.modulus(time - 0.5 * (s[1:] + s[:-1])) @ np.diff(force(s)))


def test_an_elastic_half_space_meets_a_sphere_as_hertz_says() -> None:
    """F = 16/3 G sqrt(R) depth^(3/2) within 1.5 %, the error by finite depth over radius and the mesh."""
    time, force = stored("half-space, elastic")
    deep = time > 0.15 * time[-1]
    hertz = 16.0 / 3.0 * np.sqrt(RADIUS) * (SPEED * time[deep]) ** 1.5
    assert force[deep] == pytest.approx(hertz, rel=0.015)


def test_a_viscous_half_space_in_loading_is_lee_and_radoks() -> None:
    """F(t) = 16/3 sqrt(R) int G(t - s) d(depth^(3/2))."""
    time, force = stored("half-space, loading")
    factor = 16.0 / 3.0 * np.sqrt(RADIUS) * SPEED**1.5
    deep = np.flatnonzero(time > 0.15 * time[-1])
    expected = [hereditary(t, lambda s: factor * s**1.5) for t in time[deep]]
    assert force[deep] == pytest.approx(expected, rel=0.015)
    # and convolved with the same elements' elastic force, which removes the error of Hertz's theory
    elastic_time, elastic = stored("half-space, elastic")
    curve = PchipInterpolator(elastic_time ** (1 / 3), elastic ** (2 / 9))  # nearly a straight line
    own = [hereditary(t, lambda s: curve(s ** (1 / 3)) ** 4.5) for t in time[deep]]
    assert force[deep] == pytest.approx(own, rel=0.004)
    assert (force[deep] > 1.3 * np.interp(time[deep], elastic_time, elastic)).all()


def test_the_time_steps_of_an_indentation_are_fine_enough() -> None:
    (time, force), (fine_time, fine) = (stored(f"half-space, loading{end}") for end in ("", ", finer"))
    shared = np.isin(np.round(fine_time, 6), np.round(time, 6))
    same = np.isin(np.round(time, 6), np.round(fine_time, 6)) & (time > 0.15 * time[-1])
    shared &= fine_time > 0.15 * time[-1]
    assert same.sum() == shared.sum() >= 10
    assert force[same] == pytest.approx(fine[shared], rel=1e-3)


@pytest.mark.parametrize("base", ["ball", "thick"])
def test_the_force_of_a_hold_relaxes_by_the_relaxation_function(base: str) -> None:
    """At finite depth and with friction: all isochoric stresses of a constant field relax alike."""
    time, force = stored(f"{base}, hold")
    begin = CHECKS[f"{base}, hold"].course.corners()[0][1]
    held = time >= begin
    expected = PRONY.modulus(time[held] - begin) / PRONY.modulus(np.array(0.0))
    assert held.sum() > 8
    assert force[held] / force[held][0] == pytest.approx(expected, rel=2e-3)


def test_what_is_stored_is_what_the_seeds_ask_for() -> None:
    """Stored seeds have the drawn courses and spectra; forces decrease in holds and in retraction."""
    seeds = sorted({int(name.split(",")[0].split()[1]) for name in load() if name.startswith("seed")})
    assert seeds
    for seed in seeds:
        pokes = {poke.base: poke for poke in draw_indentation(seed).pokes}
        for name, push in pushes_of(seed).items():
            asked = load()[name]["push"]
            assert asked["prony"] == {k: list(v) for k, v in vars(push.prony).items()}
            course = pokes[name.split(", ")[1]].course
            assert [p["to"] for p in asked["course"]["pieces"]] == [p.to for p in course.pieces]
            corners, _ = course.corners()
            force = stored_force(name, course, corners)
            assert force[1] > 1.1 * force[2] > 2.0 * force[3] >= 0.0  # the indenter may have lost contact
