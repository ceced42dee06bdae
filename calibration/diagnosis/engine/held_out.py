"""Cross-validation: improvement of predictions of held-out measurements by an extension of the baseline."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtrc  # scipy.stats takes 0.3 s to import

from calibration.diagnosis.engine.fitting import LONGEST, TOLERANCE, Fit, fit
from calibration.diagnosis.engine.skill import Prediction, skill, together
from calibration.measurements._effect import Candidate
from calibration.measurements._model import MeasurementModel
from calibration.measurements._state import State

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

KEPT = 0.5  # least fraction of an amplitude's information in every training set
FALLBACK = 0.2  # least such fraction, if no set of folds keeps KEPT
VISIBLE = 5.0  # standard deviations from which an effect is visible in a fold
SEEN = 10.0  # least amplitude in standard deviations from every training set, if neither holds
ROUNDING = 1e-7  # relative length of an amplitude's column, without the coordinates, that is rounding error
UNCONSTRAINED_STEPS = 10  # Gauss-Newton steps over the coordinates that only a fold determines


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """Held-out scores of a baseline and its extension.

    Attributes
    ----------
    held_out : name of the set of folds; "" if nothing was held out.
    kept : least fraction of an amplitude's information that a training set keeps. For a switch, which has no
        estimated amplitude, see `_certain`.
    rms_before, rms_after : rms of the held-out residuals of the baseline and of the extension [SI].
    rms_noise : rms of noise alone [SI].
    log_likelihood : improvement of the log-likelihood of the held-out measurements.
    folds : number of folds.
    note : why nothing was held out, or which folds were not predicted.
    parts : prediction of each fold.
    amplitudes : amplitudes of the extension's candidates, fitted without each fold, shape (folds, c) [SI].
    acts : True for each fold in which some effect, at its fitted amplitude, is visible.
    within : True if folds divide single records, so that errors common to a record are in the training set.
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
    acts: tuple[bool, ...] = ()
    within: bool = False

    @property
    def skill(self) -> float:
        """Skill of all folds together; NaN if nothing was held out or the baseline is within noise."""
        return skill(self.rms_before, self.rms_after, self.rms_noise) if self.held_out else math.nan

    @property
    def helps_everywhere(self) -> bool:
        """True if the extension helps (`Prediction.helps`) in every fold in which it acts."""
        return bool(self.parts) and not self.worse

    @property
    def worse(self) -> tuple[str, ...]:
        """Names of the folds in which the extension acts but does not help.

        An effect that is visible in no single fold (a law with further constants) counts as acting in all.
        """
        return tuple(p.name for p, own in zip(self.parts, self._acting, strict=True) if own and not p.helps)

    def helps_mostly(self, *, least_skill: float, sure: float, draws: int, seed: int) -> bool:
        """True if the extension improves significantly many folds and has enough skill over all folds.

        The number of improved folds passes a one-sided sign test at the confidence level `sure`, and the
        quantile 1 - `sure` of the skill over bootstrap replicates of the folds is at least `least_skill`.
        """
        acting = sum(self._acting)
        better = acting - len(self.worse)
        if not acting or bdtrc(better - 1, acting, 0.5) > 1.0 - sure:
            return False
        count = len(self.parts)
        times = np.random.default_rng(seed).multinomial(count, np.full(count, 1.0 / count), size=draws)
        points = times * np.array([p.points for p in self.parts])
        before, after, noise = (
            points @ np.array([getattr(p, f"rms_{which}") ** 2 for p in self.parts])
            for which in ("before", "after", "noise")
        )
        # a replicate in which the baseline leaves no more than noise shows no skill
        explainable = before - noise
        skills = np.divide(before - after, explainable, out=np.full(draws, -1.0), where=explainable > 0.0)
        return bool(np.quantile(skills, 1.0 - sure) >= least_skill)

    @property
    def _acting(self) -> tuple[bool, ...]:
        return self.acts if any(self.acts) else (True,) * len(self.parts)


def held_out_improvement(
    model: MeasurementModel, baseline: Fit, chosen: Fit, *, known: Predictions | None = None
) -> HeldOut:
    """Predict each fold of the set that `_choice` selects, with baseline and extension fitted to all others.

    `known` is a cache of the baseline's predictions, to which new ones are added.
    """
    known = {} if known is None else known
    choice = _choice(model, baseline, chosen)
    if not choice.folds:
        return _nothing(choice.kept, "no fold leaves enough of the effect in training")
    name, folds = choice.name, choice.folds
    parts, amplitudes, better = [], [], 0.0
    for left_out, fold in folds:
        try:
            if (name, left_out) not in known:
                known[name, left_out] = _predicted(model, fold, baseline, ())
            before = known[name, left_out]
            after = _predicted(model, fold, chosen, chosen.candidates)
        except ValueError as problem:
            return _nothing(choice.kept, f"{name}: {left_out} cannot be predicted: {problem}")
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
        kept=choice.kept,
        rms_before=whole.rms_before,
        rms_after=whole.rms_after,
        rms_noise=whole.rms_noise,
        log_likelihood=better,
        folds=len(folds),
        note=choice.note,
        parts=tuple(parts),
        amplitudes=tuple(amplitudes),
        acts=tuple(bool(_visible(model, fold, chosen).any()) for _, fold in folds),
        within=_within(model, [fold for _, fold in folds]),
    )


