"""Markers through time: a beam let go, its ring-down and where it settles, as an objective."""

from calibration.motion._trial import hung_mass
from calibration.motion.fit import MotionFit, fit_motion
from calibration.motion.kinematics import Motion, marker_displacements, marker_motion
from calibration.motion.objective import MarkerObjective, Match
from calibration.motion.ringdown import RingDown, ringdown
from calibration.motion.settings import Damping, Fidelity, Nuisances

__all__ = [
    "Damping",
    "Fidelity",
    "MarkerObjective",
    "Match",
    "Motion",
    "MotionFit",
    "Nuisances",
    "RingDown",
    "fit_motion",
    "hung_mass",
    "marker_displacements",
    "marker_motion",
    "ringdown",
]
