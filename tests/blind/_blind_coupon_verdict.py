"""The diagnosis under test, on a folder that holds no truth: what `diagnosis.json` would say of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.coupons.advice import advise
from calibration.diagnosis.heldout import held_out_gain
from calibration.diagnosis.search import search
from calibration.experiment import read


def verdict_on(folder: Path, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """The part of the format that is scored; rms in the model's own unit."""
    model = CouponModel(read(folder), without=without)
    finding = search(model)
    chosen = finding.chosen
    causes: list[dict[str, Any]] = []
    found: dict[str, Any] = {
        "verdict": finding.verdict,
        "causes": causes,
        "alternatives": [list(names) for names in finding.rivals],
        "extended": None,
        "gain": None,
        "next": None,
        "departure": {"p": finding.departure.p, "chance": finding.chance},
        "tried": [(e.fit.reports(), e.fit.chi2, e.departure.p) for e in finding.explanations],
    }
    if chosen is None:
        return found
    for c in chosen.candidates:
        effect = model.effects[c.effect]
        value, sd = chosen.fit.amplitude(c)
        causes.append(
            {
                "effect": c.effect,
                "parameters": {effect.parameter: {"value": effect.in_file(value), "sd": effect.in_file(sd)}},
                "scope": c.at,
                "confidence": finding.confidence,
            }
        )
    if finding.verdict == "ambiguous":
        one_each = [next(e for e in finding.explanations if e.names == names) for names in finding.rivals]
        found["next"] = advise(model, one_each)[0].name
    found["extended"] = {"shear_modulus_Pa": model.shear_moduli(chosen.fit.state.u)}
    gain = held_out_gain(model, finding.baseline, chosen.fit)
    found["gain"] = {
        "held_out": gain.held_out or "none",
        "rms_before": gain.rms_before,
        "rms_after": gain.rms_after,
        "rms_noise": gain.rms_noise,
        "log_likelihood": gain.log_likelihood,
    }
    return found
