"""Search along one coordinate: each generation cuts the interval around the best candidate into equal parts.

CMA-ES learns how coordinates go together; along a single one it takes five to ten times as many candidates as
sections that narrow. `Section` has the part of `cma.CMAEvolutionStrategy` that `search` uses.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NARROWEST = 1e-4  # of the first interval: the best candidate lies where answers end
WIDER = 2.0  # where the best candidate is the outermost one, the next section reaches so much further


class Section:
    """Minimum along one coordinate.

    A generation lies evenly across an interval about the best candidate so far. The next interval ends at the
    best one's neighbours; where the best is the outermost on its side, it is wider and lies about that one.

    Parameters
    ----------
    start, reach : float
        The first interval is `start` plus and minus `reach`.
    bounds : (low, high)
        No candidate lies outside.
    popsize : int
        Candidates a generation, 4 or more.
    tolerance : float
        The search ends where the best candidate's neighbours cost no more than this above it, or where
        the interval is narrower than 1e-4 of the first.
    """

    def __init__(
        self, start: float, reach: float, *, bounds: tuple[float, float], popsize: int, tolerance: float
    ) -> None:
        self.popsize = popsize
        self._bounds = bounds
        self._tolerance = tolerance
        self._low, self._high = self._inside(start - reach), self._inside(start + reach)
        self._narrowest = NARROWEST * (self._high - self._low)
        self._known: dict[float, float] = {}
        self._flat = False

    def ask(self) -> list[Array]:
        """The next candidates, each of shape (1,)."""
        known = [x in self._known for x in (self._low, self._high)]
        places = np.linspace(self._low, self._high, self.popsize + sum(known))
        found = places[int(known[0]) : len(places) - int(known[1])]
        return [np.array([x]) for x in found]

    def tell(self, candidates: Sequence[Array], costs: Sequence[float]) -> None:
        """Take the costs of candidates."""
        self._known.update({float(u[0]): float(c) for u, c in zip(candidates, costs, strict=True)})
        places = np.array(sorted(self._known))
        found = np.array([self._known[x] for x in places])
        best = int(found.argmin())
        before, after = max(best - 1, 0), min(best + 1, len(places) - 1)
        self._low, self._high = float(places[before]), float(places[after])
        width = float(places[-1] - places[0])
        if before == best:
            self._low = self._inside(places[best] - WIDER * width)
        if after == best:
            self._high = self._inside(places[best] + WIDER * width)
        ends = [found[k] for k in (before, after) if k != best]
        inside = len(ends) == 2 or self._low == self._high or places[best] in self._bounds
        self._flat = inside and max(ends, default=0.0) - float(found[best]) <= self._tolerance

    def stop(self) -> dict[str, float]:
        """Why the search is at its end, as `cma` says it; empty where it is not."""
        if self._flat:
            return {"tolfun": self._tolerance}
        return {"tolx": self._narrowest} if self._high - self._low < self._narrowest else {}

    def _inside(self, x: float) -> float:
        return float(np.clip(x, *self._bounds))
