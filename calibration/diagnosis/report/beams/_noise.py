"""The noise model of photographed beams in words."""

from __future__ import annotations

import numpy as np

from calibration.diagnosis.beams import BeamModel
from calibration.report import significant


def noise(model: BeamModel) -> str:
    """What the distances' covariance consists of."""
    outlines = [p.outline for p in model.pictures]
    sd, correlation = (_span([1e3 * getattr(o, name) for o in outlines]) for name in ("sd", "correlation"))
    registration = [o.registration for o in outlines]
    shift = _span([1e3 * r.shift for r in registration])
    roll = _span([float(np.degrees(r.roll)) for r in registration])
    scale = _span([100.0 * r.scale for r in registration])
    text = (
        f"{len(outlines)} photographs; the contour's error {sd} mm, correlated over {correlation} mm; where"
        f" each photograph lies: {shift} mm, {roll}°, {scale} % of scale; section, free length and density as"
        " the lab states them with a standard deviation."
    )
    if model.uncorrected:
        return f"{text} The mesh's error is not corrected: {model.uncorrected}."
    return f"{text} The mesh's error is corrected by a finer mesh; a part of the correction is left as noise."


def _span(values: list[float]) -> str:
    low, high = significant(min(values), 2), significant(max(values), 2)
    return low if low == high else f"{low} to {high}"
