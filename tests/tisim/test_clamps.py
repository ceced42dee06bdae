"""Imperfect clamps against rotated models, statics and beam theory; robustness of their solution."""

from dataclasses import replace

import numpy as np
import pytest
from static_cases import deflection, neo_hookean

import tisim
from tisim.bodies import Circle
from tisim.material import Material
from tisim.parallel.chunks import make_chunks
from tisim.problems.beam import imperfect
from tisim.problems.beam.imperfect import clamp_moments, imperfect_system
from tisim.problems.beam.solve import solve_beam
from tisim.problems.beam.system import beam_discretisation
from tisim.result import Status
from tisim.scene import Beam, ClampImperfections, Imperfections, Solver, Void

G, DENSITY = 9.81, 1000.0
SOFT = neo_hookean(1.5e4, 50.0)
MU, RATIO = 2e6, 200.0
STIFF = neo_hookean(MU, RATIO)  # sags by 0.1 to 0.2 mm: small strains
YOUNG = 9 * RATIO / (3 * RATIO + 1) * MU
RADIUS = 0.004
BENDING = YOUNG * np.pi * RADIUS**4 / 4
LINE = DENSITY * G * np.pi * RADIUS**2
BRIDGE = {"length": 0.15, "supports": "clamped-clamped"}


def soft(**kw):
    return Beam(**({"material": SOFT, "length": 0.1, "radial_elements": 1} | kw))


def slender(**kw):
    return Beam(
        **(
            {
                "material": STIFF,
                "length": 0.1,
                "section": Circle(radius=RADIUS),
                "radial_elements": 1,
                "axial_element_size": 0.005,
            }
            | kw
        )
    )


