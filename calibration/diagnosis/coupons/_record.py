"""A coupon's record, thinned, with what its history was: branches, the largest strain before, the rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.coupons import SMALLEST_RELATIVE, relative_sd, scatter_scale, slope
from calibration.diagnosis.coupons._branches import Branch, branches_of, rates_of, turning
from calibration.diagnosis.coupons._kinematics import first_excess
from calibration.diagnosis.records import bins
from calibration.experiment.model import CouponMode, CouponTrial

Array = NDArray[np.float64]

MOST = 100  # points that are kept of a branch: more are averaged in bins of neighbours


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """The points of one trial, in the order in which they were measured; all arrays (k,).

    name: of the trial. specimen: whose modulus it has. stress, sd [Pa]. time [s], NaN where the lab has none.
    turn: while unloading, I1 - 3 at the turning point before, NaN otherwise. peak: the largest I1 - 3 that
    the specimen has seen so far. reloaded: whether it was loaded again after an unloading; remembers: after
    one in another trial. rate [1/s]: of the stretch; in a hold, the stretch over the time since its ramp
    began; NaN where there is no time.
    estimated: the lab states no error of the stress, and sd comes from the scatter.
    """

    name: str
    material: str
    specimen: str
    mode: CouponMode
    stretch: Array
    stress: Array
    sd: Array
    time: Array
    branch: Array
    turn: Array
    peak: Array
    reloaded: bool
    remembers: bool
    rate: Array
    estimated: bool

    @property
    def points(self) -> int:
        return self.stretch.size

    @property
    def unloads(self) -> bool:
        return bool(np.isfinite(self.turn).any())

    def only(self, kept: NDArray[np.bool_]) -> Record:
        """Some of its points."""
        arrays = ("stretch", "stress", "sd", "time", "branch", "turn", "peak", "rate")
        return replace(self, **{name: getattr(self, name)[kept] for name in arrays})


def records_of(trials: Sequence[CouponTrial]) -> list[Record]:
    """One record a trial. A named specimen's trials were done in the order of the file, so that it remembers
    in one of them what it was strained to in those before."""
    found: list[Record] = []
    seen: dict[tuple[str, str], float] = {}
    for t in trials:
        own = (t.specimen or f"trial {t.id}", t.mode)
        record = _record(t, seen.get(own, 0.0))
        found.append(record)
        top = float(first_excess(t.mode, record.stretch).max())
        seen[own] = max(seen.get(own, 0.0), top)
    return found


def _record(trial: CouponTrial, before: float) -> Record:
    parts = branches_of(trial)
    excess = first_excess(trial.mode, trial.stretch)
    turn = np.full(excess.size, np.nan)
    for b in parts[1:]:
        unloading = _unloading(trial, b)
        turn[b.points] = np.where(unloading, excess[b.points.start], np.nan)
    raw_time = np.full(excess.size, np.nan) if trial.time is None else trial.time
    raw_rate = rates_of(trial, parts)
    peak = np.maximum.accumulate(np.maximum(excess, before))
    rows: dict[str, list[Array]] = {n: [] for n in _AVERAGED}
    sds, numbers = [], []
    for n, b in enumerate(parts):
        first, count = bins(b.points, MOST)
        raw = {
            "stretch": trial.stretch,
            "stress": trial.stress,
            "time": raw_time,
            "turn": turn,
            "peak": peak,
            "rate": raw_rate,
        }
        mean = {name: np.add.reduceat(x[b.points], first) / count for name, x in raw.items()}
        for name in _AVERAGED:
            rows[name].append(mean[name])
        sds.append(_sd(trial, b, mean["stretch"], mean["stress"], count))
        numbers.append(np.full(first.size, float(n)))
    whole = {name: np.concatenate(parts_) for name, parts_ in rows.items()}
    again = before > 0.0 or bool(np.isfinite(turn).any() and _loads_again(turn))
    return Record(
        name=trial.id,
        material=trial.material,
        specimen=trial.specimen or trial.material,
        mode=trial.mode,
        sd=np.concatenate(sds),
        branch=np.concatenate(numbers),
        reloaded=again,
        remembers=before > 0.0,
        estimated=trial.stress_sd is None,
        **whole,
    )


_AVERAGED = ("stretch", "stress", "time", "turn", "peak", "rate")


def _unloading(trial: CouponTrial, b: Branch) -> NDArray[np.bool_]:
    """Which points of a branch go back to rest, apart from noise about rest; beyond it they load again."""
    s = trial.stretch[b.points]
    noise = turning(trial)
    gone = b.direction * (s - 1.0)
    if gone[0] > -noise:
        return np.zeros(s.size, dtype=bool)
    return np.full(s.size, True) if gone.max() <= noise else gone < 0.0


def _loads_again(turn: Array) -> bool:
    """Whether a loading follows an unloading."""
    unloading = np.isfinite(turn)
    return bool((~unloading[int(np.argmax(unloading)) :]).any())


def _sd(trial: CouponTrial, b: Branch, stretch: Array, stress: Array, count: Array) -> Array:
    """Of the means in bins [Pa]. An error estimated from the scatter stays at least what areas and gauges are
    known to, however many points are averaged."""
    if trial.stress_sd is None:
        one = relative_sd(trial.stretch[b.points], trial.stress[b.points])
        relative = np.maximum(one / np.sqrt(count), SMALLEST_RELATIVE)
        largest = np.abs(trial.stress).max(initial=0.0)
        own = relative * np.maximum(scatter_scale(stress), _FLOOR * largest)
    else:
        own = trial.stress_sd / np.sqrt(count)
    if trial.stretch_sd == 0.0:
        return np.asarray(own)
    return np.asarray(np.hypot(own, slope(stretch, stress) * trial.stretch_sd / np.sqrt(count)))


_FLOOR = 0.05  # as in `calibration.coupons`: below this part of the largest stress an error stays what it is
