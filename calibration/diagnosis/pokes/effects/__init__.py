"""The effects on pokes. A new one is a file with an EFFECT, and its line here.

Not here, since `tisim` cannot simulate them yet: `skin` (a poke has one material) and `base-slip` (a block's
base is fixed in all directions). Where one of them is at work, the verdict is "unexplained" or the name of
what looks alike.
"""

from calibration.diagnosis.pokes.effects import (
    adhesion,
    depth_offset,
    force_drift,
    force_gain,
    force_offset,
    friction,
    inclusion_debonded,
    inclusion_misplaced,
    mullins,
    relaxation,
    rod_angle,
    thickness,
)
from calibration.diagnosis.pokes.effects._effect import PokeEffect

_ALL = (
    friction,
    rod_angle,
    depth_offset,
    force_gain,
    force_offset,
    force_drift,
    relaxation,
    mullins,
    adhesion,
    inclusion_debonded,
    inclusion_misplaced,
    thickness,
)

EFFECTS: dict[str, PokeEffect] = {module.EFFECT.name: module.EFFECT for module in _ALL}

__all__ = ["EFFECTS", "PokeEffect"]
