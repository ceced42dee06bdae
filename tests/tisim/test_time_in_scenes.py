"""History-dependent materials in scenes: homogeneous, compression and indentation tests, beams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tisim
from tisim import parts

G = 3e4
SOFT = tisim.material_from_moduli("neo-hookean", shear_modulus=G, bulk_modulus=20 * G)
# laws and parts that other tests use too: each set compiles its own kernels
STIFF = tisim.material_from_moduli("ogden", shear_modulus=G, bulk_modulus=1000 * G)
MATRIX = tisim.material_from_moduli("neo-hookean", shear_modulus=G, bulk_modulus=1000 * G)
PRONY = tisim.Prony(fractions=(0.3, 0.2), times=(1.0, 20.0))
VISCOUS = replace(SOFT, viscosity=PRONY)
MULLINS = tisim.OgdenRoxburgh(r=1.6, m=1e3, beta=0.1)
SMALL = {"axial_element_size": 0.01, "radial_elements": 1}


def relaxation(time: np.ndarray) -> np.ndarray:
    return 1.0 + sum(g * np.exp(-time / t) for g, t in zip(PRONY.fractions, PRONY.times, strict=True))


def creep(time: np.ndarray) -> np.ndarray:
    """Creep compliance G J(t) for the relaxation above, from the poles of its Laplace transform."""
    (g1, g2), (a, b) = PRONY.fractions, (1 / t for t in PRONY.times)
    # s G(s) = [ (1+g1+g2) s^2 + (a + b + g1 b + g2 a) s + a b ] / [(s + a)(s + b)]
    poly = np.array([1 + g1 + g2, a + b + g1 * b + g2 * a, a * b])
    found = np.full_like(time, 1.0)
    for pole in np.roots(poly):
        residue = (pole + a) * (pole + b) / (pole * np.polyval(np.polyder(poly), pole))
        found = found + residue * np.exp(pole * time)
    return found


def sag(result: tisim.Result) -> np.ndarray:
    assert result.ok, result.message
    tip = result.mesh.node_sets["tip"]
    return -(result.positions - result.mesh.nodes)[:, tip, 2].mean(axis=1)


@pytest.mark.parametrize("mode", ["uniaxial", "equibiaxial", "planar", "simple-shear"])
def test_a_coupons_stress_relaxes_as_its_material(mode: str) -> None:
    course = tisim.Course(start=1.0).jump(1.4).hold(30.0)
    found = tisim.simulate(tisim.Coupon(material=replace(STIFF, viscosity=PRONY), mode=mode, course=course))
    elastic = tisim.simulate(tisim.Coupon(material=STIFF, mode=mode, stretches=(1.4,)))
    assert found.ok
    assert found.time is not None
    assert found.nominal_stress is not None
    assert found.nominal_stress == pytest.approx(relaxation(found.time) * elastic.nominal_stress[0], rel=2e-3)
    assert found.dissipated is not None
    assert (np.diff(found.dissipated) > 0.0).all()


def test_a_coupon_with_all_parts_is_the_point_and_loses_the_area_of_its_loop() -> None:
    fibres = tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=1e4, k2=1.0)
    material = replace(STIFF, viscosity=PRONY, softening=MULLINS, fibres=fibres)
    frames = tuple(np.arange(1, 81) * 0.1)
    course = (
        tisim.Course(start=1.0, frames=(*frames, 400.0))
        .cycles(to=1.4, back=1.0, speed=0.1, count=1)
        .hold(392.0)
    )
    found = tisim.simulate(tisim.Coupon(material=material, course=course))
    assert found.ok
    x = found.positions[:, 13]  # any node: F is homogeneous
    stretch = np.column_stack([x[:, k] / found.mesh.nodes[13, k] for k in range(3)])
    point = parts.respond(material, found.time, stretch[:, :, None] * np.eye(3))
    assert found.nominal_stress == pytest.approx(point.stress[:, 0, 0, 0], abs=2e-3 * G)
    loop = np.trapezoid(np.r_[0.0, found.nominal_stress], np.r_[1.0, found.load]) * 0.01**3
    assert found.dissipated[-1] == pytest.approx(loop, rel=0.02)


@pytest.mark.parametrize("angle", [0.0, 30.0, 60.0, 90.0])
def test_a_strip_with_fibres_at_an_angle_shears_and_carries_along_x_only(angle: float) -> None:
    """Only the Cauchy stress along x is not zero; at 0 and 90 degrees it has the closed form."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    fibres = tisim.HolzapfelGasserOgden(direction=(c, s, 0.0), k1=5e3, k2=0.5)
    material = replace(MATRIX, fibres=fibres)
    found = tisim.simulate(tisim.Coupon(material=material, stretches=(1.1, 1.4)))
    assert found.ok
    F = np.array([np.linalg.lstsq(found.mesh.nodes, x)[0].T for x in found.positions])
    P = parts.respond(material, [0.0, 0.0], F).stress[:, 0]
    cauchy = P @ F.transpose(0, 2, 1) / np.linalg.det(F)[:, None, None]
    along = cauchy[:, 0, 0].copy()
    cauchy[:, 0, 0] = 0.0
    assert np.abs(cauchy).max() < 1e-4 * along.max()
    assert found.nominal_stress == pytest.approx(P[:, 0, 0], rel=1e-4)
    if angle in (30.0, 60.0):
        assert (F[:, 0, 1] != 0.0).all()
        return
    l = found.load
    I4 = l**2 if angle == 0.0 else 1.0 / l  # at 90 degrees the fibres are slack
    e = np.maximum(I4 - 1.0, 0.0)
    matrix = tisim.simulate(tisim.Coupon(material=MATRIX, stretches=(1.1, 1.4))).nominal_stress
    assert found.nominal_stress == pytest.approx(
        matrix + 2.0 * fibres.k1 * e * np.exp(fibres.k2 * e**2) * l, rel=3e-3
    )


