"""How sure a search has to be, and how far it looks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Progress = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class Rules:
    """Levels and limits of a search.

    Attributes
    ----------
    false_alarm_rate : probability of naming a cause where there is none.
    extra_cause_rate : probability of naming one cause too many.
    lack_of_fit_level : p-value below which what a fit leaves of the residuals counts as unexplained.
    score_tolerance : explanations within this of the best score (chi-square) are equivalent.
    shortlist : effects that are confirmed in the simulator.
    pairs : pairs of causes that are confirmed.
    max_causes : causes that are named together, where the model allows as many.
    triples : pairs that a third cause is looked for beside, and thirds of each that are confirmed.
    seed : of the bootstrap.
    """

    false_alarm_rate: float = 0.02
    extra_cause_rate: float = 0.003
    lack_of_fit_level: float = 0.005
    score_tolerance: float = 6.0
    shortlist: int = 7
    pairs: int = 5
    max_causes: int = 3
    triples: tuple[int, int] = (2, 3)
    seed: int = 0
