"""Equilibria of beams with an imperfect specimen or imperfect clamps.

Newton starts from a neighbour's or the rod's shape as for ideal beams. If that fails, it starts from the
solution of the ideal beam, and the imperfections are increased step by step. A clamp's compliance is an outer
iteration on its angle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.body import Discretisation
from tisim.nonlinear.newton import Outcome
from tisim.problems.beam.equilibrium import Neighbour, equilibrium, mixed_newton, rod_shape
from tisim.problems.beam.rest_shape import rest_positions, specimen_discretisation
from tisim.problems.beam.rods import body_positions, clamp_centres, clamped_positions, solve_rod
from tisim.problems.beam.system import BeamSystem, beam_system
from tisim.result import Status
from tisim.scene import Beam, ClampImperfections, Imperfections

Array = NDArray[np.float64]

ANGLE_TOLERANCE = 1e-4  # error of a clamp's angle, relative to the part that compliance adds
SMALL_ANGLE = 1e-9  # absolute tolerance of a clamp's angle [rad]
MOST_ANGLES = 20  # iterations on the clamps' angles
SMALLEST_PART = 1.0 / 64.0  # smallest increment of the fraction of the imperfections
EARLY_TOLERANCE = 1e-3  # of equilibrium, before the clamps' angles are first corrected
SMALL_TURN = 1e-6  # rotation of a clamp in difference quotients [rad]


@dataclass(frozen=True, eq=False)
class Found:
    """Result of the search for the equilibrium of an imperfect beam.

    Attributes
    ----------
    system : the beam under its load.
    outcome : outcome of the last equilibrium.
    counts : numbers of "steps" and "cuts".
    part : fraction of the imperfections that was reached.
    neighbour : start values of the next beam, or None.
    clamps : clamps of the equilibrium; None if it was not found.
    """

    system: BeamSystem
    outcome: Outcome
    counts: dict[str, int]
    part: float
    neighbour: Neighbour | None
    clamps: Clamped | None = None


def imperfect_equilibrium(
    scene: Beam, discretisation: Discretisation, neighbour: Neighbour | None = None
) -> Found:
    """Equilibrium of an imperfect beam on the discretisation of the ideal beam."""
    system = imperfect_system(scene, discretisation)
    attempt = Clamped(scene, discretisation, system)
    for x, pressure in attempt.starts(neighbour):
        outcome = attempt.solve(x, pressure)
        if outcome.status is Status.CONVERGED:
            return Found(system, outcome, {"steps": 1, "cuts": 0}, 1.0, attempt.neighbour(outcome.x), attempt)
    return _continuation(scene, discretisation, system.counts)


def imperfect_system(scene: Beam, discretisation: Discretisation) -> BeamSystem:
    """Material and loads of a beam, integrated over its imperfect specimen."""
    system = beam_system(scene, specimen_discretisation(scene, discretisation))
    system.clamps_load = True
    return system


class Clamped:
    """Solver of one imperfect beam: start values, equilibrium and the angles of its clamps.

    Attributes
    ----------
    tilts : angles of the clamps without compliance [rad], shape (2,).
    first_angles, angles : estimated and present angles of the clamps [rad], shape (2,).
    guess : positions of the rod's shape [m], shape (n, 3); None if there is none.
    """

    def __init__(self, scene: Beam, discretisation: Discretisation, system: BeamSystem) -> None:
        self.scene, self.discretisation, self.system = scene, discretisation, system
        self.fixed = discretisation.fixed
        self._still = np.flatnonzero(discretisation.still)
        self._rest = rest_positions(scene, discretisation.mesh)[self._still]
        self.tilts = np.array([scene.clamp_imperfections.tilt, scene.clamp_imperfections.far_tilt])
        self.first_angles = self.tilts
        if scene.clamp_imperfections.compliance > 0.0:
            rod = solve_rod(scene, system.body.moduli)
            if rod is not None:
                self.first_angles = rod.clamp_angles
                self.first_angles[1] *= scene.supports == "clamped-clamped"
        self.angles = self.first_angles
        self.guess = self._guess()

    @property
    def yields(self) -> bool:
        return self.scene.clamp_imperfections.compliance > 0.0

    def _guess(self) -> Array | None:
        """Positions of the rod's shape with the clamps at their first angles, held nodes in place."""
        scene, mesh = self.scene, self.discretisation.mesh
        planar = scene.gravity[1] == 0.0 and scene.tip_force[1] == 0.0
        # for a load out of the plane y = 0, superpose the unloaded imperfect shape and the loaded ideal shape
        unloaded = replace(scene, gravity=(0.0, 0.0, 0.0), tip_force=(0.0, 0.0, 0.0))
        rod = solve_rod(scene if planar else unloaded, self.system.body.moduli, self.first_angles)
        if rod is None:
            return None
        x = body_positions(scene, mesh, rod)
        if not planar:
            bent = rod_shape(scene, self.system.body)
            if bent is None:
                return None
            x += bent - mesh.nodes
        return self.hold(x)

    def hold(self, x: Array) -> Array:
        """Copy of x with the held nodes at their positions in the clamps at the present angles.

        Nodes of no element stay at rest.
        """
        x = x.copy()
        x[self._still] = self._rest
        x[self.fixed] = clamped_positions(self.scene, self.discretisation.mesh, self.fixed, self.angles)
        return x

    def starts(self, neighbour: Neighbour | None) -> Iterator[tuple[Array, Array]]:
        """Start values, the best first: positions (n, 3) [m] and element pressures (m,) [Pa]."""
        if self.guess is None:
            return
        if neighbour is not None and neighbour.discretisation is self.discretisation:
            yield self.hold(neighbour.x + (self.guess - neighbour.rod)), neighbour.pressure
            self.angles = self.first_angles  # a failed start may have changed them
        yield self.guess, np.zeros(self.discretisation.mesh.n_elements)

    def from_answer(self, x: Array, guess: Array | None) -> Array:
        """Start positions from another scene's solution x, corrected by the rods' difference if available."""
        moved = x if self.guess is None or guess is None else x + (self.guess - guess)
        return self.hold(moved)

    def neighbour(self, x: Array) -> Neighbour | None:
        if self.guess is None:
            return None
        return Neighbour(self.discretisation, x, self.guess, self.system.body.pressures(x))

    def solve(self, x: Array, pressure: Array) -> Outcome:
        """Newton's method, and an outer Newton iteration on the angles of compliant clamps."""
        scene, yields = self.scene, self.yields
        failed = Outcome(x, Status.INVERTED, np.inf, 0)
        if not self.system.potential(x)[1] > 0.0:
            return failed
        early = scene
        if yields and scene.solver.tolerance < EARLY_TOLERANCE:
            early = replace(scene, solver=replace(scene.solver, tolerance=EARLY_TOLERANCE))
        outcome = mixed_newton(early, self.system, x, pressure)
        if not yields or outcome.status is not Status.CONVERGED:
            return outcome
        final = early is scene
        for _ in range(MOST_ANGLES):
            pressure = self.system.body.pressures(outcome.x)
            if self.opens(outcome.x):
                start, pressure = self.turned(outcome.x)
                if not self.system.potential(start)[1] > 0.0:  # true for NaN as well
                    return failed
            elif final:
                return outcome
            else:
                start = outcome.x
            outcome = mixed_newton(scene, self.system, start, pressure)
            final = True
            if outcome.status is not Status.CONVERGED:
                return outcome
        return replace(outcome, status=Status.NOT_CONVERGED)

    def opens(self, x: Array) -> bool:
        """True if the clamps' angles differ from those that their moments at x cause."""
        if not self.yields:
            return False
        small = ANGLE_TOLERANCE * float(np.abs(self.angles - self.tilts).max()) + SMALL_ANGLE
        return bool(np.abs(self._gap(x)).max() > small)

    def _gap(self, x: Array) -> Array:
        """Difference of the clamps' angles from those that their moments cause [rad], shape (2,)."""
        moments = clamp_moments(self.scene, self.discretisation, self.system, x)
        gap: Array = self.angles - self.tilts - self.scene.clamp_imperfections.compliance * moments
        if self.scene.supports == "clamped-free":
            gap[1] = 0.0
        return gap

    def turned(self, x: Array) -> tuple[Array, Array]:
        """Advance x and its pressures to first order to the clamp angles at which `_gap` vanishes.

        The derivative of x by the clamps' angles is solved for with the last factor of the tangent. The
        tangent's rows at the held nodes are not assembled; difference quotients of forces replace them.
        """
        body, discretisation = self.system.body, self.discretisation
        mesh, free = discretisation.mesh, discretisation.pattern.free
        if not self.system.counts["factorisations"]:  # the start value converged without a step
            self.system.step(self.system.linearise(x)[0], forcing=0.0)
        force = body.internal_forces(x)[0]
        centres = clamp_centres(self.scene)
        near = mesh.nodes[self.fixed, 0] < 0.5 * self.scene.length
        slope = np.eye(2)
        ways = np.zeros((2, *x.shape))
        for clamp in range(2 if self.scene.supports == "clamped-clamped" else 1):
            nodes = self.fixed[near == (clamp == 0)]
            arm = x[nodes] - centres[clamp]
            way = ways[clamp]
            way[nodes, 0], way[nodes, 2] = -arm[:, 2], arm[:, 0]
            change = body.internal_forces(x + SMALL_TURN * way)[0] - force
            pulled = discretisation.free_components(change) / SMALL_TURN
            way[free] = discretisation.solver.solve(-pulled)
            slope[:, clamp] = (self._gap(x + SMALL_TURN * way) - self._gap(x)) / SMALL_TURN
            slope[clamp, clamp] += 1.0  # the gap's own angle, which `_gap` did not turn
        if not np.isfinite(slope).all():
            return np.full_like(x, np.nan), body.pressures(x)
        # singular if a clamp's compliance makes the beam buckle
        step = np.linalg.lstsq(slope, -self._gap(x))[0]
        moved = step[0] * ways[0] + step[1] * ways[1]
        self.angles = self.angles + step
        return self.hold(x + moved), body.pressures(x, moved)


