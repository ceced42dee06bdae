"""How sure a search has to be, and how far it looks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Tell = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class Rules:
    """alarm: chance of naming a cause where there is none; second: of one cause too many.
    unlike: chance below which what a fit leaves of the residuals counts as unexplained.
    within: of chi-square: what explains the data nearly as well as the best is a rival.
    shortlist: effects that are confirmed in the simulator; pairs: pairs of them.
    most: causes that are named together, where the model allows as many. beside: pairs that a third is looked
    for beside, and how many thirds of each are confirmed.
    seed: of the bootstrap.
    """

    alarm: float = 0.02
    second: float = 0.003
    unlike: float = 0.005
    within: float = 6.0
    shortlist: int = 7
    pairs: int = 5
    most: int = 3
    beside: tuple[int, int] = (2, 3)
    seed: int = 0
