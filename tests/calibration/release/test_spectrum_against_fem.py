"""The reduced beam with a relaxation spectrum against tisim's solid, released with the same material."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from calibration.measurements.release import marker_displacements, ringdown
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release._forward import at_frequency
from calibration.measurements.release._vibration import beam_markers, free_vibration
from tisim import Beam, Prony, Rectangle, Solver, material_from_moduli, simulate

LENGTH, SIDE, DENSITY, SHEAR = 0.1, 0.03, 1070.0, 75e3
PRONY = Prony(fractions=(0.25, 0.1), times=(0.015, 0.4))
SECONDS, STEP = 1.2, 2e-3


@pytest.mark.slow
def test_frequency_damping_and_rest() -> None:
    """Frequency within 1.5 %, loss per cycle within 5 %, centre of the motion within 2 %.

    Beam theory has errors of this size without viscosity, too, which `corrections` removes.
    """
    material = material_from_moduli(
        "neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR, density=DENSITY
    )
    section = Rectangle(width=SIDE, height=SIDE)
    solver = Solver(method="implicit", duration=SECONDS, time_step=STEP, tolerance=1e-4)
    beam = Beam(
        material=replace(material, viscosity=PRONY),
        length=LENGTH,
        section=section,
        grip_length=0.01,
        axial_element_size=0.02,
        radial_elements=1,
        solver=solver,
    )
    (result,) = simulate([beam], workers=1)
    assert result.ok
    tip = marker_displacements(result, [[LENGTH, 0.0, 0.0]])[0, :, 2]
    solid = ringdown(result.load, 1e3 * tip, first=0.15, last=1.1)
    period = 1.0 / (2.0 * np.pi * solid.frequency)
    shear, branches = at_frequency(SHEAR, PRONY.spectrum(), period)
    parameters = BeamParameters(
        section=section,
        shear_modulus=shear,
        density=DENSITY,
        length=LENGTH,
        branches=branches,
        reference_time=period,
        stiff_root=0.06 * SIDE,
    )
    q = free_vibration(parameters).coordinates(result.load)
    moved = beam_markers(parameters, q, [(LENGTH, 0.0)]).displacement[0, :, 1]
    reduced = ringdown(result.load, 1e3 * moved, first=0.15, last=1.1)
    # BDF2 reduces an angular frequency w by the fraction (w dt)^2 / 3
    slowed = 1.0 - (STEP / period) ** 2 / 3.0
    assert reduced.frequency * slowed == pytest.approx(solid.frequency, rel=0.015)
    assert reduced.damping_ratio == pytest.approx(solid.damping_ratio, rel=0.05)
    assert reduced.centre == pytest.approx(solid.centre, rel=0.02)
    assert reduced.creep == pytest.approx(solid.creep, rel=0.1)
