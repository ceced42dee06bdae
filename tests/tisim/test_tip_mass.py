"""A mass on the free face, against the spring-mass system of a light cantilever."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim

SHEAR, BULK, RADIUS, LENGTH, MASS = 100e3, 2e6, 0.005, 0.1, 0.020


def light_beam(**changes):
    """Slender cantilever of 0.08 g with 20 g on its end; its static deflection is 0.2 mm."""
    return tisim.Beam(
        material=tisim.material_from_moduli(
            "neo-hookean", shear_modulus=SHEAR, bulk_modulus=BULK, density=10.0
        ),
        length=LENGTH,
        section=tisim.Circle(radius=RADIUS),
        gravity=(0.0, 0.0, 0.0),
        tip_force=(0.0, 0.0, -1e-4),
        tip_mass=MASS,
        axial_element_size=0.014,
        radial_elements=1,
        **changes,
    )


def tip(result):
    """Mean displacement of the free face along z over the frames [m], shape (f,)."""
    nodes = result.mesh.node_sets["tip"]
    return (result.positions[:, nodes] - result.mesh.nodes[nodes])[..., 2].mean(axis=1)


def test_frequency_of_a_light_cantilever_with_an_end_mass():
    """w^2 = k / (m + 33/140 m_beam) with 1/k = L^3 / 3 E I + L / 0.89 G A, from zero crossings."""
    young = 9.0 * BULK * SHEAR / (3.0 * BULK + SHEAR)
    area, inertia = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4.0
    flexibility = LENGTH**3 / (3.0 * young * inertia) + LENGTH / (0.89 * SHEAR * area)
    period = 2.0 * np.pi * np.sqrt(flexibility * (MASS + 33.0 / 140.0 * 10.0 * area * LENGTH))
    solver = tisim.Solver(method="implicit", duration=1.7 * period, time_step=period / 100.0, tolerance=1e-8)
    swing, static = tisim.simulate([light_beam(solver=solver), light_beam()], workers=1)
    assert swing.ok
    assert static.ok
    # the clamp also constrains the section's width, which makes the beam about 0.3 radii shorter
    softness = tip(static)[-1] / -1e-4
    assert softness == pytest.approx(flexibility, rel=0.02)
    about = tip(swing) - tip(static)[-1]
    k = np.flatnonzero(np.diff(np.sign(about)))
    crossings = swing.load[k] - about[k] * np.diff(swing.load)[k] / np.diff(about)[k]
    # BDF2 lengthens the period by (w dt)^2 / 3: 0.13 % at 100 steps
    expected = period * np.sqrt(softness / flexibility)
    assert 2.0 * np.diff(crossings)[:2].mean() == pytest.approx(expected, rel=0.003)


def test_half_and_whole_model_move_alike():
    """The half model carries half of the mass; a lateral force of 1e-12 N selects the whole model."""
    solver = tisim.Solver(method="implicit", duration=0.05, time_step=5e-3)
    half = light_beam(solver=solver)
    whole = replace(half, tip_force=(0.0, 1e-12, -1e-4))
    results = tisim.simulate([half, whole], workers=1)
    assert [r.mesh.symmetry for r in results] == [("y",), ()]
    np.testing.assert_allclose(tip(results[0]), tip(results[1]), rtol=1e-3)


def test_explicit_and_implicit_agree():
    solver = tisim.Solver(method="implicit", duration=0.04, time_step=2.5e-4)
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=40e3, bulk_modulus=400e3)
    beam = tisim.Beam(
        material=material,
        length=0.03,
        tip_mass=0.02,
        tip_force=(0, 0, -0.1),
        axial_element_size=0.01,
        radial_elements=1,
        solver=solver,
    )
    bare = replace(beam, tip_mass=0.0)
    other = replace(beam, solver=replace(solver, method="explicit", time_step=0.01))
    heavy, explicit, light = (tip(r)[-1] for r in tisim.simulate([beam, other, bare], workers=1))
    assert heavy == pytest.approx(explicit, rel=0.02)
    assert abs(heavy - light) > 0.2 * abs(heavy)


def test_refusals():
    with pytest.raises(ValueError, match=r"Beam.tip_mass: expected a mass of 0 kg or more, got -0.1"):
        tisim.simulate([replace(light_beam(), tip_mass=-0.1)])
    with pytest.raises(
        ValueError, match=r"Beam.tip_mass: expected no mass on a beam that is clamped at both"
    ):
        tisim.simulate([replace(light_beam(), tip_force=(0.0, 0.0, 0.0), supports="clamped-clamped")])
