"""What a marker objective is told: damping, how the beam is simulated, what is not known of a trial."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Damping:
    """Rayleigh coefficients [1/s] and [s]: `tisim.Solver.mass_damping`, `stiffness_damping`."""

    mass: float = 0.0
    stiffness: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """How the beam is simulated: `tisim.Beam`'s layer [m] and rings, time step [s], tolerance of the static
    stage and of each step of the motion (1e-4 moves the bar's end by 7e-9 m against 1e-6).

    What the defaults leave on a real bar stands in docs/bar.md.
    """

    layer: float = 0.020
    rings: int = 1
    time_step: float = 2e-3
    tolerance: float = 1e-6
    motion_tolerance: float = 1e-4


@dataclass(frozen=True, kw_only=True)
class Nuisances:
    """Standard deviations of what is not known of a trial; 0 leaves one out.

    position: of each coordinate of a marker's place [m]. frame: of the rotation between the frame that the
    displacements are stated in and the beam's, about each axis [rad]; gravity keeps its stated direction.
    offset: of a constant displacement of each marker from the release on [m], in the motion only: a large one
    leaves the swing alone to speak.
    """

    position: float = 1e-3
    frame: float = float(np.radians(2.0))
    offset: float = 0.0
