"""The solver of the blind data, against beam theory, symmetries and a finer mesh."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.blind.beams.ideal_beams import edge_points, interpolate
from benchmarks.blind.beams.model import GRAVITY, Beam, Resolution
from benchmarks.blind.beams.solver import axis_of, solve

STIFF = 4e6  # Pa: deflections of about 0.01 mm
FINER = Resolution(split=2, first=0.0009, growth=1.26, longest=0.003)  # twice as fine in each direction


def tip(beam: Beam) -> float:
    """Vertical displacement of the axis at the end [m], positive upwards."""
    return float(solve(beam).edges(np.array([1.0]))[:, 0, 1].mean())


@pytest.mark.parametrize(("bridge", "short"), [(False, 0.2), (True, 0.15)])
def test_stiff_beams_sag_as_beams_with_shear(bridge: bool, short: float) -> None:
    """w L^4 / (8 E I) + w L^2 / (2 k G A), or w L^4 / (384 E I) + w L^2 / (8 k G A).

    k = 27 / 28 (Cowper: circle, nu = 1/2). A clamp constrains the section, and so acts slightly in front of
    its face, at the same distance for each beam. The error is proportional to R / L and is extrapolated to
    zero.
    """
    departure = []
    for length in (short, 2 * short):
        beam = Beam(length=length, bridge=bridge, mu=10 * STIFF)
        area, inertia = np.pi * beam.radius**2, np.pi * beam.radius**4 / 4
        load, bend, shear = beam.density * GRAVITY * area, 3 * beam.mu * inertia, 27 / 28 * beam.mu * area
        theory = load * length**4 / (8 * bend) + load * length**2 / (2 * shear)
        if bridge:
            theory = load * length**4 / (384 * bend) + load * length**2 / (8 * shear)
        sag = -solve(beam).edges(np.array([0.5 if bridge else 1.0]))[:, 0, 1].mean()
        departure.append(sag / theory - 1)
    assert -0.08 < departure[0] < -0.01
    assert abs(2 * departure[1] - departure[0]) < 4e-3


def test_tilted_clamp_is_turned_gravity() -> None:
    angle = 0.05
    tilted = solve(Beam(length=0.05, bridge=False, mu=20e3, near_tilt=angle))
    turned = solve(Beam(length=0.05, bridge=False, mu=20e3, gravity_angle=-angle))
    s = np.linspace(0, 1, 11)
    c, w = np.cos(angle), np.sin(angle)
    np.testing.assert_allclose(tilted.edges(s), turned.edges(s) @ np.array([[c, w], [-w, c]]), atol=1e-7)


def test_moulded_arc_without_weight_lies_on_its_arc() -> None:
    shape = solve(Beam(length=0.1, bridge=False, mu=1e6, density=1e-3, curvature=0.7))
    end = axis_of(shape)[-1]
    np.testing.assert_allclose(end[1:], [np.sin(0.07) / 0.7, (1 - np.cos(0.07)) / 0.7, 0.07], atol=2e-6)


def test_clamp_yields_by_the_moment_that_it_carries() -> None:
    beam = Beam(length=0.05, bridge=False, mu=30e3, compliance=3.0)
    shape = solve(beam)
    weight = shape.model.load[..., 2] * beam.mu * 2  # weight of both halves [N]
    moment = (weight * shape.x[..., 0]).sum()
    assert shape.turn[0] == pytest.approx(beam.compliance * moment, rel=1e-3)


def test_pinned_end_carries_no_moment() -> None:
    """Propped cantilever with small deflections: the pinned face rotates by w L^3 / (48 E I)."""
    beam = Beam(length=0.15, bridge=True, mu=STIFF, far_pinned=True)
    load = beam.density * GRAVITY * np.pi * beam.radius**2
    inertia = np.pi * beam.radius**4 / 4
    assert solve(beam).turn[1] == pytest.approx(load * 0.15**3 / (48 * 3 * STIFF * inertia), rel=0.05)


def test_missing_stiffness_bends_as_the_integral_says() -> None:
    """At small deflections a void of fraction f over 15 mm adds f / (1 - f) M (L - x) dx / (E I) at the tip.

    The effect of the missing weight is subtracted.
    """
    plain = Beam(length=0.2, bridge=False, mu=STIFF)
    hollow = Beam(length=0.2, bridge=False, mu=STIFF, void=0.3, void_at=0.06)
    load = plain.density * GRAVITY * np.pi * plain.radius**2
    inertia = np.pi * plain.radius**4 / 4
    x = np.linspace(0.0525, 0.0675, 201)
    bent = np.mean(load * (0.2 - x) ** 2 / 2 * (0.2 - x)) * 0.015 * (0.3 / 0.7)
    lifted = 0.3 * load * 0.015 * 0.06**2 * (3 * 0.2 - 0.06) / 6
    theory = (bent - lifted) / (3 * STIFF * inertia)
    assert tip(plain) - tip(hollow) == pytest.approx(theory, rel=0.08)


def test_skin_stiffens_by_its_share_of_the_inertia() -> None:
    """EI grows by the fraction skin (1 - 0.9^4): a stiffer skin of 1 mm on a radius of 10 mm."""
    plain, skinned = (tip(Beam(length=0.2, bridge=False, mu=STIFF, skin=k)) for k in (0.0, 0.2))
    assert plain / skinned == pytest.approx(1 + 0.2 * (1 - 0.9**4), rel=2e-3)


def test_blob_and_string_pull_as_their_forces() -> None:
    plain = tip(Beam(length=0.2, bridge=False, mu=STIFF))
    inertia = np.pi * 0.010**4 / 4
    hung = tip(Beam(length=0.2, bridge=False, mu=STIFF, blob=2e-3))
    assert plain - hung == pytest.approx(2e-3 * GRAVITY * 0.2**3 / (9 * STIFF * inertia), rel=0.04)
    held = tip(Beam(length=0.2, bridge=False, mu=STIFF, string=0.01))
    assert held - plain == pytest.approx(0.01 * 0.1**2 * (0.6 - 0.1) / (18 * STIFF * inertia), rel=0.04)


def test_mass_on_the_face_pulls_at_the_end() -> None:
    plain, loaded = (tip(Beam(length=0.2, bridge=False, mu=STIFF, tip=m)) for m in (0.0, 2e-3))
    theory = 2e-3 * GRAVITY * 0.2**3 / (9 * STIFF * np.pi * 0.010**4 / 4)
    assert plain - loaded == pytest.approx(theory, rel=0.01)


def test_fifty_mm_beam_is_converged() -> None:
    """Within 0.02 mm (normal to the edge, from 2.5 mm off the clamp) of a mesh that is twice as fine."""
    assert _finer(Beam(length=0.05, bridge=False, mu=15e3)) < 0.02e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("length", "mu", "within_mm"), [(0.1, 30e3, 0.1), (0.1, 12e3, 0.1), (0.15, 12e3, 0.03)]
)
def test_long_beams_are_converged(length: float, mu: float, within_mm: float) -> None:
    assert _finer(Beam(length=length, bridge=length > 0.12, mu=mu)) < within_mm * 1e-3


def _finer(beam: Beam) -> float:
    s = np.linspace(0.0025 / beam.length, 1 - 0.0025 / beam.length, 60)
    coarse = solve(beam)
    fine = solve(beam, start=axis_of(coarse), resolution=FINER).edges(s)
    gap, along = coarse.edges(s) - fine, np.gradient(fine, axis=1)
    across = gap[..., 1] * along[..., 0] - gap[..., 0] * along[..., 1]
    return float(np.abs(across / np.hypot(along[..., 0], along[..., 1])).max())


def test_kept_edges_hold_the_shape() -> None:
    """33 points per edge have errors below 0.025 mm from 2.5 mm off the clamp, and 0.01 mm from 5 mm on."""
    shape = solve(Beam(length=0.1, bridge=False, mu=15e3))
    s = np.linspace(0.025, 1.0, 200)
    error = np.abs(interpolate(1, shape.edges(edge_points(1)), s) - shape.edges(s)).max(axis=(0, 2))
    assert error.max() < 2.5e-5
    assert error[s > 0.05].max() < 1e-5
