"""Poses that no indentation can have: their limits, and the words in which they are refused.

`learn.scene_file` and the live page (`learn.page`) refuse them in millimetres, `learn.real_time` in metres.
Where the tip comes to the inclusion is computed by `learn.quantities.obstacle`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple, Self

from learn.data.setup import Setup
from learn.quantities import Obstacle

Unit = Literal["mm", "m"]
_PER_METRE = {"mm": 1e3, "m": 1.0}

STEEPEST = 45.0  # [degrees]: largest angle between push and normal, as in the simulator
TOLERANCE = 1e-6  # of the vertical component of a push
LEAST_COSINE = math.cos(math.radians(STEEPEST)) - TOLERANCE  # less is refused as steeper than STEEPEST
ANGLE_TEXT = f"expected at most {STEEPEST:g} degrees from the vertical"
INCLUSION_TEXT = (
    "expected less than {depth} {unit}, where the tip would be within the rigid inclusion, which lies under "
    "{cover} {unit} of cover there"
)


class SiteLimits(NamedTuple):
    """Limits of a contact point and of the depth in one block [m].

    `low` and `high` are the least and the largest (x, y), a radius of the indenter from the sides; the depth
    has to stay below `height`, that of the block.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    height: float

    @classmethod
    def of(cls, setup: Setup) -> Self:
        """Limits in the block of a setup."""
        return cls.around(setup.block_size, setup.middle.tolist(), setup.rod_radius)

    @classmethod
    def around(cls, size: Sequence[float], middle: Sequence[float], radius: float) -> Self:
        """Limits in a block of this size around the middle of its top, for an indenter of this radius [m]."""
        (length, width, height), (x, y) = size, middle
        half = length / 2 - radius, width / 2 - radius
        return cls((x - half[0], y - half[1]), (x + half[0], y + half[1]), height)

    def site_text(self, unit: Unit) -> str:
        """The limits of a contact point in words."""
        factor = _PER_METRE[unit]
        x, y = (f"{factor * a:.4g} to {factor * b:.4g}" for a, b in zip(self.low, self.high, strict=True))
        return f"expected x within {x} {unit} and y within {y} {unit} (the block less the indenter's radius)"

    def height_text(self, unit: Unit) -> str:
        """The limit of the depth in words."""
        return f"expected less than the block's height of {_PER_METRE[unit] * self.height:.4g} {unit}"


def in_inclusion(met: Obstacle, unit: Unit) -> str:
    """The largest depth of a push that meets an inclusion in words."""
    depth, cover = (f"{_PER_METRE[unit] * length:.3g}" for length in (met.depth, met.cover))
    return INCLUSION_TEXT.format(depth=depth, cover=cover, unit=unit)
