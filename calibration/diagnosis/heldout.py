"""What an extension buys on measurements that its fit has not seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.fitting import Fit, fit
from calibration.diagnosis.nested import Nested, State

Array = NDArray[np.float64]

LEFT = 0.5  # part of an amplitude's information that every training set must keep
FALLBACK = 0.2  # below this, no fold of a family is used at all


class Foldable(Nested, Protocol):
    """Nested measurements that can be split. families: sets of groups of measurements by name, in order of
    preference; rows: where a group's measurements stand, (m,) boolean."""

    def families(self) -> Mapping[str, Sequence[tuple[str, object]]]: ...

    def rows(self, group: object) -> NDArray[np.bool_]: ...

    def part(self, group: object, *, others: bool) -> Foldable:
        """The measurements of a group, or all others; nuisances stay as they were taken."""

    def unseen(self, group: object) -> NDArray[np.bool_]:
        """Which coordinates u nothing outside of the group tells of, (n,)."""

    def distance_rms(self, state: State) -> float:
        """rms distance between measured and simulated, nuisances taken out [SI]."""

    def noise_rms(self) -> float:
        """What `distance_rms` would be of the noise alone."""


@dataclass(frozen=True, kw_only=True)
class Gain:
    """held_out: the family of folds, "" where none keeps the effect estimable; kept: least part of the
    information on its amplitudes in a training set. rms before and after, and what noise alone would leave
    [SI]; log_likelihood gained."""

    held_out: str
    kept: float
    rms_before: float
    rms_after: float
    rms_noise: float
    log_likelihood: float
    folds: int
    note: str = ""


def held_out_gain(model: Foldable, baseline: Fit, chosen: Fit) -> Gain:
    """Fit baseline and extension to all measurements but one group, predict that group, for each group of the
    first family that leaves at least LEFT of the information in training (the best one otherwise)."""
    kept = {name: _kept(model, groups, chosen) for name, groups in model.families().items()}
    usable = {name: k for name, k in kept.items() if k >= LEFT}
    name = next(iter(usable), None) or max(kept, key=lambda n: kept[n], default=None)
    if name is None or kept[name] < FALLBACK:
        return _nothing(max(kept.values(), default=0.0), "no fold leaves enough of the effect in training")
    groups = model.families()[name]
    squares, gained, count = np.zeros(3), 0.0, 0
    for left_out, group in groups:
        try:
            before = _predicted(model, group, baseline, ())
            after = _predicted(model, group, chosen, chosen.candidates)
        except ValueError as problem:
            return _nothing(kept[name], f"{name}: {left_out} cannot be predicted: {problem}")
        noise = model.part(group, others=False).noise_rms()
        squares += np.array([before[1], after[1], noise]) ** 2 * before[2]
        count += before[2]
        gained += 0.5 * (before[0] - after[0])
    rms = np.sqrt(squares / count)
    return Gain(
        held_out=name,
        kept=kept[name],
        rms_before=float(rms[0]),
        rms_after=float(rms[1]),
        rms_noise=float(rms[2]),
        log_likelihood=gained,
        folds=len(groups),
    )


def _nothing(kept: float, note: str) -> Gain:
    nan = float("nan")
    return Gain(
        held_out="",
        kept=kept,
        rms_before=nan,
        rms_after=nan,
        rms_noise=nan,
        log_likelihood=0.0,
        folds=0,
        note=note,
    )


def _kept(model: Foldable, groups: Sequence[tuple[str, object]], chosen: Fit) -> float:
    """Least part of any amplitude's information that a training set keeps."""
    if len(groups) < 2:
        return 0.0
    everything = _information(chosen, np.ones(len(chosen.z), dtype=bool))
    parts = [_information(chosen, ~model.rows(group)) / everything for _, group in groups]
    return float(np.min(parts))


def _information(chosen: Fit, rows: NDArray[np.bool_]) -> Array:
    """One over the variance of each amplitude, from some of the rows."""
    n = len(chosen.state.u)
    found = []
    jacobian = chosen.jacobian[rows]
    for k in range(n, jacobian.shape[1]):
        others = np.delete(jacobian, k, axis=1)
        size = np.linalg.norm(others, axis=0)
        q, _ = np.linalg.qr(others[:, size > 0] / size[size > 0])
        left = jacobian[:, k] - q @ (q.T @ jacobian[:, k])
        found.append(float(left @ left))
    return np.array(found)


def _predicted(
    model: Foldable, group: object, full: Fit, candidates: tuple[Candidate, ...]
) -> tuple[float, float, int]:
    """Chi-square, rms distance and count of a group's measurements, predicted from all others."""
    trained = fit(model.part(group, others=True), full.state, candidates).state
    test = model.part(group, others=False)
    unseen = model.unseen(group)
    if unseen.any():
        # a modulus that only this group tells of is fitted to it, with the effect as trained
        alone = _only_u(test, trained)
        trained = State(u=np.where(unseen, alone.u, trained.u), amplitudes=trained.amplitudes)
    z = test.residuals([trained])[0]
    return float(z @ z), test.distance_rms(trained), test.points


def _only_u(test: Foldable, state: State) -> State:
    for _ in range(4):
        linear = test.linearise(state, ())
        size = np.linalg.norm(linear.by_u, axis=0)
        move = np.zeros(len(state.u))
        used = size > 0
        move[used] = -np.linalg.lstsq(linear.by_u[:, used] / size[used], linear.z, rcond=1e-6)[0] / size[used]
        state = State(u=state.u + np.clip(move, -0.5, 0.5), amplitudes=state.amplitudes)
        if np.abs(move).max(initial=0.0) < 2e-3:
            break
    return state
