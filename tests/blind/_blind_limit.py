"""How far rivals are from the truth on data without noise, and how often that lets any finder be right."""

from __future__ import annotations

import math

from calibration.diagnosis import Diagnosable
from calibration.diagnosis.explanation import explain
from calibration.diagnosis.null import Null
from calibration.diagnosis.screening import screen
from calibration.diagnosis.search import calibrated

PROMISING = 12  # candidates that are fitted, those of the truth beside


def least_fits(model: Diagnosable, truth: str) -> dict[str, float]:
    """Least chi-square of each effect on a model's measurements, which have no noise; truth: an effect."""
    baseline = calibrated(model)
    linear = model.linearise(baseline.state, model.candidates)
    screened = screen(linear, model.effects)
    null = Null(len(linear.z), model.patterns(), seed=0)
    gains, amplitudes = screened.gains(linear.z), screened.amplitudes(linear.z)
    least: dict[str, float] = {}
    for rank, k in enumerate(sorted(range(len(gains)), key=lambda k: -gains[k])):
        candidate = model.candidates[k]
        if rank >= PROMISING and candidate.effect != truth:
            continue
        found = explain(model, baseline, (candidate,), [float(amplitudes[k])], null)
        if found is not None:
            least[candidate.effect] = min(found.fit.chi2, least.get(candidate.effect, math.inf))
    return least


def told(least: dict[str, float], truth: str) -> tuple[str, float]:
    """The nearest rivals for people, and the part of experiments in which no more than that ranks the truth
    first."""
    own = least[truth]
    near = sorted((chi2 - own, name) for name, chi2 in least.items() if name != truth)[:3]
    most = chance(near[0][0]) if near else 1.0
    rivals = ", ".join(f"{name} {d2:.2f}" for d2, name in near)
    return f"chi-square {own:.1f}: {rivals}; first in {most:.0%}", most


def chance(nearest: float) -> float:
    """Part of experiments in which the truth outdoes a rival whose chi-square without noise is this much
    larger."""
    return 0.5 * (1.0 + math.erf(math.sqrt(max(nearest, 0.0) / 8.0)))
