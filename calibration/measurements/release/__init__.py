"""Cantilever releases: markers of a beam in free vibration and at static equilibrium."""

from calibration.measurements.release._nuisances import HELD
from calibration.measurements.release._record import hung_mass, why_no_record
from calibration.measurements.release.kinematics import Motion, marker_displacements, marker_motion
from calibration.measurements.release.objective import Damping, Fidelity, MarkerObjective, Match, Nuisances
from calibration.measurements.release.ringdown import RingDown, ringdown

__all__ = [
    "HELD",
    "Damping",
    "Fidelity",
    "MarkerObjective",
    "Match",
    "Motion",
    "Nuisances",
    "RingDown",
    "hung_mass",
    "marker_displacements",
    "marker_motion",
    "ringdown",
    "why_no_record",
]