def test_a_softened_coupon_needs_no_course() -> None:
    """The order of the stretches is a path: unloading is softer, further loading follows the law."""
    path = (1.2, 1.4, 1.2, 1.5)
    soft = tisim.simulate(tisim.Coupon(material=replace(SOFT, softening=MULLINS), stretches=path))
    law = tisim.simulate(tisim.Coupon(material=SOFT, stretches=path))
    ratio = soft.nominal_stress / law.nominal_stress
    assert ratio[[0, 1, 3]] == pytest.approx(1.0, abs=1e-6)
    assert ratio[2] < 0.9
    assert soft.time is None


@pytest.mark.parametrize("platens", ["free", "bonded"])
def test_a_cylinder_follows_a_course(platens: str) -> None:
    course = tisim.Course(start=1.0).ramp(to=0.85, speed=0.1).hold(5.0).ramp(to=0.95, speed=0.1)
    scene = tisim.Press(
        material=replace(VISCOUS, softening=MULLINS), radius=0.01, height=0.012, refinement=0.5,
        platens=platens, side="stop", course=course,
    )  # fmt: skip
    found = tisim.simulate(scene)
    assert found.ok
    assert (np.diff(found.dissipated, prepend=0.0) > 0.0).all()
    if platens == "free":  # homogeneous, as a coupon, up to where the coupon would be pulled
        coupon = tisim.simulate(tisim.Coupon(material=scene.material, course=course))
        pressed = coupon.nominal_stress < 0.0
        assert np.flatnonzero(~pressed).tolist() == [len(pressed) - 1]
        assert found.nominal_stress[pressed] == pytest.approx(coupon.nominal_stress[pressed], rel=1e-5)
        assert found.nominal_stress[-1] == pytest.approx(0.0, abs=1e-3)
        volume = np.pi * 0.01**2 * 0.012
        lost = coupon.dissipated / 0.01**3 * volume
        assert found.dissipated[pressed] == pytest.approx(lost[pressed], rel=2e-2)


