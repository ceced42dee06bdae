"""Dynamics of beams: static limit, frequencies, order, energy, damping, invariance, reported failures."""

from dataclasses import replace

import numpy as np
import pytest
from dynamic_cases import (
    DENSITY,
    MARCH,
    SHORT,
    SLENDER,
    SOFT,
    body_of,
    first_mode,
    free_body,
    swing,
    timoshenko_frequency,
    tip,
)

from tisim import Prony, paper_stop
from tisim.bodies import Circle, Rectangle
from tisim.discretisation.mass import consistent_mass, lumped_mass
from tisim.mesh.beam import beam_mesh
from tisim.problems.beam.solve import solve_beam
from tisim.problems.dynamics import explicit, implicit
from tisim.problems.dynamics.solve import solve_dynamic
from tisim.result import Status
from tisim.scene import Beam, Solver

METHODS = ["implicit", "explicit"]
REST = Solver(mass_damping=300.0, until_rest=True, duration=1.0)


# at rest


@pytest.mark.parametrize(("method", "tolerance"), [("implicit", 1e-4), ("explicit", 1e-3)])
@pytest.mark.parametrize("element", ["default", "tet4", "hex8"])
def test_comes_to_rest_where_the_static_method_does(method, tolerance, element):
    scene = replace(SHORT, element=element)
    static = solve_beam(scene)
    result = solve_dynamic(replace(scene, solver=replace(REST, method=method)))
    assert result.ok
    assert result.residual[-1] <= REST.tolerance
    assert result.load[-1] < 0.5  # it stopped at rest, not at the end of the duration
    expected = tip(static.mesh, static.positions[-1])[2]
    assert expected < -1e-4
    assert tip(result.mesh, result.positions[-1])[2] == pytest.approx(expected, rel=tolerance)
    np.testing.assert_allclose(result.support_force[-1], static.support_force[-1], atol=1e-5)


@pytest.mark.parametrize("method", ["implicit", pytest.param("explicit", marks=pytest.mark.slow)])
def test_stiffness_damping_alone_comes_to_the_same_rest(method):
    static = solve_beam(SHORT)
    solver = Solver(method=method, stiffness_damping=4e-3, until_rest=True, duration=0.5, tolerance=1e-3)
    result = solve_dynamic(replace(SHORT, solver=solver))
    assert result.ok
    error = np.abs(result.positions[-1] - static.positions[-1]).max()
    assert error < 1e-3 * abs(tip(static.mesh, static.positions[-1])[2])


@pytest.mark.slow
@pytest.mark.parametrize(("method", "tolerance"), [("implicit", 1e-4), ("explicit", 1e-3)])
def test_a_beam_that_hangs_far_down_comes_to_the_static_rest(method, tolerance):
    scene = Beam(material=SOFT, length=0.1)
    static = solve_beam(scene)
    damping = Solver(method=method, mass_damping=35.0, until_rest=True, duration=3.0)
    result = solve_dynamic(replace(scene, solver=damping))
    assert result.ok, result.message
    expected = tip(static.mesh, static.positions[-1])
    assert expected[2] < -0.03
    np.testing.assert_allclose(tip(result.mesh, result.positions[-1]), expected, rtol=tolerance)


def test_a_swing_through_equilibrium_is_not_rest():
    body = body_of(SHORT)
    mode = first_mode(body, lumped=False)
    equilibrium = solve_beam(SHORT).positions[-1]
    sag = abs(tip(body.discretisation.mesh, equilibrium)[2])
    period = 2.0 * np.pi / mode.w
    solver = Solver(duration=2.0 * period, time_step=period / 200, until_rest=True, tolerance=0.1)
    run = implicit.march(body, solver, start=equilibrium + 0.5 * sag * mode.shape)
    assert min(run.frames.residual) < solver.tolerance  # it passes through equilibrium
    assert run.status is Status.UNFINISHED
    assert "nothing damps" in run.message