def turn(angle):
    """Rotation from x towards z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]])


def moments(result):
    scene = result.scene
    discretisation = beam_discretisation(scene)
    return clamp_moments(scene, discretisation, imperfect_system(scene, discretisation), result.positions[0])


def near_angle(result):
    """Angle of the near face from its nodes [rad]."""
    clamp = result.mesh.node_sets["clamp"]
    up = result.mesh.nodes[clamp, 2]
    return np.arctan2(-(result.positions[0][clamp, 0] @ up), result.positions[0][clamp, 2] @ up)


@pytest.mark.parametrize("angle", [0.1, -0.3])
def test_tilted_cantilever_is_a_cantilever_under_turned_gravity(angle):
    result = solve_beam(soft(clamp_imperfections=ClampImperfections(tilt=angle)))
    gravity = tuple(turn(-angle) @ [0.0, 0.0, -G])
    same = solve_beam(soft(gravity=gravity))
    assert result.ok
    assert np.abs(result.positions[0] - same.positions[0] @ turn(angle).T).max() < 1e-6 * 0.1
    assert result.support_force[0] == pytest.approx(turn(angle) @ same.support_force[0], rel=1e-5, abs=1e-6)
    assert near_angle(result) == pytest.approx(angle, rel=1e-9)


def test_bridge_with_both_clamps_turned_and_moved_alike_is_a_turned_bridge():
    angle = 0.08
    shift = (0.15 * (np.cos(angle) - 1), 0.15 * np.sin(angle))
    result = solve_beam(
        soft(**BRIDGE, clamp_imperfections=ClampImperfections(tilt=angle, far_tilt=angle, far_shift=shift))
    )
    same = solve_beam(soft(**BRIDGE, gravity=tuple(turn(-angle) @ [0.0, 0.0, -G])))
    assert result.ok
    assert np.abs(result.positions[0] - same.positions[0] @ turn(angle).T).max() < 1e-6 * 0.1


def test_shift_of_the_far_clamp_pulls_with_the_stretching_stiffness():
    scene = slender(
        **BRIDGE, gravity=(0.0, 0.0, 0.0), clamp_imperfections=ClampImperfections(far_shift=(5e-4, 0.0))
    )
    result = solve_beam(scene)
    assert result.ok
    assert np.abs(result.support_force).max() < 1e-6  # of both clamps together
    discretisation = beam_discretisation(scene)
    body = imperfect_system(scene, discretisation).body
    near = body.internal_forces(result.positions[0])[0][result.mesh.node_sets["clamp"]].sum(axis=0)
    pull = YOUNG * np.pi * RADIUS**2 * 5e-4 / 0.15
    # ends that cannot contract are stiffer, over a length of about one radius
    assert discretisation.multiplicity * near[0] == pytest.approx(-pull, rel=0.02)


def test_shift_across_bends_both_ends():
    scene = slender(
        **BRIDGE, gravity=(0.0, 0.0, 0.0), clamp_imperfections=ClampImperfections(far_shift=(0.0, 1e-3))
    )
    moment = 6 * BENDING * 1e-3 / 0.15**2
    # the far end is lifted: the rod would lift the near clamp's side and rotate the far one as much
    assert moments(solve_beam(scene)) == pytest.approx([moment, moment], rel=0.02)


def test_turned_clamp_carries_four_and_two_of_the_bending_stiffness():
    scene = slender(**BRIDGE, gravity=(0.0, 0.0, 0.0), clamp_imperfections=ClampImperfections(tilt=0.01))
    unit = BENDING / 0.15 * 0.01
    assert moments(solve_beam(scene)) == pytest.approx([-4 * unit, -2 * unit], rel=0.03)


def test_yielding_clamp_of_a_cantilever_turns_by_compliance_times_the_weights_moment():
    result = solve_beam(soft(clamp_imperfections=ClampImperfections(compliance=8.0, tilt=0.05)))
    assert result.ok
    # statics: weight of every node at its deformed position; the fixed nodes lie nearly at x = 0
    discretisation = beam_discretisation(result.scene)
    weight = DENSITY * G * discretisation.nodal_volume() * discretisation.multiplicity
    moment = weight @ result.positions[0][:, 0]
    assert near_angle(result) - 0.05 == pytest.approx(-8.0 * moment, rel=1e-3)
    tilted = solve_beam(soft(clamp_imperfections=ClampImperfections(tilt=near_angle(result))))
    assert np.abs(tilted.positions - result.positions).max() < 1e-6 * 0.1
    assert result.support_force[0] == pytest.approx([0, 0, weight.sum()], rel=1e-5, abs=1e-6)


def test_yielding_clamps_of_a_bridge_as_beam_theory_has_them():
    """Rotational springs at the ends: M = q L^2/12 / (1 + 2 EI c/L), sag (5 - 4 M/M0) q L^4/384 EI.

    The load is a tenth of gravity: a sag of the order of the section's size would add tension.
    """
    little = BRIDGE | {"gravity": (0.0, 0.0, -G / 10)}
    compliance = 0.15 / (2 * BENDING)
    ideal = solve_beam(slender(**little))
    result = solve_beam(slender(**little, clamp_imperfections=ClampImperfections(compliance=compliance)))
    moment = LINE / 10 * 0.15**2 / 24
    assert moments(result) == pytest.approx([-moment, moment], rel=0.02)
    assert near_angle(result) == pytest.approx(-compliance * moment, rel=0.02)
    assert deflection(result)[2] / deflection(ideal)[2] == pytest.approx(3.0, rel=0.03)


@pytest.mark.parametrize("compliance", [1.0, 10.0, 300.0])
def test_both_clamps_angles_are_what_their_moments_make_them(compliance):
    clamps = ClampImperfections(compliance=compliance, tilt=0.03, far_tilt=-0.05, far_shift=(0.001, 0.002))
    result = solve_beam(soft(**BRIDGE, clamp_imperfections=clamps))
    assert result.ok
    near, far = moments(result)
    assert near_angle(result) - 0.03 == pytest.approx(compliance * near, rel=2e-4)
    at = result.mesh.node_sets["far_clamp"]
    middle = np.array([0.151, 0.0, 0.002])
    held = (result.positions[0][at] - middle) @ turn(-0.05 + compliance * far)
    assert np.abs(held - (result.mesh.nodes[at] - [0.15, 0, 0])).max() < 1e-6


def test_squeezed_sections_keep_their_area():
    result = solve_beam(soft(**BRIDGE, clamp_imperfections=ClampImperfections(squeeze=0.1)))
    rest, found = result.mesh.nodes, result.positions[0]
    for name in ("clamp", "far_clamp"):
        at = result.mesh.node_sets[name]
        assert found[at, 2] == pytest.approx(0.9 * rest[at, 2], abs=1e-15)
        assert found[at, 1] == pytest.approx(rest[at, 1] / 0.9, abs=1e-15)
    middle = np.abs(rest[:, 0] - 0.075) < 0.012
    size = np.ptp(found[middle, 1]) / np.ptp(rest[middle, 1])
    assert size == pytest.approx(1.0, abs=0.02)  # the effect decays within a short length
    ideal = solve_beam(soft(**BRIDGE))
    assert result.support_force == pytest.approx(ideal.support_force, rel=1e-5, abs=1e-6)
    assert deflection(result)[2] < deflection(ideal)[2]  # its ends are less high and so bend more easily


def test_clamps_hold_the_tapered_section():
    result = solve_beam(
        soft(imperfections=Imperfections(taper=1.0), clamp_imperfections=ClampImperfections(tilt=0.1))
    )
    at = result.mesh.node_sets["clamp"]
    assert result.positions[0][at] == pytest.approx(0.95 * result.mesh.nodes[at] @ turn(0.1).T, abs=1e-15)


WORST = Imperfections(
    curvature=2.0,
    taper=0.5,
    axial_gradient=3.0,
    density_gradient=1.0,
    transverse_gradient=40.0,
    skin=0.5,
    void=Void(position=0.03, fraction=0.6),
)


def corners(n):
    """Beams with imperfections of the largest size and either sign, and with compliant clamps."""
    rng = np.random.default_rng(7)
    for i in range(n):
        length, supports = [(0.05, "clamped-free"), (0.1, "clamped-free"), (0.15, "clamped-clamped")][i % 3]
        sign = rng.choice([-1.0, 1.0], 9)
        far = i % 3 == 2
        yield soft(
            material=Material(
                law="yeoh",
                parameters={
                    "mu": (8e3, 4e4)[i // 3 % 2],
                    "stiffening": (0.0, 1.5)[i // 6 % 2],
                    "bulk": (20, 1000)[i % 2] * 2e4,
                },
            ),
            length=length,
            supports=supports,
            imperfections=replace(
                WORST,
                curvature=2.0 * sign[0],
                taper=0.5 * sign[1],
                axial_gradient=3.0 * sign[2],
                transverse_gradient=40.0 * sign[3],
            ),
            clamp_imperfections=ClampImperfections(
                tilt=0.07 * sign[4],
                far_tilt=0.07 * sign[5] * far,
                far_shift=(0.002 * sign[6] * far, 0.002 * sign[7] * far),
                compliance=10.0,
                squeeze=0.1,
            ),
        )


def test_strong_imperfections_converge_at_once():
    scenes = list(corners(24))
    alone = [solve_beam(scene) for scene in scenes]
    assert [r.status for r in alone] == [Status.CONVERGED] * 24
    assert [r.cost.steps for r in alone] == [1] * 24
    assert max(r.cost.newton_iterations for r in alone) <= 15
    assert all(r.residual[0] <= 1e-6 and r.min_jacobian[0] > 0.0 for r in alone)
    # in a batch they start from each other's solutions, among ideal beams; each result must not depend on it
    ideal = [
        replace(scene, imperfections=Imperfections(), clamp_imperfections=ClampImperfections())
        for scene in scenes[:6]
    ]
    together = tisim.simulate([*scenes, *ideal], workers=1)
    for one, found in zip([*alone, *map(solve_beam, ideal)], together, strict=True):
        assert found.ok
        assert found.cost.steps == 1
        # clamp angles are resolved to 1e-4 of their values
        assert np.abs(found.positions - one.positions).max() < 2e-6


def test_growing_imperfections_give_the_same_answer(monkeypatch):
    """Without the rod as initial guess, imperfections grow in steps from the ideal beam's solution."""
    scenes = list(corners(3))
    quick = [solve_beam(scene) for scene in scenes]
    monkeypatch.setattr(imperfect, "solve_rod", lambda *_: None)
    for scene, known in zip(scenes, quick, strict=True):
        slow = solve_beam(scene)
        assert slow.ok
        assert slow.cost.steps > 1
        assert slow.cost.newton_iterations > known.cost.newton_iterations
        assert np.abs(slow.positions - known.positions).max() < 2e-6


