"""Cross-validation: how much an extension improves predictions of measurements that its fit has not seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import LONGEST, TOLERANCE, Fit, fit
from calibration.diagnosis.engine.skill import Prediction, skill, together
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]

KEPT = 0.5  # fraction of an amplitude's information that every training set must keep
FALLBACK = 0.2  # below this, no fold of a set is used at all
UNSEEN_STEPS = 10  # of Gauss-Newton, over the coordinates that only a fold tells of


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
    parts : the prediction of each fold.
    amplitudes : of the extension's candidates, fitted without each fold, shape (folds, c) [SI].
    """

    held_out: str
    kept: float
    rms_before: float
    rms_after: float
    rms_noise: float
    log_likelihood: float
    folds: int
    note: str = ""
    parts: tuple[Prediction, ...] = ()
    amplitudes: tuple[tuple[float, ...], ...] = ()

    @property
    def skill(self) -> float:
        """Of all folds together; NaN where nothing was held out, or the baseline has nothing to gain."""
        return skill(self.rms_before, self.rms_after, self.rms_noise) if self.held_out else math.nan

    @property
    def helps_everywhere(self) -> bool:
        """Whether the extension predicts every fold better than the baseline does."""
        return bool(self.parts) and all(p.helps for p in self.parts)


def held_out_improvement(model: MeasurementModel, baseline: Fit, chosen: Fit) -> HeldOut:
    """Fit baseline and extension to all measurements but one fold and predict that fold, for each fold of the
    first set that leaves at least KEPT of the information in training (of the best set otherwise)."""
    kept = {name: _kept(model, folds, chosen) for name, folds in model.folds().items()}
    usable = {name: k for name, k in kept.items() if k >= KEPT}
    name = next(iter(usable), None) or max(kept, key=lambda n: kept[n], default=None)
    if name is None or kept[name] < FALLBACK:
        return _nothing(max(kept.values(), default=0.0), "no fold leaves enough of the effect in training")
    folds = model.folds()[name]
    parts, amplitudes, better = [], [], 0.0
    for left_out, fold in folds:
        try:
            before = _predicted(model, fold, baseline, ())
            after = _predicted(model, fold, chosen, chosen.candidates)
        except ValueError as problem:
            return _nothing(kept[name], f"{name}: {left_out} cannot be predicted: {problem}")
        parts.append(
            Prediction(
                name=left_out,
                points=before.points,
                rms_before=before.rms,
                rms_after=after.rms,
                rms_noise=model.subset(fold, others=False).noise_rms(),
            )
        )
        amplitudes.append(tuple(after.state.amplitudes[c] for c in chosen.candidates))
        better += 0.5 * (before.chi2 - after.chi2)
    whole = together(parts)
    return HeldOut(
        held_out=name,
        kept=kept[name],
        rms_before=whole.rms_before,
        rms_after=whole.rms_after,
        rms_noise=whole.rms_noise,
        log_likelihood=better,
        folds=len(folds),
        parts=tuple(parts),
        amplitudes=tuple(amplitudes),
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


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fold:
    """A fold predicted from all other measurements.

    state: as trained on the others, with what they do not tell fitted to the fold. chi2, rms [SI], points: of
    the fold's measurements alone, without the prior.
    """

    state: State
    chi2: float
    rms: float
    points: int


def _predicted(
    model: MeasurementModel, fold: NDArray[np.bool_], full: Fit, candidates: tuple[Candidate, ...]
) -> _Fold:
    trained = fit(model.subset(fold, others=True), full.state, candidates).state
    test = model.subset(fold, others=False)
    state = _with_unseen(test, trained, model.unconstrained(fold))
    z = test.residuals([state])[0][: test.points]
    return _Fold(state=state, chi2=float(z @ z), rms=test.distance_rms(state), points=test.points)


def _with_unseen(test: MeasurementModel, trained: State, unseen: NDArray[np.bool_]) -> State:
    """The coordinates that only the fold tells of (the modulus of a material that was left out, a release
    time) fitted to it. What the training tells of, and the amplitudes, stay as they were trained: were the
    seen ones to move beside the unseen, these would take up what belongs to those."""
    if not unseen.any():
        return trained
    state, now = trained, _squares(test, trained)
    for _ in range(UNSEEN_STEPS):
        linear = test.linearise(state, ())
        size = np.linalg.norm(linear.by_u, axis=0)
        used = unseen & (size > 0.0)
        move = np.zeros(len(state.u))
        move[used] = -np.linalg.lstsq(linear.by_u[:, used] / size[used], linear.z, rcond=1e-6)[0] / size[used]
        move *= min(1.0, LONGEST / max(float(np.abs(move).max(initial=0.0)), LONGEST))
        for part in 0.5 ** np.arange(5):
            moved = State(u=state.u + part * move, amplitudes=state.amplitudes)
            squares = _squares(test, moved)
            if squares < now:
                break
        else:
            return state
        gained, state, now = now - squares, moved, squares
        if gained < TOLERANCE:
            break
    return state


def _squares(test: MeasurementModel, state: State) -> float:
    z = test.residuals([state])[0]
    squares = float(z @ z)
    return squares if np.isfinite(squares) else float("inf")