# masses and frequencies


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8"])
def test_masses_hold_the_bodys_mass_and_move_rigidly(kind):
    mesh = beam_mesh(length=0.05, section=Rectangle(width=0.02, height=0.01), kind=kind)
    consistent, lumped = consistent_mass(mesh, DENSITY), lumped_mass(mesh, DENSITY)
    total = DENSITY * 0.05 * 0.02 * 0.01
    assert consistent.sum() == pytest.approx(total, rel=1e-12)
    assert lumped.sum() == pytest.approx(total, rel=1e-12)
    assert lumped.min() > 0.0
    # linear fields are in the element space: their kinetic energy is exact with the fine quadrature only
    x = mesh.nodes[:, 0]
    assert x @ (consistent @ x) == pytest.approx(total * 0.05**2 / 3.0, rel=1e-12)


@pytest.mark.parametrize("lumped", [False, True])
def test_first_frequency_is_the_slender_cantilevers(lumped):
    bending, corrected = timoshenko_frequency(SLENDER.length, SLENDER.section.radius)
    assert corrected < bending
    found = first_mode(body_of(SLENDER, loaded=False), lumped=lumped).w
    # the clamp also constrains the section's width, which shortens the beam by about 0.1 radius: 1 % here
    assert found == pytest.approx(corrected, rel=0.012)


@pytest.mark.parametrize(("method", "tolerance"), [("implicit", 4e-3), ("explicit", 1e-3)])
def test_swings_at_its_frequency(method, tolerance):
    body = body_of(SHORT, loaded=False)
    mode = first_mode(body, lumped=method == "explicit")
    assert swing(method, body, mode, periods=1.5, steps=300) == pytest.approx(-1.0, abs=tolerance)
    # at a zero crossing the amplitude shows the full phase error
    assert swing(method, body, mode, periods=1.25, steps=250) == pytest.approx(0.0, abs=tolerance)


def test_the_implicit_method_is_of_second_order():
    body = body_of(SHORT, loaded=False)
    mode = first_mode(body, lumped=False)
    steps = np.array([40, 80, 160])
    exact = np.cos(2.0 * np.pi * 1.3)
    errors = [abs(swing("implicit", body, mode, periods=1.3, steps=n) - exact) for n in steps]
    orders = np.diff(-np.log(errors)) / np.log(2.0)
    assert errors[-1] < 1e-2
    assert (orders > 1.8).all()
    assert (orders < 2.3).all()


