"""Where a beam on its course goes next: what its linear material says of it, and the beam before it.

A beam's shape is very nearly a function of how far its linear material would have crept. So its last states
point to the next one; and a neighbour's states, on the same mesh under the same loads, are that function
itself, but for what the two differ by, which hardly changes from one step to the next.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tisim.discretisation.history import weight
from tisim.parts import Spectrum
from tisim.scene import Beam

Array = NDArray[np.float64]

DISTINCT = 1e-3  # of the strain: states closer than this are one
KNOWN = 4  # states that the next one is predicted from
BEYOND = 0.1  # of the neighbour's range of strain: how far outside it is still followed


class LinearCreep:
    """Strain of a spectrum's linear material under a stress, in 1/G, step by step as `History` takes them."""

    def __init__(self, spectrum: Spectrum) -> None:
        self._spectrum = spectrum
        self._branches = np.zeros(len(spectrum.times))
        self._strain = 0.0

    def strain(self, dt: float, stress: float) -> float:
        """Strain at the end of a step of length dt [s] to this stress."""
        decay, c = self._weights(dt)
        carried = float(decay @ self._branches) - float(c.sum()) * self._strain
        return (stress - carried) / (self._spectrum.equilibrium + float(c.sum()))

    def accept(self, dt: float, strain: float) -> None:
        """Take a step of length dt [s] to this strain."""
        decay, c = self._weights(dt)
        self._branches = decay * self._branches + c * (strain - self._strain)
        self._strain = strain

    def _weights(self, dt: float) -> tuple[Array, Array]:
        h = dt / self._spectrum.times
        return np.exp(-h), self._spectrum.strengths * weight(h)


@dataclass(frozen=True, eq=False)
class State:
    """Beam on its course: time [s], strain of the linear material by its weight, positions (n, 3)."""

    time: float
    strain: float
    x: Array


@dataclass(eq=False)
class Trail:
    """The states of a beam from the first equilibrium on.

    unit: density over long-time shear modulus [s2/m2]: beams of one shape that differ in these two alone hang
        alike where the linear material's strain times this is the same.
    """

    scene: Beam
    unit: float
    states: list[State] = field(default_factory=list)

    def add(self, time: float, strain: float, x: Array) -> None:
        """strain: as `LinearCreep` has it."""
        self.states.append(State(time, self.unit * strain, x))

    def leads(self, scene: Beam) -> bool:
        """True if another scene, on the same mesh, has the same loads over the same time."""
        return (
            len(self.states) >= KNOWN
            and scene.course == self.scene.course
            and scene.gravity == self.scene.gravity
            and scene.tip_force == self.scene.tip_force
        )

    def at(self, time: float, strain: float) -> Array | None:
        """Positions at a strain around that time; None where the states do not reach that far."""
        branch = self._branch(time)
        strains = [state.strain for state in branch]
        room = BEYOND * (max(strains) - min(strains))
        if len(branch) < KNOWN or not min(strains) - room <= strain <= max(strains) + room:
            return None
        return polynomial(sorted(branch, key=lambda state: abs(state.strain - strain)), strain)

    def _branch(self, time: float) -> list[State]:
        """The states about a time between which the strain only rises, or only falls."""
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
    """Positions at a strain by Lagrange's formula, through the first KNOWN distinct states."""
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
    """Positions at a strain of the linear material, as `LinearCreep` has it, at a time [s].

    By the neighbour's states and what the last one here differs from it; else by the last states here.
    """
    last, strain = own.states[-1], own.unit * strain
    if other is not None and other.leads(own.scene):
        here, there = other.at(last.time, last.strain), other.at(time, strain)
        if here is not None and there is not None:
            moved: Array = last.x + (there - here)
            return moved
    return polynomial(own.states[: -KNOWN - 1 : -1], strain)
