"""Prediction of a beam's next state on its course, from its linear material and from the previous beam.

A beam's shape is very nearly a function of the creep strain of its linear material. Its next state is
therefore extrapolated from its last ones, or from the states of a neighbour on the same mesh under the same
loads; the difference between the two beams hardly changes from one step to the next.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tisim.parts import Spectrum, ramp_weight
from tisim.scene import Beam

Array = NDArray[np.float64]

DISTINCT = 1e-3  # relative difference of strain below which states count as one
KNOWN = 4  # number of states from which the next one is predicted
BEYOND = 0.1  # allowed extrapolation beyond the neighbour's range of strain, as a fraction of it


class LinearCreep:
    """Strain of a spectrum's linear material under a stress, in units of 1/G; steps as in `History`."""

    def __init__(self, spectrum: Spectrum) -> None:
        self._spectrum = spectrum
        self._branches = np.zeros(len(spectrum.times))
        self._strain = 0.0

    def strain(self, dt: float, stress: float) -> float:
        """Strain at the end of a step of length dt [s] to the stress."""
        decay, c = self._weights(dt)
        carried = float(decay @ self._branches) - float(c.sum()) * self._strain
        return (stress - carried) / (self._spectrum.equilibrium + float(c.sum()))

    def accept(self, dt: float, strain: float) -> None:
        """Accept a step of length dt [s] to the strain."""
        decay, c = self._weights(dt)
        self._branches = decay * self._branches + c * (strain - self._strain)
        self._strain = strain

    def _weights(self, dt: float) -> tuple[Array, Array]:
        h = dt / self._spectrum.times
        return np.exp(-h), self._spectrum.strengths * ramp_weight(h)


@dataclass(frozen=True, eq=False)
class State:
    """State of a beam on its course.

    Attributes
    ----------
    time : time [s].
    strain : strain of the linear material times `Trail.unit`.
    x : positions [m], shape (n, 3).
    """

    time: float
    strain: float
    x: Array


@dataclass(eq=False)
class Trail:
    """States of a beam from the first equilibrium on.

    Attributes
    ----------
    scene : the beam.
    unit : density over the law's shear modulus [s2/m2]. Beams of one shape that differ in these two alone
        have the same deflection at the same strain of the linear material times `unit`.
    states : the states, in order of time.
    """

    scene: Beam
    unit: float
    states: list[State] = field(default_factory=list)

    def add(self, time: float, strain: float, x: Array) -> None:
        """Append a state; `strain` is that of `LinearCreep`."""
        self.states.append(State(time, self.unit * strain, x))

    def leads(self, scene: Beam) -> bool:
        """True if a scene on the same mesh has the same loads and course, and enough states are known."""
        return (
            len(self.states) >= KNOWN
            and scene.course == self.scene.course
            and tuple(scene.gravity) == tuple(self.scene.gravity)
            and tuple(scene.tip_force) == tuple(self.scene.tip_force)
        )

    def at(self, time: float, strain: float) -> Array | None:
        """Positions interpolated at a strain near that time; None if the states do not reach it."""
        branch = self._branch(time)
        strains = [state.strain for state in branch]
        room = BEYOND * (max(strains) - min(strains))
        if len(branch) < KNOWN or not min(strains) - room <= strain <= max(strains) + room:
            return None
        return polynomial(sorted(branch, key=lambda state: abs(state.strain - strain)), strain)

    def _branch(self, time: float) -> list[State]:
        """States around a time between which the strain is monotonic."""
        states = self.states
        at = next((i for i, state in enumerate(states) if state.time >= time), len(states) - 1)
        first = last = max(at, 1)
        up = states[first].strain >= states[first - 1].strain
        while first > 0 and (states[first].strain >= states[first - 1].strain) == up:
            first -= 1
        while last + 1 < len(states) and (states[last + 1].strain >= states[last].strain) == up:
            last += 1
        return states[first : last + 1]


def polynomial(states: list[State], strain: float) -> Array:
    """Positions at a strain by Lagrange interpolation through the first KNOWN distinct states."""
    known: list[State] = []
    for state in states:
        if all(abs(state.strain - other.strain) > DISTINCT * abs(strain) for other in known):
            known.append(state)
        if len(known) == KNOWN:
            break
    found = np.zeros_like(states[0].x)
    for state in known:
        others = [other.strain for other in known if other is not state]
        found += float(np.prod([(strain - other) / (state.strain - other) for other in others])) * state.x
    return found


def predict(own: Trail, other: Trail | None, time: float, strain: float) -> Array:
    """Predict positions at a time [s] and a strain of `LinearCreep`.

    Adds the neighbour's change to the last state if `other` has the same loads, else extrapolates the last
    KNOWN states.
    """
    last, strain = own.states[-1], own.unit * strain
    if other is not None and other.leads(own.scene):
        here, there = other.at(last.time, last.strain), other.at(time, strain)
        if here is not None and there is not None:
            moved: Array = last.x + (there - here)
            return moved
    return polynomial(own.states[: -KNOWN - 1 : -1], strain)
