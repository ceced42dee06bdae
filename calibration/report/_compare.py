"""Which law of a material leads, and which of the others this data can tell from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

from calibration.study.calibration import Calibration
from calibration.study.cards import best, usable

# Burnham and Anderson, Model Selection and Multimodel Inference (2002), 2.6: a difference below 2 leaves a
# model substantial support, one above 10 essentially none.
ALIKE, REFUTED = 2.0, 10.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """The laws of one material.

    chosen: the law with the smallest chi-square + 2 n among finished fits, else the best so far of stopped
    ones. differences: by label, (chi2 - chi2 of the chosen) / scale + 2 (n - n of the chosen), of finished
    fits only. scale: reduced chi-square of the chosen law, at least 1, so that a law which misses the data by
    more than the noise does not beat others by parts of its own error.
    """

    chosen: Calibration
    differences: Mapping[str, float]
    scale: float

    @property
    def alike(self) -> tuple[str, ...]:
        """Labels that cannot be told from the chosen law, which is one of them."""
        return tuple(n for n, d in self.differences.items() if d < ALIKE)

    @property
    def refuted(self) -> tuple[str, ...]:
        return tuple(n for n, d in self.differences.items() if d > REFUTED)

    @property
    def misses(self) -> bool:
        """Whether the chosen law's chi-square is above what noise makes of it, by three sd."""
        freedom = max(1, self.chosen.points - len(self.chosen.u))
        return self.chosen.reduced_chi2 > 1.0 + 3.0 * sqrt(2.0 / freedom)


def compare(results: Sequence[Calibration]) -> Comparison | None:
    """Compare the laws of one material; None where no fit has parameters."""
    chosen = best(results)
    if chosen is None:
        stopped = [r for r in results if r.parameters]
        if not stopped:
            return None
        chosen = min(stopped, key=_akaike)
    scale = max(1.0, chosen.reduced_chi2)
    differences = {
        r.label: (r.chi2 - chosen.chi2) / scale + 2.0 * (len(r.u) - len(chosen.u))
        for r in results
        if usable(r)
    }
    return Comparison(chosen=chosen, differences=differences, scale=scale)


def _akaike(result: Calibration) -> float:
    return result.chi2 + 2.0 * len(result.u)
