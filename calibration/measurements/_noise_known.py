"""What is known of the noise: what the lab states, what the data show, and which of the two was used.

Without repeats a record shows its own scatter about a smooth curve, which is an upper bound of what differs
from point to point, and nothing of an error that all of its points share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._layers import Layers

Array = NDArray[np.float64]

Source = Literal["stated", "data"]

FEWEST = 12  # points of a record that show their scatter
FACTOR = 2.0  # between what is stated and what the data show, from which on they contradict each other
_WEIGHTS = np.array([1.0, -3.0, 3.0, -1.0])  # a third difference: of a parabola it is zero
_NORMAL = 1.4826  # standard deviations in a median absolute deviation


@dataclass(frozen=True, kw_only=True)
class PointNoise:
    """The noise of one record, point by point.

    Attributes
    ----------
    record : its name.
    stated : whether the lab states it; otherwise it was guessed.
    assumed : standard deviation of a point, the median over the record [SI].
    shown : what the scatter of the record shows at most [SI].
    points : that show it.
    """

    record: str
    stated: bool
    assumed: float
    shown: float
    points: int

    @property
    def factor(self) -> float:
        """What is shown over what was assumed."""
        return self.shown / self.assumed

    @property
    def contradicts(self) -> bool:
        """True if what the lab states is not what the data show."""
        return self.stated and not 1.0 / FACTOR <= self.factor <= FACTOR


@dataclass(frozen=True, kw_only=True)
class NoiseKnown:
    """What is known of an experiment's noise.

    Attributes
    ----------
    source : what was used: what the lab states (or, where it does not, the usual), or what the data show.
    known : whether the lab states it, or repeats show it.
    dof : degrees of freedom of its estimate; inf where it is taken as known.
    points : what each record shows.
    repeats : names of the tests that show how one differs from the next.
    layers : what they show, where the kind of measurement does not model it.
    unit : of rms residuals in files, and how many of them one SI unit is.
    """

    source: Source = "stated"
    known: bool = True
    dof: float = inf
    points: tuple[PointNoise, ...] = ()
    repeats: tuple[str, ...] = ()
    layers: Layers = field(default_factory=Layers)
    unit: tuple[str, float] = ("", 1.0)

    @property
    def scale(self) -> float:
        """What the noise from point to point is at most, over what was assumed: below 1 where an error that
        nobody stated was taken for larger than the scatter (areas and load cells have errors that all points
        of a record share)."""
        unstated = [p for p in self.points if not p.stated]
        if not unstated or len(unstated) < len(self.points):
            return 1.0
        total = sum(p.points * min(p.factor, 1.0) ** 2 for p in unstated)
        return sqrt(total / sum(p.points for p in unstated))

    def sentences(self) -> list[str]:
        """For people: what is not known, what contradicts what."""
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
        found += self.layers.sentences()
        if not self.known:
            found.append(
                "the noise is not known: the lab does not state it, and no test was repeated often enough to"
                " show it. Shares and chances hold for what was assumed"
            )
        return found

    def to_json(self) -> dict[str, Any]:
        name, per_si = self.unit
        return {
            "source": self.source,
            "known": self.known,
            "repeats": list(self.repeats),
            "layers": self.layers.to_json(),
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


def roughness(values: Array) -> tuple[float, int]:
    """Standard deviation of white noise on smooth values (k,) in the order of their curve, from third
    differences, robustly; an upper bound where the curve itself is not smooth. With it the number of
    differences."""
    if len(values) < len(_WEIGHTS):
        return 0.0, 0
    left = np.convolve(values, _WEIGHTS, mode="valid")
    left = left[np.isfinite(left)]
    if not left.size:
        return 0.0, 0
    return float(_NORMAL * np.median(np.abs(left)) / np.linalg.norm(_WEIGHTS)), int(left.size)


def typical(values: Sequence[float]) -> float:
    """Median; 0 of nothing."""
    return float(np.median(values)) if len(values) else 0.0