def test_start_that_fails_does_not_spoil_the_next(monkeypatch):
    """Clamp angles from a neighbour's failed start are not used for the start from the rod's shape."""
    # the compliance is so small that angles in error by the rod's error would pass as converged
    first, second = (
        soft(clamp_imperfections=ClampImperfections(compliance=0.2)),
        soft(clamp_imperfections=ClampImperfections(compliance=0.05, tilt=0.02)),
    )
    alone = solve_beam(second)
    discretisation = beam_discretisation(first)
    neighbour = imperfect.imperfect_equilibrium(first, discretisation).neighbour
    assert neighbour is not None
    newton, calls = imperfect.mixed_newton, []

    def failing(*arguments):
        calls.append(1)
        outcome = newton(*arguments)
        return replace(outcome, status=Status.NOT_CONVERGED) if len(calls) == 2 else outcome

    monkeypatch.setattr(imperfect, "mixed_newton", failing)
    found = imperfect.imperfect_equilibrium(second, discretisation, neighbour)
    assert found.outcome.status is Status.CONVERGED
    assert found.counts["steps"] == 1
    assert len(calls) > 3
    assert np.abs(found.outcome.x - alone.positions[0]).max() < 1e-8


def test_imperfect_beams_share_the_ideal_ones_mesh():
    scenes = [
        soft(),
        soft(clamp_imperfections=ClampImperfections(tilt=0.1)),
        soft(imperfections=Imperfections(taper=0.5)),
    ]
    assert [chunk.indices for chunk in make_chunks(scenes)] == [(0, 1, 2)]
    ideal, *others = tisim.simulate(scenes, workers=1)
    assert all(other.mesh is ideal.mesh for other in others)


