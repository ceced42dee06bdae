"""Outlines of beams against simulated ones: the likelihood of what was traced."""

from calibration.outlines.objective import COARSE, REFERENCE, Fidelity, OutlineObjective, Photograph

__all__ = ["COARSE", "REFERENCE", "Fidelity", "OutlineObjective", "Photograph"]
