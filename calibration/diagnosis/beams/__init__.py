"""Diagnosis of photographed beams: the catalogue's effects nested in their FEM."""

from calibration.diagnosis.beams._candidates import reaches
from calibration.diagnosis.beams._pictures import feet_of
from calibration.diagnosis.beams.effects import EFFECTS, BeamEffect, Situation
from calibration.diagnosis.beams.model import BeamModel
from calibration.diagnosis.beams.simulators import OURS, SIMULATORS, Simulator

__all__ = [
    "EFFECTS",
    "OURS",
    "SIMULATORS",
    "BeamEffect",
    "BeamModel",
    "Simulator",
    "Situation",
    "feet_of",
    "reaches",
]