def _within(model: MeasurementModel, folds: Sequence[Rows]) -> bool:
    """True if some record has rows in several folds."""
    used = model.noise.used
    return any(
        sum(bool((fold & used & (model.row_record == k)).any()) for fold in folds) > 1
        for k in np.unique(model.row_record[used])
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


@dataclass(frozen=True, eq=False, kw_only=True)
class _Choice:
    """Folds that are predicted.

    Attributes
    ----------
    name : name of the set of folds.
    folds : names and rows of its folds; empty if no set is admissible.
    kept : least fraction of an amplitude's information that a training set keeps.
    note : folds of the set that are not predicted, for people.
    """

    name: str = ""
    folds: Sequence[tuple[str, Rows]] = ()
    kept: float = 0.0
    note: str = ""


def _choice(model: MeasurementModel, baseline: Fit, chosen: Fit) -> _Choice:
    """Select the set of folds to predict, by the first of these criteria that a set meets.

    1. Every training set keeps at least `KEPT` of the information (first such set).
    2. Every training set keeps at least `FALLBACK` (the set that keeps most).
    3. At least two folds in which all effects are visible keep `KEPT`; only these are predicted, since the
       others would be extrapolations (first such set).
    4. Every amplitude is at least `SEEN` standard deviations in every training set (first such set).
    """
    sets = []
    for name, folds in model.folds().items():
        if len(folds) < 2:
            continue
        kept = _kept(model, folds, baseline, chosen)
        if kept.min() >= KEPT:
            return _Choice(name=name, folds=folds, kept=float(kept.min()))
        sets.append((name, folds, kept))
    name, folds, worst = max(sets, key=lambda s: float(s[2].min()), default=("", [], np.zeros(1)))
    if worst.min() >= FALLBACK:
        return _Choice(name=name, folds=folds, kept=float(worst.min()))
    for name, folds, kept in sets:
        some = [
            k for k in range(len(folds)) if kept[k] >= KEPT and _visible(model, folds[k][1], chosen).all()
        ]
        if len(some) > 1:
            left = ", ".join(folds[k][0] for k in range(len(folds)) if k not in some)
            return _Choice(
                name=name,
                folds=[folds[k] for k in some],
                kept=float(kept[some].min()),
                note="Not predicted, since the others do not determine the effect, or it does not act"
                f" there: {left}.",
            )
    least = min(abs(value) / sd for value, sd in map(chosen.amplitude, chosen.candidates))
    for name, folds, own in sets:
        if least * np.sqrt(own.min()) >= SEEN:
            return _Choice(name=name, folds=folds, kept=float(own.min()))
    return _Choice(kept=float(worst.min()))


def _kept(model: MeasurementModel, folds: Sequence[tuple[str, Rows]], baseline: Fit, chosen: Fit) -> Array:
    """Least fraction of any amplitude's information that remains without each fold, shape (folds,).

    The amplitude of a switch is not estimated; the fraction of `_certain` is used for it.
    """
    switches = np.array([model.effects[c.effect].switch for c in chosen.candidates])
    n = len(chosen.state.u)
    everything = _information(chosen, np.ones(len(chosen.z), dtype=bool))
    found = []
    for _, fold in folds:
        left = model.rows(fold)
        own = (_information(chosen, ~left) / everything)[~switches]
        if switches.any():
            estimated = np.r_[np.ones(n, dtype=bool), ~switches]
            own = np.r_[own, _certain(baseline, chosen, left, estimated)]
        found.append(float(own.min()))
    return np.array(found)


def _certain(baseline: Fit, chosen: Fit, left: Rows, estimated: Rows) -> float:
    """Fraction of a fold's misfit that the other rows predict with certainty: 1 - V / S, not below 0.

    V is the variance of the fold's prediction from all other rows, times the reduced chi-square of the
    extension if that exceeds 1 (Birge ratio). S is the baseline's sum of squares in the fold.
    """
    jacobian = chosen.jacobian[:, estimated]
    size = np.linalg.norm(jacobian, axis=0)
    scaled = jacobian / np.where(size > 0.0, size, 1.0)
    trained = np.linalg.pinv(scaled[~left].T @ scaled[~left], hermitian=True)
    spread = float(np.einsum("ij,jk,ik->", scaled[left], trained, scaled[left]))
    ratio = max(chosen.chi2 / max(len(chosen.z) - int(estimated.sum()), 1), 1.0)
    missed = float(np.sum(baseline.z[left] ** 2))
    return max(1.0 - ratio * spread / missed, 0.0) if missed > 0.0 else 0.0


def _visible(model: MeasurementModel, fold: Rows, chosen: Fit) -> Rows:
    """True for each amplitude of at least `VISIBLE` standard deviations in this fold alone, shape (c,)."""
    values = np.array([chosen.state.amplitudes[c] for c in chosen.candidates])
    return np.asarray(values**2 * _information(chosen, model.rows(fold)) >= VISIBLE**2)


def _information(chosen: Fit, rows: Rows) -> Array:
    """Inverse variance of each amplitude from these rows, all other parameters being free, shape (c,)."""
    n = len(chosen.state.u)
    jacobian = chosen.jacobian[rows]
    others, own = jacobian[:, :n], jacobian[:, n:]
    size = np.linalg.norm(others, axis=0)
    q, _ = np.linalg.qr(others[:, size > 0] / size[size > 0])
    left = own - q @ (q.T @ own)
    seen = np.linalg.norm(left, axis=0) > ROUNDING * np.linalg.norm(own, axis=0)
    found = []
    for k in range(left.shape[1]):
        beside = left[:, seen & (np.arange(left.shape[1]) != k)]
        q, _ = np.linalg.qr(beside / np.linalg.norm(beside, axis=0))
        alone = left[:, k] - q @ (q.T @ left[:, k])
        found.append(float(alone @ alone))
    return np.array(found)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fold:
    """A fold predicted from all other measurements.

    Attributes
    ----------
    state : fitted to the other measurements; coordinates that these do not constrain are fitted to the fold.
    chi2, rms, points : chi-square, rms residual [SI] and number of the fold's measurements, without prior.
    """

    state: State
    chi2: float
    rms: float
    points: int


Predictions = dict[tuple[str, str], _Fold]  # by set of folds and fold


def _predicted(model: MeasurementModel, fold: Rows, full: Fit, candidates: tuple[Candidate, ...]) -> _Fold:
    others = model.subset(fold, others=True)
    trained = fit(others, _nearer(model, others, fold, full), candidates).state
    test = model.subset(fold, others=False)
    state = _with_unconstrained(test, trained, model.unconstrained(fold))
    z = test.residuals([state])[0][: test.points]
    return _Fold(state=state, chi2=float(z @ z), rms=test.distance_rms(state), points=test.points)


def _nearer(model: MeasurementModel, others: MeasurementModel, fold: Rows, full: Fit) -> State:
    """Start for the fit to the other measurements: a first-order step from the fit to all measurements.

    It reuses the Jacobian of that fit, and returns its state if the step does not lower chi-square.
    """
    there = full.state
    jacobian, z = full.jacobian[~model.rows(fold)], full.z[~model.rows(fold)]
    switches = [model.effects[c.effect].switch for c in full.candidates]
    size = np.linalg.norm(jacobian, axis=0)
    free = (size > 0.0) & ~np.r_[np.zeros(len(there.u), dtype=bool), np.array(switches, dtype=bool)]
    move = np.zeros(jacobian.shape[1])
    move[free] = -np.linalg.lstsq(jacobian[:, free] / size[free], z, rcond=1e-6)[0] / size[free]
    moved = np.array([*there.amplitudes.values()]) + move[len(there.u) :]
    nearer = State(
        u=there.u + move[: len(there.u)],
        amplitudes=dict(zip(there.amplitudes, moved.tolist(), strict=True)),
    )
    return nearer if _squares(others, nearer) < _squares(others, there) else there


def _with_unconstrained(test: MeasurementModel, trained: State, unconstrained: Rows) -> State:
    """Fit the coordinates that only the fold constrains to it (`unconstrained`, shape (n,)).

    Examples are the modulus of a material that was left out, or a release time. All other coordinates and the
    amplitudes stay as trained: if free, they would absorb misfit that these coordinates explain.
    """
    if not unconstrained.any():
        return trained
    state, now = trained, _squares(test, trained)
    for _ in range(UNCONSTRAINED_STEPS):
        linear = test.linearise(state, ())
        size = np.linalg.norm(linear.by_u, axis=0)
        used = unconstrained & (size > 0.0)
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
