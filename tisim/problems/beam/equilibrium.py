"""Equilibrium of an ideal beam: Newton at full load from the rod's shape, or load steps if that fails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Rectangle
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.nonlinear.newton import Outcome, newton
from tisim.problems.beam.rods import planar_rod
from tisim.problems.beam.system import BeamSystem
from tisim.problems.beam.trail import Trail
from tisim.problems.beam.warped import Warped
from tisim.result import Status
from tisim.scene import Beam

Array = NDArray[np.float64]

HELD = 0.5  # decay length of a clamp's constraint on the section's shape, in half thicknesses


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A solved beam that provides the start values of the next one.

    Attributes
    ----------
    discretisation : the beam's discretisation.
    x : positions in equilibrium [m], shape (n, 3).
    rod : positions by rod theory [m], shape (n, 3).
    pressure : element pressures [Pa], shape (m,).
    trail, warped : states and last factor of a beam with a course, else None.
    """

    discretisation: Discretisation
    x: Array
    rod: Array
    pressure: Array
    trail: Trail | None = None
    warped: Warped | None = None


def equilibrium(
    scene: Beam, system: BeamSystem, neighbour: Neighbour | None = None
) -> tuple[Outcome, dict[str, int], Neighbour | None]:
    """Equilibrium at full load from a neighbour's or the rod's shape, else by adaptive load steps from rest.

    The positions of a neighbour on the same discretisation are corrected by the change of the rod's shape,
    and its pressures are kept: 3.2 to 3.8 linearisations against 4.3 to 4.6 from the rod's shape alone, over
    designs within a factor of 1.35 to 3.3 of their centre in stiffness and in K/mu.

    Returns
    -------
    tuple of (Outcome, dict of str to int, Neighbour or None)
        Outcome, the counts "steps" and "cuts", and the start values of the next beam (None after load steps).
    """
    discretisation = system.body.discretisation
    if not system.full_load.any():
        return (
            Outcome(discretisation.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0),
            {"steps": 1, "cuts": 0},
            None,
        )
    rod = rod_shape(scene, system.body)
    if rod is not None:
        # the rod's shape does not preserve volume: its pressures would be far too large
        starts = [(rod, np.zeros(discretisation.mesh.n_elements))]
        if neighbour is not None and neighbour.discretisation is discretisation:
            moved = neighbour.x + (rod - neighbour.rod)
            still = discretisation.still  # an imperfect neighbour has other positions there
            moved[still] = discretisation.mesh.nodes[still]
            starts.insert(0, (moved, neighbour.pressure))
        for guess, pressure in starts:
            if system.potential(guess)[1] > 0.0:
                outcome = mixed_newton(scene, system, guess, pressure)
                if outcome.status is Status.CONVERGED:
                    found = Neighbour(discretisation, outcome.x, rod, system.body.pressures(outcome.x))
                    return outcome, {"steps": 1, "cuts": 0}, found
    return *_load_steps(scene, system), None


def mixed_newton(scene: Beam, system: BeamSystem, x: Array, pressure: Array) -> Outcome:
    """Newton's method with the element pressures as unknowns, at most 15 iterations."""
    options = scene.solver
    system.free_pressures(pressure)
    outcome = newton(system, x, tolerance=options.tolerance, max_iterations=min(15, options.max_iterations))
    system.free_pressures(None)
    return outcome


def _load_steps(scene: Beam, system: BeamSystem) -> tuple[Outcome, dict[str, int]]:
    """Load steps from rest.

    A step that fails with free pressures is tried once more on the potential, then halved.
    """
    options, body = scene.solver, system.body
    counts = {"steps": 0, "cuts": 0}
    outcome = Outcome(body.discretisation.mesh.nodes.copy(), Status.CONVERGED, 0.0, 0)
    reached, step = 0.0, 0.25
    system.step_limit = 0.2 * scene.length
    while reached < 1.0:
        factor = min(1.0, reached + step)
        system.set_factor(factor)
        trial = mixed_newton(scene, system, outcome.x, body.pressures(outcome.x))
        if trial.status is not Status.CONVERGED:
            trial = newton(
                system, outcome.x, tolerance=options.tolerance, max_iterations=options.max_iterations
            )
        counts["steps"] += 1
        if trial.status is Status.CONVERGED:
            outcome, reached = trial, factor
            step *= 2.0 if trial.iterations < 8 else 1.0
            continue
        step *= 0.5
        counts["cuts"] += 1
        if step < 1.0 / 512.0:
            system.set_factor(reached)
            return Outcome(outcome.x, trial.status, trial.residual, trial.iterations), counts
    return outcome, counts


def rod_shape(scene: Beam, body: DiscretisedBody) -> Array | None:
    """Node positions (n, 3) [m] of the beam bent as a planar rod; None if the rod does not bend in a plane.

    Outside the clamps, sections narrow where bending stretches them and widen where it shortens them
    (Saint-Venant's anticlastic bending). Undeformed sections would change in volume, and the pressures of
    4-node tetrahedra would be thousands of times the load.
    """
    section = scene.section
    line = scene.material.density * section.area * np.asarray(scene.gravity, dtype=float)
    tip = np.asarray(scene.tip_force, dtype=float)
    across = (line * scene.length + tip) * np.array([0.0, 1.0, 1.0])
    size = float(np.linalg.norm(across))
    e2 = across / size if size > 0 else np.array([0.0, 0.0, 1.0])
    if isinstance(section, Rectangle) and abs(e2[1]) > 1e-12 and abs(e2[2]) > 1e-12:
        return None  # a rectangle bent off its principal planes leaves the plane of the load
    young = body.moduli.young_modulus
    s, r, theta = planar_rod(
        length=scene.length,
        bending=young * section.second_moment("y" if abs(e2[2]) > 0.5 else "z"),
        stretching=young * section.area,
        line_load=(float(line[0]), float(line @ e2)),
        tip_force=(float(tip[0]), float(tip @ e2)),
        clamped_end=scene.supports == "clamped-clamped",
    )
    rest = body.discretisation.mesh.nodes
    t = np.clip(rest[:, 0], 0.0, scene.length)
    e3 = np.cross([1.0, 0.0, 0.0], e2)
    offset, side = rest @ e2, rest @ e3
    angle = np.interp(t, s, theta)
    thick = max(section.half_width, section.half_height)
    held = np.exp(-((t / (HELD * thick)) ** 2))
    if scene.supports == "clamped-clamped":
        held = held + np.exp(-(((scene.length - t) / (HELD * thick)) ** 2))
    narrowing = (
        body.moduli.poisson_ratio * np.maximum(1.0 - held, 0.0) * np.interp(t, s, np.gradient(theta, s))
    )
    offset, side = offset + 0.5 * narrowing * (offset**2 - side**2), side * (1.0 + narrowing * offset)
    x1 = np.interp(t, s, r[:, 0]) - offset * np.sin(angle) + (rest[:, 0] - t)
    x2 = np.interp(t, s, r[:, 1]) + offset * np.cos(angle)
    x = x1[:, None] * np.array([1.0, 0.0, 0.0]) + x2[:, None] * e2 + side[:, None] * e3
    still = body.discretisation.still
    x[still] = rest[still]
    for axis in body.discretisation.mesh.symmetry:
        nodes = body.discretisation.mesh.node_sets[f"mirror_{axis}"]
        x[nodes, "xyz".index(axis)] = rest[nodes, "xyz".index(axis)]
    return x
