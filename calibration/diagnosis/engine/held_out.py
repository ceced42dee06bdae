"""Cross-validation: how much an extension improves predictions of measurements that its fit has not seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit, fit
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]

KEPT = 0.5  # fraction of an amplitude's information that every training set must keep
FALLBACK = 0.2  # below this, no fold of a set is used at all


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """Held-out scores of a baseline and its extension.

    Attributes
    ----------
    held_out : name of the set of folds; "" where none keeps the effects identifiable.
    kept : least fraction of the information on an amplitude in a training set.
    rms_before, rms_after, rms_noise : of the held-out residuals, by the baseline, by the extension, and of
        noise alone [SI].
    log_likelihood : improvement on the held-out measurements.
    folds : how many.
    note : why nothing was held out.
    """

    held_out: str
    kept: float
    rms_before: float
    rms_after: float
    rms_noise: float
    log_likelihood: float
    folds: int
    note: str = ""


def held_out_improvement(model: MeasurementModel, baseline: Fit, chosen: Fit) -> HeldOut:
    """Fit baseline and extension to all measurements but one fold and predict that fold, for each fold of the
    first set that leaves at least KEPT of the information in training (of the best set otherwise)."""
    kept = {name: _kept(model, folds, chosen) for name, folds in model.folds().items()}
    usable = {name: k for name, k in kept.items() if k >= KEPT}
    name = next(iter(usable), None) or max(kept, key=lambda n: kept[n], default=None)
    if name is None or kept[name] < FALLBACK:
        return _nothing(max(kept.values(), default=0.0), "no fold leaves enough of the effect in training")
    folds = model.folds()[name]
    squares, better, count = np.zeros(3), 0.0, 0
    for left_out, fold in folds:
        try:
            before = _predicted(model, fold, baseline, ())
            after = _predicted(model, fold, chosen, chosen.candidates)
        except ValueError as problem:
            return _nothing(kept[name], f"{name}: {left_out} cannot be predicted: {problem}")
        noise = model.subset(fold, others=False).noise_rms()
        squares += np.array([before[1], after[1], noise]) ** 2 * before[2]
        count += before[2]
        better += 0.5 * (before[0] - after[0])
    rms = np.sqrt(squares / count)
    return HeldOut(
        held_out=name,
        kept=kept[name],
        rms_before=float(rms[0]),
        rms_after=float(rms[1]),
        rms_noise=float(rms[2]),
        log_likelihood=better,
        folds=len(folds),
    )


def _nothing(kept: float, note: str) -> HeldOut:
    nan = float("nan")
    return HeldOut(
        held_out="",
        kept=kept,
        rms_before=nan,
        rms_after=nan,
        rms_noise=nan,
        log_likelihood=0.0,
        folds=0,
        note=note,
    )


def _kept(model: MeasurementModel, folds: Sequence[tuple[str, NDArray[np.bool_]]], chosen: Fit) -> float:
    """Least fraction of any amplitude's information that a training set keeps."""
    if len(folds) < 2:
        return 0.0
    everything = _information(chosen, np.ones(len(chosen.z), dtype=bool))
    parts = [_information(chosen, ~model.rows(fold)) / everything for _, fold in folds]
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
    model: MeasurementModel, fold: NDArray[np.bool_], full: Fit, candidates: tuple[Candidate, ...]
) -> tuple[float, float, int]:
    """Chi-square, rms distance and number of a fold's measurements, predicted from all others."""
    trained = fit(model.subset(fold, others=True), full.state, candidates).state
    test = model.subset(fold, others=False)
    alone_here = model.unconstrained(fold)
    if alone_here.any():
        # a modulus that only this fold constrains is fitted to it, with the effect as trained
        alone = _only_u(test, trained)
        trained = State(u=np.where(alone_here, alone.u, trained.u), amplitudes=trained.amplitudes)
    z = test.residuals([trained])[0]
    return float(z @ z), test.distance_rms(trained), test.points


def _only_u(test: MeasurementModel, state: State) -> State:
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
