"""Comparison of the noise stated by the lab with the scatter of the data.

Without repeats, a record determines only its scatter about a smooth curve, which is an upper bound of the
noise from point to point; it does not show an error that all of its points share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from calibration._numerics import robust_sd
from calibration.measurements._variance_components import VarianceComponents

Array = NDArray[np.float64]

Source = Literal["stated", "data"]

FEWEST = 12  # least number of third differences for an estimate of a record's scatter
# Points of a curve per degree of freedom of the noise that its scatter shows: it is the median of residuals
# from neighbours, which are correlated (3.4 to 4.1 for 20 to 300 points: studies/diagnosis).
POINTS_PER_FREEDOM = 4.0
FACTOR = 2.0  # ratio between stated and observed noise from which they contradict each other
_WEIGHTS = np.array([1.0, -3.0, 3.0, -1.0])  # third difference: zero for a parabola


@dataclass(frozen=True, kw_only=True)
class PointNoise:
    """Noise of one record from point to point.

    Attributes
    ----------
    record : name of the record.
    stated : True if the lab states the noise; otherwise it was assumed.
    assumed : stated or assumed standard deviation of a point, median over the record [SI].
    shown : upper bound of the standard deviation from the record's scatter [SI].
    points : number of third differences that `shown` is estimated from.
    """

    record: str
    stated: bool
    assumed: float
    shown: float
    points: int

    @property
    def factor(self) -> float:
        """shown / assumed."""
        return self.shown / self.assumed

    @property
    def contradicts(self) -> bool:
        """True if the stated noise differs from the observed scatter by more than FACTOR."""
        return self.stated and not 1.0 / FACTOR <= self.factor <= FACTOR


@dataclass(frozen=True, kw_only=True)
class NoiseKnown:
    """Summary of an experiment's noise.

    Attributes
    ----------
    source : noise in use: "stated" by the lab (a default if it is not), or from the "data".
    known : True if the lab states the noise of all records, or repeats determine it.
    dof : degrees of freedom of the noise estimate; inf if it is taken as known.
    points : noise of each record from point to point.
    repeats : names of the tests whose repeats determine the scatter between tests.
    components : variance components from repeats, if the kind of measurement has no own model of them.
    unit : unit of rms residuals in files, and the number of these units per SI unit.
    """

    source: Source = "stated"
    known: bool = True
    dof: float = inf
    points: tuple[PointNoise, ...] = ()
    repeats: tuple[str, ...] = ()
    components: VarianceComponents = field(default_factory=VarianceComponents)
    unit: tuple[str, float] = ("", 1.0)

    @property
    def scale(self) -> float:
        """Upper bound of the noise from point to point, relative to the assumed noise; at most 1.

        It is below 1 if an assumed error exceeds the scatter (errors of areas and load cells are shared by
        all points of a record). 1 if the lab states the noise of any record.
        """
        unstated = [p for p in self.points if not p.stated]
        if not unstated or len(unstated) < len(self.points):
            return 1.0
        total = sum(p.points * min(p.factor, 1.0) ** 2 for p in unstated)
        return sqrt(total / sum(p.points for p in unstated))

    def sentences(self) -> list[str]:
        """Sentences for reports: contradictions with the data, scatter of repeats, unknown noise."""
        found = []
        name, per_si = self.unit
        for larger, text in ((False, "less"), (True, "more")):
            off = [p for p in self.points if p.contradicts and (p.factor > 1.0) == larger]
            if not off:
                continue
            stated = per_si * float(np.median([p.assumed for p in off]))
            shown = per_si * float(np.median([p.shown for p in off]))
            used = (
                "what the data show is used"
                if self.source == "data"
                else "what is stated is used; --noise data takes what the data show"
            )
            found.append(
                f"the data scatter by {text} than the lab states in {len(off)} of {len(self.points)} records:"
                f" {shown:.2g} {name} from point to point, stated {stated:.2g} {name} ({used})"
            )
        found += self.components.sentences()
        if not self.known:
            found.append(
                "the noise is not known: the lab does not state it, and no test was repeated often enough to"
                " show it. Explained fractions and p-values hold for the assumed noise"
            )
        return found

    def to_json(self) -> dict[str, Any]:
        name, per_si = self.unit
        return {
            "source": self.source,
            "known": self.known,
            "repeats": list(self.repeats),
            "layers": self.components.to_json(),
            "records": [
                {
                    "record": p.record,
                    "stated": p.stated,
                    f"assumed_{name}": per_si * p.assumed,
                    f"shown_at_most_{name}": per_si * p.shown,
                }
                for p in self.points
            ],
        }


STATED = NoiseKnown()


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimated:
    """Rows whose standard deviation was estimated from their own scatter, in groups of one estimate each.

    Attributes
    ----------
    group : group of each residual, shape (m,); -1 where the noise is stated.
    freedom : degrees of freedom of the estimate of each group, shape (groups,).
    """

    group: NDArray[np.intp]
    freedom: Array

    @property
    def least(self) -> float:
        """Degrees of freedom of the most uncertain estimate; inf if all noise is stated."""
        return float(self.freedom.min(initial=inf))

    def over_estimate(self, draws: int, rng: np.random.Generator) -> Array:
        """Noise over what it is estimated as: sqrt(nu / chi2_nu) of each residual, shape (draws, m)."""
        each = np.sqrt(self.freedom / rng.chisquare(self.freedom, (draws, len(self.freedom))))
        return np.hstack([each, np.ones((draws, 1))])[:, self.group]


def roughness(values: Array) -> tuple[float, int]:
    """Standard deviation of white noise on a smooth curve of values (k,), and the number of differences used.

    Robust estimate from the median absolute third difference; an upper bound if the curve is not smooth.
    """
    if len(values) < len(_WEIGHTS):
        return 0.0, 0
    left = np.convolve(values, _WEIGHTS, mode="valid")
    left = left[np.isfinite(left)]
    if not left.size:
        return 0.0, 0
    return float(robust_sd(left) / np.linalg.norm(_WEIGHTS)), int(left.size)


def typical(values: Sequence[float]) -> float:
    """Median; 0 for an empty sequence."""
    return float(np.median(values)) if len(values) else 0.0