def test_no_answer_is_said():
    """A bridge a third shorter than its beam, squeezed to half, with few iterations."""
    clamps = ClampImperfections(far_shift=(-0.07, 0.0), squeeze=0.5, far_tilt=-0.8, tilt=-0.8)
    result = solve_beam(soft(**BRIDGE, clamp_imperfections=clamps, solver=Solver(max_iterations=3)))
    assert result.status is not Status.CONVERGED
    assert result.positions.shape[0] == 0
    assert "of the imperfections" in result.message


def test_load_across_the_mirror_plane():
    """With gravity along y the tilt rotates the ideal beam about the direction of its load."""
    scene = soft(gravity=(0.0, -G, 0.0))
    ideal = solve_beam(scene)
    tilted = solve_beam(replace(scene, clamp_imperfections=ClampImperfections(tilt=0.2)))
    assert tilted.ok
    assert tilted.cost.steps == 1
    assert np.abs(tilted.positions[0] - ideal.positions[0] @ turn(0.2).T).max() < 1e-6 * 0.1


@pytest.mark.parametrize(
    ("clamps", "message"),
    [
        (
            ClampImperfections(tilt=1.0),
            "clamp_imperfections.tilt: expected a number between -0.8 and 0.8 rad",
        ),
        (ClampImperfections(tilt=np.inf), "clamp_imperfections.tilt: expected a number"),
        (
            ClampImperfections(far_tilt=0.1),
            "clamp_imperfections.far_tilt: expected 0 on a beam without a far clamp",
        ),
        (
            ClampImperfections(far_shift=(0.0, 0.1)),
            "clamp_imperfections.far_shift: expected less than half the length",
        ),
        (
            ClampImperfections(far_shift=(0.0, 0.01)),
            "clamp_imperfections.far_shift: expected 0 on a beam without",
        ),
        (
            ClampImperfections(far_shift=(0.0, 0.0, 0.0)),
            "clamp_imperfections.far_shift: expected 2 finite numbers",
        ),
        (
            ClampImperfections(compliance=-1.0),
            r"clamp_imperfections.compliance: expected a compliance of 0 rad/\(N m\) or more",
        ),
        (ClampImperfections(squeeze=0.6), "clamp_imperfections.squeeze: expected a part between 0 and 0.5"),
        (None, "clamp_imperfections: expected ClampImperfections"),
    ],
)
def test_clamps_that_cannot_be_are_refused_in_one_sentence(clamps, message):
    with pytest.raises(ValueError, match=f"scene 0: Beam.{message}") as caught:
        tisim.simulate([soft(clamp_imperfections=clamps)], workers=1)
    assert "\n" not in str(caught.value)
