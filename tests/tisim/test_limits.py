"""Scenes at their limits: no load, nearly incompressible, arrays as vectors, fewer frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim
from tisim.scene import ClampImperfections, Solver

SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=2e4, bulk_modulus=2e6)
PRONY = tisim.Prony(fractions=(0.3,), times=(1.0,))
VISCOUS = replace(SOFT, viscosity=PRONY)


def test_clamps_that_strain_a_beam_without_load_over_time() -> None:
    found = tisim.simulate(
        tisim.Beam(
            material=VISCOUS,
            length=0.05,
            radial_elements=1,
            supports="clamped-clamped",
            gravity=(0.0, 0.0, 0.0),
            clamp_imperfections=ClampImperfections(far_shift=(0.0, 0.005)),
            course=tisim.Course(frames=(0.0, 10.0)).jump(1.0).hold(10.0),
        )
    )
    assert found.ok, found.message


def test_frames_do_not_decide_whether_a_beam_converges() -> None:
    """A thin, nearly incompressible beam, whose residual is rounding, with and without the frame at 0 s."""
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=2e5, bulk_modulus=2e9)
    ends = []
    for frames in ((0.0, 5.0), (5.0,)):
        course = tisim.Course(frames=frames).jump(1.0).hold(5.0)
        beam = tisim.Beam(
            material=material,
            length=0.15,
            section=tisim.Circle(radius=2e-3),
            course=course,
            radial_elements=1,
        )
        found = tisim.simulate(beam)
        assert found.ok, (frames, found.message)
        ends.append(found.positions[-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)


@pytest.mark.parametrize("ratio", [3e4, 1e5])
def test_nearly_incompressible_coupons_and_cylinders_near_rest(ratio: float) -> None:
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=2e4, bulk_modulus=2e4 * ratio)
    for stretches in ((1.0,), (1.2, 1.0), (1.001, 1.2)):
        found = tisim.simulate(tisim.Coupon(material=material, stretches=stretches))
        assert found.ok, (stretches, found.message)
    course = tisim.Course(start=1.0).ramp(to=0.9, duration=1.0).ramp(to=1.0, duration=1.0)
    pressed = tisim.Press(
        material=material, radius=0.01, height=0.012, refinement=0.5, platens="free", course=course
    )
    assert tisim.simulate(pressed).ok


def test_an_explicit_beam_without_load_stays_at_rest() -> None:
    beam = tisim.Beam(
        material=SOFT,
        length=0.05,
        radial_elements=1,
        gravity=(0.0, 0.0, 0.0),
        solver=Solver(method="explicit", duration=2e-3),
    )
    found = tisim.simulate(beam)
    assert found.ok, found.message
    assert found.positions[-1] == pytest.approx(found.positions[0], abs=1e-12)


def test_vectors_may_be_arrays_in_a_batch() -> None:
    course = tisim.Course(frames=(1.0,)).jump(1.0).hold(1.0)
    beams = [
        tisim.Beam(
            material=replace(
                tisim.material_from_moduli("neo-hookean", shear_modulus=g, bulk_modulus=100.0 * g),
                viscosity=PRONY,
            ),
            length=0.05,
            radial_elements=1,
            gravity=np.array([0.0, 0.0, -9.81]),  # type: ignore[arg-type]
            course=course,
        )
        for g in (2e4, 2.1e4, 2.2e4)
    ]
    assert all(r.ok for r in tisim.simulate(beams, workers=1))
