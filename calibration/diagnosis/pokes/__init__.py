"""Diagnosis of pokes: force against depth of rods in blocks, with the catalogue's effects nested in them."""

from calibration.diagnosis.pokes.effects import EFFECTS, PokeEffect
from calibration.diagnosis.pokes.model import PokeModel

__all__ = ["EFFECTS", "PokeEffect", "PokeModel"]