@pytest.mark.parametrize("law", ["neo-hookean", "ogden"])
def test_creep_of_a_cantilever_by_correspondence(law: str) -> None:
    """At small strain and constant nu: elastic deflection times creep function."""
    times = (0.0, 0.5, 2.0, 10.0, 60.0)
    elastic = tisim.material_from_moduli(law, shear_modulus=1e6, bulk_modulus=1e9)
    beam = tisim.Beam(material=elastic, length=0.05)
    hang = tisim.Course(frames=times, growth=0.35).jump(1.0).hold(60.0)
    found = tisim.simulate(replace(beam, material=replace(elastic, viscosity=PRONY), course=hang))
    wanted = sag(tisim.simulate(beam)) * creep(np.array(times))
    # the pointwise part of the elements' bulk modulus does not relax: 0.2 % at t = 0
    assert sag(found) == pytest.approx(wanted, rel=3e-3)
    assert sag(found)[-1] == pytest.approx(wanted[-1], rel=3e-4)
    assert found.time == pytest.approx(times)
    assert (np.diff(found.dissipated) > 0.0).all()


def test_a_beams_time_steps_are_of_second_order() -> None:
    beam = tisim.Beam(material=VISCOUS, length=0.06, solver=tisim.Solver(tolerance=1e-9), **SMALL)
    ends = []
    for growth in (0.8, 0.4, 0.2, 0.05):
        course = tisim.Course(frames=(3.0,), growth=growth).ramp(to=1.0, duration=1.0).hold(2.0)
        ends.append(sag(tisim.simulate(replace(beam, course=course)))[-1])
    errors = np.abs(np.array(ends[:-1]) - ends[-1])
    assert errors[0] < 1e-3 * ends[-1]
    assert errors[2] < errors[0] / 6.0


def test_beams_of_a_chain_and_workers_agree_with_beams_alone() -> None:
    course = tisim.Course(frames=(1.0, 10.0)).jump(1.0).hold(10.0)
    scenes = []
    for size in (1.0, 1.03, 0.8, 1.3):
        p = {k: size * float(v) for k, v in SOFT.parameters.items()}
        scenes.append(
            tisim.Beam(material=replace(VISCOUS, parameters=p), length=0.06, course=course, **SMALL)
        )
    together = tisim.simulate(scenes, workers=1)
    # a similar beam starts from its neighbour's states and factor
    assert together[1].cost.factorisations < together[0].cost.factorisations
    for scene, result in zip(scenes, together, strict=True):
        alone = tisim.simulate(scene)
        assert np.abs(alone.positions - result.positions).max() < 1e-5 * np.abs(sag(alone)).max()
    for here, there in zip(together, tisim.simulate(scenes, workers=2), strict=True):
        assert np.array_equal(here.positions, there.positions)


def test_a_beam_loaded_and_unloaded_comes_back() -> None:
    course = (
        tisim.Course(frames=(1.0, 2.0, 400.0))
        .ramp(to=1.0, duration=1.0)
        .ramp(to=0.0, duration=1.0)
        .hold(398.0)
    )
    found = sag(tisim.simulate(tisim.Beam(material=VISCOUS, length=0.05, course=course, **SMALL)))
    assert found[1] > 0.02 * found[0]
    assert abs(found[2]) < 1e-4 * found[0]


def test_an_imperfect_beam_creeps_from_its_own_shape() -> None:
    course = tisim.Course(frames=(0.0, 30.0)).jump(1.0).hold(30.0)
    crooked = tisim.Beam(
        material=VISCOUS, length=0.05, imperfections=tisim.Imperfections(curvature=1.0, skin=0.2), **SMALL
    )
    found = sag(tisim.simulate(replace(crooked, course=course)))
    more = PRONY.spectrum().instantaneous
    instant = tisim.material_from_moduli("neo-hookean", shear_modulus=more * G, bulk_modulus=20 * G)
    assert found[0] == pytest.approx(sag(tisim.simulate(replace(crooked, material=instant)))[0], rel=0.02)
    assert found[1] > 1.2 * found[0]


