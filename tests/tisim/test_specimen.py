"""Imperfect specimens against beam theory: curvature, taper, gradients, skins and voids."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from static_cases import deflection, neo_hookean

import tisim
from tisim.bodies import Circle, Rectangle
from tisim.problems.beam.imperfect import clamp_moments, imperfect_system
from tisim.problems.beam.solve import solve_beam
from tisim.problems.beam.system import beam_discretisation
from tisim.scene import Beam, Imperfections, Void

MU, RATIO, DENSITY, G = 2e6, 200.0, 1000.0, 9.81
YOUNG = 9 * RATIO / (3 * RATIO + 1) * MU
RADIUS, LENGTH = 0.004, 0.1
STIFF = neo_hookean(MU, RATIO)  # sags by 0.1 mm: small strains
NONE = (0.0, 0.0, 0.0)


def slender(**kw):
    kw = {
        "length": LENGTH,
        "section": Circle(radius=RADIUS),
        "radial_elements": 1,
        "axial_element_size": 0.005,
    } | kw
    return Beam(material=STIFF, **kw)


def sag(**kw):
    return -deflection(solve_beam(slender(**kw)))[2]


def strain(**kw):
    """Axial strain in the middle of a beam in tension, away from the face with a uniform traction."""
    result = solve_beam(slender(gravity=NONE, tip_force=(0.01, 0.0, 0.0), **kw))
    middle = np.abs(result.mesh.nodes[:, 0] - LENGTH / 2) < LENGTH / 4
    return np.polyfit(result.mesh.nodes[middle, 0], result.positions[0][middle, 0], 1)[0] - 1.0


def tip_sag(stiffness, weight):
    """Tip deflection of an Euler-Bernoulli cantilever with relative EI(x) and q(x)."""
    x = np.linspace(0.0, LENGTH, 4001)
    beyond = cumulative_trapezoid(weight(x)[::-1], x, initial=0.0)[::-1]
    moment = cumulative_trapezoid(beyond[::-1], x, initial=0.0)[::-1]
    return np.trapezoid(moment * (LENGTH - x) / stiffness(x), x)


def one(x):
    return np.ones_like(x)


def ramp(slope, power=1):
    return lambda x: (1.0 + slope * (x - LENGTH / 2)) ** power


@pytest.mark.parametrize(
    ("specimen", "stiffness", "weight"),
    [
        (Imperfections(taper=2.0), ramp(2.0, 4), ramp(2.0, 2)),
        (Imperfections(taper=-0.5), ramp(-0.5, 4), ramp(-0.5, 2)),
        (Imperfections(axial_gradient=5.0), ramp(5.0), one),
        (Imperfections(axial_gradient=-3.0), ramp(-3.0), one),
        (Imperfections(density_gradient=5.0), one, ramp(5.0)),
    ],
)
def test_taper_and_gradients_change_the_sag_as_beam_theory_says(specimen, stiffness, weight):
    ratio = tip_sag(stiffness, weight) / tip_sag(one, one)
    assert abs(ratio - 1.0) > 0.02
    assert sag(imperfections=specimen) / sag() == pytest.approx(ratio, rel=0.01)


@pytest.mark.parametrize(("edge", "layer"), [(0.003, 0.0025), (0.015, 0.005)])
def test_void_is_a_drop_of_stiffness_and_weight_over_its_length(edge, layer):
    void = Void(position=0.02, length=0.015, edge=edge, fraction=0.6)

    def left(x):
        out = np.clip((np.abs(x - void.position) - 0.5 * (0.015 - edge)) / edge, 0.0, 1.0)
        return 1 - 0.6 * np.cos(0.5 * np.pi * out) ** 2

    ratio = tip_sag(left, left) / tip_sag(one, one)
    assert ratio > 1.1
    result = solve_beam(slender(imperfections=Imperfections(void=void), axial_element_size=layer))
    assert -deflection(result)[2] / sag(axial_element_size=layer) == pytest.approx(ratio, rel=0.01)
    lost = 0.6 * 0.015 / LENGTH  # fraction times length
    weight = DENSITY * G * np.pi * RADIUS**2 * LENGTH
    ideal = solve_beam(slender(axial_element_size=layer)).support_force[0, 2]
    assert ideal - result.support_force[0, 2] == pytest.approx(lost * weight, rel=0.02)


def test_weight_is_that_of_the_tapered_body():
    taper = 4.0
    found = solve_beam(slender(imperfections=Imperfections(taper=taper))).support_force[0, 2]
    more = 1.0 + (taper * LENGTH) ** 2 / 12.0  # mean of (1 + taper x)^2 about the middle
    assert found / solve_beam(slender()).support_force[0, 2] == pytest.approx(more, rel=1e-4)


@pytest.mark.parametrize(
    ("section", "rings", "element"),
    [
        (Circle(radius=RADIUS), 1, "default"),
        (Circle(radius=RADIUS), 2, "default"),
        (Rectangle(width=0.008, height=0.006), 1, "default"),
        (Rectangle(width=0.008, height=0.006), 3, "hex8"),
    ],
)
def test_skin_adds_its_stiffness_in_bending_and_in_stretching(section, rings, element):
    depth, excess = 0.0005, 0.6
    specimen = Imperfections(skin=excess, skin_thickness=depth)
    shape = {"section": section, "radial_elements": rings, "element": element}
    if isinstance(section, Circle):
        core = 1 - depth / RADIUS
        area, inertia = 1 - core**2, 1 - core**4
    else:
        area = 1 - 0.007 * 0.005 / (0.008 * 0.006)
        inertia = 1 - 0.007 * 0.005**3 / (0.008 * 0.006**3)
    bent = sag(**shape) / sag(**shape, imperfections=specimen)
    assert bent == pytest.approx(1 + excess * inertia, rel=0.01)
    assert strain(**shape) / strain(**shape, imperfections=specimen) == pytest.approx(
        1 + excess * area, rel=0.01
    )


def test_transverse_gradient_bends_a_pulled_beam_and_softens_it():
    gradient, pull = 60.0, 0.01
    result = solve_beam(
        slender(
            gravity=NONE,
            tip_force=(pull, 0.0, 0.0),
            imperfections=Imperfections(transverse_gradient=gradient),
        )
    )
    # E (1 + g z): no moment about the centre line if the curvature is g times the strain; the stiff side is
    # up
    strain = pull / (YOUNG * np.pi * RADIUS**2)
    assert deflection(result)[2] == pytest.approx(gradient * strain * LENGTH**2 / 2, rel=0.05)
    thick = {"section": Circle(radius=0.008), "imperfections": Imperfections(transverse_gradient=gradient)}
    softer = 1 / (1 - gradient**2 * 0.008**2 / 4)  # the neutral axis shifts by g I / A
    assert sag(**thick) / sag(section=Circle(radius=0.008)) == pytest.approx(softer, rel=0.01)


@pytest.mark.parametrize("curvature", [2.0, -5.0])
def test_curved_cantilever_without_load_is_its_arc(curvature):
    scene = slender(gravity=NONE, imperfections=Imperfections(curvature=curvature))
    result = solve_beam(scene)
    assert result.ok
    centre = tisim.mesh.outline(result.mesh, result.positions[0])
    assert centre.x[-1] == LENGTH
    arc = np.column_stack([np.sin(curvature * centre.x), 1 - np.cos(curvature * centre.x)]) / curvature
    assert np.abs(centre.centreline - arc).max() < 1e-9
    assert np.abs(result.positions[0] - tisim.rest_positions(scene, result.mesh)).max() < 1e-9
    assert np.abs(result.support_force).max() < 1e-6


def test_straightened_arc_carries_bending_stiffness_times_curvature():
    scene = slender(
        length=0.15,
        supports="clamped-clamped",
        gravity=NONE,
        imperfections=Imperfections(curvature=1.0),
    )
    result = solve_beam(scene)
    discretisation = beam_discretisation(scene)
    found = clamp_moments(scene, discretisation, imperfect_system(scene, discretisation), result.positions[0])
    wanted = YOUNG * np.pi * RADIUS**4 / 4 * 1.0
    # its stress-free shape bends upwards: straight, it would turn the near clamp down and the far one up
    assert found == pytest.approx([-wanted, wanted], rel=0.02)
    assert np.abs(result.positions[0] - result.mesh.nodes).max() < 1e-4


def test_nothing_wrong_is_the_ideal_beam_to_the_last_bit():
    nothing = Imperfections(skin_thickness=0.002, void=Void(position=0.01, fraction=0.0))
    ideal, same = solve_beam(slender()), solve_beam(slender(imperfections=nothing))
    assert np.array_equal(ideal.positions, same.positions)
    assert np.array_equal(ideal.support_force, same.support_force)


@pytest.mark.parametrize(("supports", "length"), [("clamped-free", 0.1), ("clamped-clamped", 0.15)])
def test_next_to_nothing_is_the_ideal_beam_nearly(supports, length):
    kw = {"material": neo_hookean(1.5e4, 50.0), "length": length, "supports": supports, "radial_elements": 1}
    little = Imperfections(
        curvature=1e-8,
        taper=1e-8,
        axial_gradient=1e-8,
        density_gradient=1e-8,
        transverse_gradient=1e-8,
        skin=1e-8,
        void=Void(position=0.03, fraction=1e-8),
    )
    ideal, near = solve_beam(Beam(**kw)), solve_beam(Beam(**kw, imperfections=little))
    assert not np.array_equal(ideal.positions, near.positions)
    assert np.abs(ideal.positions - near.positions).max() < 1e-6 * np.abs(deflection(ideal)).max()
    assert near.mesh is ideal.mesh


def test_ideal_rest_positions_are_the_meshs_nodes():
    mesh = solve_beam(slender()).mesh
    assert np.array_equal(tisim.rest_positions(slender(), mesh), mesh.nodes)


@pytest.mark.parametrize(
    ("specimen", "message"),
    [
        (Imperfections(curvature=31.0), r"imperfections.curvature: expected a number between -30 and 30 /m"),
        (Imperfections(taper=np.nan), "imperfections.taper: expected a number between"),
        (
            Imperfections(axial_gradient=20.0),
            "imperfections.axial_gradient: expected a number between -19 and 19",
        ),
        (Imperfections(density_gradient=-20.0), "imperfections.density_gradient: expected a number between"),
        (
            Imperfections(transverse_gradient=300.0),
            "imperfections.transverse_gradient: expected a number between",
        ),
        (
            Imperfections(skin=0.1, skin_thickness=0.005),
            "imperfections.skin_thickness: expected a length above 0",
        ),
        (Imperfections(skin=-1.0), "imperfections.skin: expected a number not below -0.95"),
        (Imperfections(skin=20.0), "imperfections.skin: expected a skin whose stiffness"),
        (Imperfections(void=Void(position=0.2, fraction=0.1)), "void.position: expected a place on the beam"),
        (
            Imperfections(void=Void(position=0.05, fraction=0.96)),
            "void.fraction: expected a part between 0 and 0.95",
        ),
        (Imperfections(void=Void(position=0.05, fraction=0.1, length=0.0)), "void.length: expected a length"),
        (
            Imperfections(void=Void(position=0.05, fraction=0.1, edge=0.02)),
            "void.edge: expected a length above 0",
        ),
        (None, "imperfections: expected Imperfections"),
    ],
)
def test_specimens_that_cannot_be_are_refused_in_one_sentence(specimen, message):
    with pytest.raises(ValueError, match=f"scene 0: Beam.*{message}") as caught:
        tisim.simulate([slender(imperfections=specimen)], workers=1)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_dynamics_refuses_what_it_does_not_know(method):
    scene = slender(imperfections=Imperfections(curvature=1.0), solver=tisim.Solver(method=method))
    with pytest.raises(ValueError, match=r"solver.method: expected static, the only one offered where"):
        tisim.simulate([scene], workers=1)