def test_the_implicit_method_is_of_second_order_with_viscosity():
    """Viscous beam with an initial velocity: the change quarters with each halving of the time step."""
    prony = Prony(fractions=(0.4, 0.3), times=(0.004, 0.03))
    beam = replace(SHORT, material=replace(SOFT, viscosity=prony))
    mode = first_mode(body_of(SHORT, loaded=False), lumped=False)
    mesh = body_of(SHORT, loaded=False).discretisation.mesh
    duration = 1.3 * 2.0 * np.pi / mode.w
    ends = []
    for steps in (40, 80, 160):
        body = body_of(beam, loaded=False)
        solver = Solver(duration=duration, time_step=duration / steps, tolerance=1e-7)
        run = implicit.march(body, solver, velocity=1e-4 * mode.w * mode.shape)
        assert run.status == "converged", run.message
        ends.append((mode.amplitude(mesh, run.frames.positions[-1]) / 1e-4, body.dissipated()))
    moved, lost = np.diff(ends, axis=0).T
    assert abs(moved[0]) > 1e-4
    assert np.log2(moved[0] / moved[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(lost[0] / lost[1]) == pytest.approx(2.0, abs=0.2)


def test_steps_of_changing_length_keep_the_order():
    rng = np.random.default_rng(1)
    for _ in range(20):
        h, before = rng.uniform(0.5, 2.0, 2)
        c = np.array(implicit.difference(h, before))
        times = np.array([0.0, -h, -h - before])
        moments = [c.sum(), c @ times, c @ times**2]
        np.testing.assert_allclose(moments, [0.0, 1.0, 0.0], atol=1e-12)


# energy and stability of the explicit method


def test_undamped_explicit_run_keeps_its_energy():
    run = MARCH["explicit"](body_of(SHORT), Solver(duration=0.7, time_step=5e-3))
    assert run.status is Status.CONVERGED
    assert run.steps > 10000  # some 20 periods
    assert run.drift < 1e-6


def test_damped_explicit_run_accounts_for_what_damping_took():
    solver = Solver(duration=0.1, mass_damping=50.0, stiffness_damping=1e-4)
    run = MARCH["explicit"](body_of(SHORT), solver)
    assert run.status is Status.CONVERGED
    assert run.drift < 1e-5


@pytest.mark.parametrize("stiffness_damping", [0.0, 1e-4])
def test_the_stable_step_is_sharp_and_a_longer_one_is_reported(stiffness_damping):
    solver = Solver(duration=0.02, time_step=0.01, stiffness_damping=stiffness_damping)
    body = body_of(SHORT)
    below = explicit.march(body, solver, safety=0.98)
    above = explicit.march(body, solver, safety=1.03)
    assert below.status is Status.CONVERGED
    assert below.drift < 1e-4
    assert above.status is Status.DIVERGED
    assert "energy" in above.message
    assert above.time < solver.duration
    assert all(np.isfinite(x).all() for x in above.frames.positions)


def test_a_diverged_run_shows_in_the_result(monkeypatch):
    monkeypatch.setattr(explicit.march, "__kwdefaults__", explicit.march.__kwdefaults__ | {"safety": 1.1})
    result = solve_dynamic(replace(SHORT, solver=Solver(method="explicit", duration=0.1)))
    assert result.status is Status.DIVERGED
    assert result.message


# damping


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("mass", "stiffness"), [(40.0, 0.0), (10.0, 0.75)])
def test_a_mode_decays_at_half_of_the_rayleigh_rate(method, mass, stiffness):
    body = body_of(SHORT, loaded=False)
    mode = first_mode(body, lumped=method == "explicit")
    stiffness *= 40.0 / mode.w**2
    rate = 0.5 * (mass + stiffness * mode.w**2)
    left = swing(method, body, mode, periods=1.0, steps=200, mass=mass, stiffness=stiffness)
    duration = 2.0 * np.pi / np.sqrt(mode.w**2 - rate**2)
    assert -np.log(left) / duration == pytest.approx(rate, rel=0.01)
    assert rate == pytest.approx(20.0, rel=1e-9)


# invariance and momentum


@pytest.mark.parametrize("method", METHODS)
def test_turning_the_world_about_the_axis_turns_the_answer(method):
    mesh = beam_mesh(
        length=0.03, section=Rectangle(width=0.012, height=0.008), axial_element_size=0.01, radial_elements=1
    )
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    solver = Solver(method=method, duration=0.02, time_step=1e-3, stiffness_damping=1e-4, tolerance=1e-10)
    gravity = np.array([3.0, 4.0, -9.0])
    scene = Beam(material=SOFT, length=0.03, mesh=mesh, gravity=tuple(gravity), solver=solver)
    turned = replace(scene, mesh=replace(mesh, nodes=mesh.nodes @ turn.T), gravity=tuple(turn @ gravity))
    first, second = solve_dynamic(scene), solve_dynamic(turned)
    assert first.ok
    assert second.ok
    assert np.linalg.norm(tip(mesh, first.positions[-1])) > 5e-4
    np.testing.assert_allclose(second.positions, first.positions @ turn.T, atol=1e-9)
    np.testing.assert_allclose(second.support_force, first.support_force @ turn.T, atol=1e-6)


def test_a_free_body_keeps_its_momentum_and_its_spin():
    scene = Beam(
        material=SOFT,
        length=0.03,
        mesh=beam_mesh(length=0.03, section=Circle(radius=0.01), radial_elements=1),
    )
    body = free_body(scene)
    mesh = body.discretisation.mesh
    x = mesh.nodes - [0.015, 0.0, 0.0]
    velocity = np.array([0.3, -0.2, 0.1]) + np.cross([3.0, 40.0, 20.0], x)
    velocity[:, 2] += 20.0 * x[:, 0] ** 2 / 0.03  # bent too
    mass = lumped_mass(mesh, DENSITY)[:, None]
    solver = Solver(duration=0.05, time_step=1e-4)
    frames = MARCH["explicit"](body, solver, velocity=velocity).frames
    dt = frames.time[1] - frames.time[0]
    momentum = (mass * velocity).sum(axis=0)
    spin = (mass * np.cross(mesh.nodes, velocity)).sum(axis=0)
    end, before = frames.positions[-1], frames.positions[-2]
    assert np.ptp(np.linalg.norm(end - end.mean(axis=0), axis=1) / np.linalg.norm(x, axis=1)) > 1e-3
    # the mean velocity over a frame's interval gives the momentum exactly, the spin to second order
    np.testing.assert_allclose((mass * (end - before) / dt).sum(axis=0), momentum, rtol=1e-9)
    middle = 0.5 * (end + before)
    found = (mass * np.cross(middle, (end - before) / dt)).sum(axis=0)
    np.testing.assert_allclose(found, spin, rtol=1e-3, atol=1e-3 * np.abs(spin).max())


@pytest.mark.parametrize("method", METHODS)
def test_free_flight_strains_nothing(method):
    body = free_body(
        replace(SHORT, mesh=beam_mesh(length=0.03, section=Circle(radius=0.01), radial_elements=1))
    )
    nodes = body.discretisation.mesh.nodes
    velocity = np.tile([0.5, -0.2, 0.1], (len(nodes), 1))
    solver = Solver(duration=0.05, stiffness_damping=1e-4, time_step=0.01)
    run = MARCH[method](body, solver, velocity=velocity)
    assert run.status is Status.CONVERGED
    np.testing.assert_allclose(run.frames.positions[-1], nodes + 0.05 * velocity, atol=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_supports_carry_the_load_and_the_change_of_momentum(method):
    solver = Solver(method=method, duration=0.03, time_step=1e-4, tolerance=1e-9)
    solver = replace(solver, mass_damping=20.0, stiffness_damping=1e-3)
    result = solve_dynamic(replace(SHORT, solver=solver))
    body = body_of(SHORT)
    lumped = method == "explicit"
    mass = lumped_mass(result.mesh, DENSITY) if lumped else consistent_mass(result.mesh, DENSITY).sum(axis=0)
    moment = 2.0 * result.positions[:, :, 2] @ np.ravel(mass)  # the mesh is half of the beam
    momentum, change = (moment[2:] - moment[:-2]) / 2e-4, np.diff(moment, 2) / 1e-4**2
    total = 2.0 * body.dead_load[:, 2].sum()
    expected = (change + solver.mass_damping * momentum - total)[50:]
    found = result.support_force[1:-1, 2][50:]
    assert np.ptp(found) > 0.05  # it oscillates
    np.testing.assert_allclose(found, expected, atol=0.03 * np.ptp(found))


# reported failures


def test_an_implicit_run_without_convergence_says_so_after_cutting_its_step():
    solver = Solver(method="implicit", max_iterations=0, duration=0.1)
    result = solve_dynamic(replace(SHORT, solver=solver))
    assert result.status is Status.NOT_CONVERGED
    assert "converges" in result.message
    assert result.cost.step_cuts == implicit.MOST_HALVINGS
    assert len(result.load) == 0


def test_a_step_that_is_too_long_is_cut_and_frames_stay_on_time():
    soft = replace(SOFT, parameters={"mu": 3e3, "lam": 60e3})
    solver = Solver(method="implicit", max_iterations=3, duration=0.4, time_step=0.1)
    result = solve_dynamic(replace(SHORT, material=soft, solver=solver))
    assert result.ok
    assert result.cost.step_cuts > 0
    assert result.cost.steps > 4
    np.testing.assert_allclose(result.load, [0.1, 0.2, 0.3, 0.4], rtol=1e-12)


def test_cut_steps_grow_again_only_where_they_meet_the_frames(monkeypatch):
    real, calls = implicit.newton, []

    def failing(system, x, **options):
        calls.append(1)
        outcome = real(system, x, **options)
        bad = len(calls) in (1, 2, 4)  # down to a quarter, one step, down to an eighth
        return replace(outcome, status=Status.NOT_CONVERGED) if bad else outcome

    monkeypatch.setattr(implicit, "newton", failing)
    solver = Solver(method="implicit", duration=0.1, time_step=0.01)
    result = solve_dynamic(replace(SHORT, solver=solver))
    assert result.ok
    assert result.cost.step_cuts == 3
    np.testing.assert_allclose(result.load, 0.01 * np.arange(1, 11), rtol=1e-12)
    assert result.cost.steps < 30  # the step grew again


@pytest.mark.parametrize("method", METHODS)
def test_time_up_before_rest_is_unfinished(method):
    result = solve_dynamic(replace(SHORT, solver=replace(REST, method=method, duration=0.01)))
    assert result.status is Status.UNFINISHED
    assert "not at rest" in result.message
    assert result.residual[-1] > REST.tolerance
    assert result.load[-1] == pytest.approx(0.01)


@pytest.mark.parametrize("change", [{"duration": 0.0}, {"time_step": -1.0}, {"mass_damping": -1.0}])
def test_settings_without_meaning_are_refused(change):
    name = next(iter(change))
    for method in METHODS:
        with pytest.raises(ValueError, match=name):
            solve_dynamic(replace(SHORT, solver=replace(Solver(method=method), **change)))


def test_the_static_method_is_not_dynamics():
    with pytest.raises(ValueError, match="not a dynamic method"):
        solve_dynamic(SHORT)


def test_many_steps_keep_at_most_500_frames_and_the_end():
    result = solve_dynamic(
        replace(SHORT, solver=Solver(method="explicit", duration=0.0503, time_step=0.0503 / 1203))
    )
    assert 400 <= len(result.load) <= 501
    assert result.load[-1] == pytest.approx(0.0503)


# the paper's rule


def test_the_papers_rule_stops_before_equilibrium():
    scene = Beam(material=SOFT, length=0.05, axial_element_size=0.01, radial_elements=1)
    static = solve_beam(scene)
    solver = Solver(method="implicit", time_step=1e-3, duration=0.25, mass_damping=0.1, stiffness_damping=0.1)
    run = solve_dynamic(replace(scene, solver=solver))
    stop = paper_stop(run, static.positions[-1])
    assert stop is not None
    assert stop.time == pytest.approx(0.150)
    assert stop.motion < 1e-3
    assert stop.residual > 0.1
    assert stop.largest_distance > 0.2 * abs(tip(static.mesh, static.positions[-1])[2])
    # overdamped: every mode decays as exp(-t/c_K) towards equilibrium (physics.md, section 2 and 9)
    left = np.exp(-0.150 / 0.1)
    assert stop.largest_distance == pytest.approx(
        left * np.linalg.norm(static.positions[-1] - static.mesh.nodes, axis=1).max(), rel=0.05
    )


def test_the_rule_counts_windows_as_the_paper_does():
    solver = Solver(method="implicit", time_step=0.01, duration=0.3)
    run = solve_dynamic(replace(SHORT, solver=solver))
    times = 0.01 * np.arange(1, 31)
    speed = np.where(times < 0.1, 1.0, 0.001)  # m/s: 50 mm a window, then 0.05 mm
    path = np.cumsum(0.01 * speed)
    made = replace(run, positions=run.mesh.nodes + path[:, None, None] * [1.0, 0.0, 0.0])
    stop = paper_stop(made, run.mesh.nodes)
    assert stop is not None
    assert stop.time == pytest.approx(0.25, abs=0.011)  # the end of the third slow window
    assert paper_stop(replace(made, positions=run.mesh.nodes + times[:, None, None]), run.mesh.nodes) is None
    with pytest.raises(ValueError, match="window"):
        paper_stop(made, run.mesh.nodes, step=1.1e-3)