@pytest.mark.parametrize("supports", ["clamped-free", "clamped-clamped"])
def test_clamps_that_yield_turn_as_the_beam_creeps(supports: str) -> None:
    """Initially the instantaneous material's solution, finally the long-time one's, with compliant clamps."""
    clamps = tisim.ClampImperfections(compliance=4.0 if supports == "clamped-free" else 20.0)
    hang = tisim.Course(frames=(0.0, 5.0, 600.0)).jump(1.0).hold(600.0)
    soft = tisim.Beam(
        material=VISCOUS, length=0.06, supports=supports, clamp_imperfections=clamps, course=hang, **SMALL
    )
    found = tisim.simulate(soft)
    assert found.ok, found.message
    more = PRONY.spectrum().instantaneous
    instant = tisim.material_from_moduli("neo-hookean", shear_modulus=more * G, bulk_modulus=20 * G)
    static = [tisim.simulate(replace(soft, material=m, course=None)).positions[0] for m in (instant, SOFT)]
    size = np.abs(static[1] - found.mesh.nodes).max()
    stiff = tisim.simulate(
        replace(soft, material=SOFT, course=None, clamp_imperfections=tisim.ClampImperfections())
    )
    assert np.abs(stiff.positions[0] - static[1]).max() > 0.1 * size
    assert np.abs(found.positions[2] - static[1]).max() < 2e-3 * size
    assert np.abs(found.positions[0] - static[0]).max() < 0.02 * size
    turn = found.positions[:, found.mesh.node_sets["clamp"]] - found.mesh.nodes[found.mesh.node_sets["clamp"]]
    moved = np.linalg.norm(turn, axis=2).max(axis=1)
    assert (moved > 0.0).all()


def test_a_released_viscous_beam_loses_what_its_material_says() -> None:
    """The log decrement of a light beam is pi tan delta of its material at its frequency."""
    weak = tisim.Prony(fractions=(0.05,), times=(0.02,))
    elastic = tisim.material_from_moduli("neo-hookean", shear_modulus=1e5, bulk_modulus=1e7)
    solver = tisim.Solver(method="implicit", duration=0.35, time_step=1.6e-3)
    beam = tisim.Beam(
        material=replace(elastic, viscosity=weak), length=0.06, solver=solver, gravity=(0, 0, -1.0), **SMALL
    )
    viscous, plain = tisim.simulate(beam), tisim.simulate(replace(beam, material=elastic))

    def decrement(result: tisim.Result) -> tuple[float, float]:
        z = sag(result)
        turns = np.flatnonzero((z[1:-1] - z[:-2]) * (z[2:] - z[1:-1]) < 0.0) + 1
        swing = np.abs(np.diff(z[turns]))
        # after the equilibrium position of the oscillation has crept to its limit
        decay = np.log(swing[2] / swing[6]) / 2.0
        return float(decay), float((result.time[turns[6]] - result.time[turns[2]]) / 2.0)

    loss, period = decrement(viscous)
    numerical, _ = decrement(plain)
    w = 2 * np.pi / period * 0.02
    tangent = 0.05 * w / (1 + w**2) / (1.0 + 0.05 * w**2 / (1 + w**2))
    assert loss - numerical == pytest.approx(np.pi * tangent, rel=0.06)
    assert viscous.dissipated is not None
    assert (np.diff(viscous.dissipated) >= 0.0).all()
    assert plain.dissipated is None


POKE = tisim.Poke(
    material=VISCOUS,
    refinement=0.5,
    course=tisim.Course(frames=(1.0, 1.5, 3.0, 11.0, 12.0))
    .ramp(to=2e-3, speed=2e-3)
    .hold(10.0)
    .ramp(to=1e-3, speed=1e-3),
)