def clamp_moments(scene: Beam, discretisation: Discretisation, system: BeamSystem, x: Array) -> Array:
    """Moments that the body exerts on the near and the far clamp, (2,) [N m].

    About the middles of the clamps' faces; positive moments turn a clamp as a positive tilt does.
    """
    fixed = discretisation.fixed
    body = system.body
    # without the weight in the grips, which depends on how much of them is meshed
    support = body.internal_forces(x)[0][fixed] * discretisation.multiplicity
    near = discretisation.mesh.nodes[fixed, 0] < 0.5 * scene.length
    arm = x[fixed] - clamp_centres(scene)[np.where(near, 0, 1)]
    # support on body: (r x f)_y; body on clamp: its opposite; positive from x to z, that is, about -y
    turning = arm[:, 2] * support[:, 0] - arm[:, 0] * support[:, 2]
    return np.array([turning[near].sum(), turning[~near].sum()])


def _continuation(scene: Beam, discretisation: Discretisation, spent: dict[str, int]) -> Found:
    """Continuation from the solution of the ideal beam in the fraction of the imperfections.

    An increment at which Newton fails is halved. `spent` holds the counts so far and is added to.
    """
    ideal = replace(scene, imperfections=Imperfections(), clamp_imperfections=ClampImperfections())
    system = beam_system(ideal, discretisation)
    outcome, ideal_counts, _ = equilibrium(ideal, system)
    counts = dict(ideal_counts)
    _spend(spent, system)
    if outcome.status is not Status.CONVERGED:
        return Found(system, outcome, counts, 0.0, None)
    last = Clamped(ideal, discretisation, system)
    part, step = 0.0, 0.5
    while part < 1.0:
        wanted = min(1.0, part + step)
        trial_scene = _portion(scene, wanted)
        attempt = Clamped(trial_scene, discretisation, imperfect_system(trial_scene, discretisation))
        start = attempt.from_answer(outcome.x, last.guess)
        trial = attempt.solve(start, last.system.body.pressures(outcome.x))
        counts["steps"] += 1
        _spend(spent, attempt.system)
        if trial.status is Status.CONVERGED:
            outcome, part, last = trial, wanted, attempt
            continue
        counts["cuts"] += 1
        step *= 0.5
        if step < SMALLEST_PART:
            return Found(last.system, replace(trial, x=outcome.x), counts, part, None)
    return Found(last.system, outcome, counts, 1.0, last.neighbour(outcome.x), last)


def _spend(spent: dict[str, int], system: BeamSystem) -> None:
    """Add a system's counts to `spent`, which becomes the system's counts."""
    for name, count in system.counts.items():
        spent[name] = spent.get(name, 0) + count
    system.counts = spent


def _portion(scene: Beam, part: float) -> Beam:
    """The scene with the fraction `part` of each imperfection."""
    if part == 1.0:
        return scene
    s, c = scene.imperfections, scene.clamp_imperfections
    return replace(
        scene,
        imperfections=Imperfections(
            curvature=part * s.curvature,
            taper=part * s.taper,
            axial_gradient=part * s.axial_gradient,
            density_gradient=part * s.density_gradient,
            transverse_gradient=part * s.transverse_gradient,
            skin=part * s.skin,
            skin_thickness=s.skin_thickness,
            void=None if s.void is None else replace(s.void, fraction=part * s.void.fraction),
        ),
        clamp_imperfections=ClampImperfections(
            tilt=part * c.tilt,
            far_tilt=part * c.far_tilt,
            far_shift=(part * c.far_shift[0], part * c.far_shift[1]),
            compliance=part * c.compliance,
            squeeze=part * c.squeeze,
        ),
    )