def force(result: tisim.Result) -> np.ndarray:
    assert result.ok, result.message
    return np.linalg.norm(result.rod_force, axis=1)


def test_a_poke_relaxes_in_a_hold_and_comes_back_softer() -> None:
    found = tisim.simulate(POKE)
    f = force(found)
    assert found.time == pytest.approx((1.0, 1.5, 3.0, 11.0, 12.0))
    assert found.load == pytest.approx((2e-3, 2e-3, 2e-3, 2e-3, 1e-3))
    assert (np.diff(f) < 0.0).all()
    # above the force of the long-time material, below that of the instantaneous one
    elastic = force(
        tisim.simulate(tisim.Poke(material=SOFT, depth=2e-3, refinement=0.5, frame_spacing=2e-3))
    )[0]
    assert elastic < f[3] < f[0] < 1.5 * elastic
    # fading history: remaining relaxation at 11 s for a load that grew within the first second
    left = 0.2 * np.exp(-10.5 / 20.0)
    assert f[3] / elastic - 1.0 == pytest.approx(left, rel=0.1)
    assert (np.diff(found.dissipated) > 0.0).all()


def test_a_slow_poke_is_the_long_time_materials_and_a_quick_one_the_instantaneous_ones() -> None:
    depth = 1.5e-3
    slow, quick = (
        force(tisim.simulate(replace(POKE, course=tisim.Course(frames=(t,)).ramp(to=depth, duration=t))))[0]
        for t in (1e6, 1e-4)
    )
    elastic = force(
        tisim.simulate(tisim.Poke(material=SOFT, depth=depth, refinement=0.5, frame_spacing=depth))
    )[0]
    assert slow == pytest.approx(elastic, rel=0.01)
    # the bulk modulus does not relax
    assert 1.3 * elastic < quick < 1.5 * elastic


def test_a_softened_poke_comes_back_softer_without_a_clock() -> None:
    way = {"depth": 2e-3, "retract_to": 1e-3, "refinement": 0.5, "friction": 0.0}
    law = tisim.simulate(tisim.Poke(material=SOFT, **way))
    soft = tisim.simulate(tisim.Poke(material=replace(SOFT, softening=MULLINS), **way))
    assert force(soft)[0] == pytest.approx(force(law)[0], rel=0.02)
    assert force(soft)[-1] < 0.9 * force(law)[-1]
    assert soft.dissipated is not None
    assert soft.time is None


def test_a_sphere_on_a_viscous_half_space_in_loading() -> None:
    """Lee and Radok, J. Appl. Mech. 27, 1960: F(t) is the convolution of G(t) and the elastic force at G = 1.

    The elastic force is that of the simulated block instead of Hertz's, so that the block's size cancels.
    """
    elastic = tisim.material_from_moduli("neo-hookean", shear_modulus=G, bulk_modulus=100 * G)
    ball = tisim.Rod(radius=5e-3, tip="hemisphere")
    depth, end = 0.8e-3, 4.0
    times = (1.0, 2.0, 4.0)
    push = tisim.Course(frames=times, growth=0.4).ramp(to=depth, duration=end)
    scene = tisim.Poke(
        material=replace(elastic, viscosity=PRONY), rod=ball, friction=0.0, course=push, refinement=0.8
    )
    found = force(tisim.simulate(scene))
    law = force(tisim.simulate(replace(scene, material=elastic)))
    # Hertz at constant speed: kernel (3/2) s^(1/2) / t^(3/2) ds
    s = np.linspace(0.0, 1.0, 4001)[1:] - 0.5 / 4000
    wanted = [np.mean(relaxation(t - s * t) * 1.5 * np.sqrt(s)) for t in times]
    assert found / law == pytest.approx(wanted, rel=0.01)
    hertz = 16.0 / 3.0 * G * np.sqrt(5e-3) * (np.array(times) / end * depth) ** 1.5
    assert law == pytest.approx(hertz, rel=0.12)
