"""The diagnosis under test, of coupons or pokes in a folder that holds no truth: what is scored of it."""

from __future__ import annotations

from typing import Any

from calibration.diagnosis import Diagnosable, Finding, search
from calibration.diagnosis.heldout import held_out_gain


def told(model: Diagnosable) -> tuple[Finding, dict[str, Any]]:
    """The search, and the part of `diagnosis.json` that is scored; rms in the model's own unit."""
    finding = search(model)
    chosen = finding.chosen
    causes: list[dict[str, Any]] = []
    found: dict[str, Any] = {
        "verdict": finding.verdict,
        "causes": causes,
        "alternatives": [list(names) for names in finding.rivals],
        "extended": None,
        "gain": None,
        "departure": {"p": finding.departure.p, "chance": finding.chance, "worst": finding.departure.worst},
        "baseline": {"shear_modulus_Pa": model.shear_moduli(finding.baseline.state.u)},
        "tried": [(e.fit.reports(), e.fit.chi2, e.departure.p) for e in finding.explanations],
    }
    if chosen is None:
        return finding, found
    for c in chosen.candidates:
        effect = model.effects[c.effect]
        value, sd = chosen.fit.amplitude(c)
        causes.append(
            {
                "effect": c.effect,
                "label": c.label,
                "parameters": {effect.parameter: {"value": effect.in_file(value), "sd": effect.in_file(sd)}},
                "scope": c.at,
                "confidence": finding.confidence,
            }
        )
    found["extended"] = {"shear_modulus_Pa": model.shear_moduli(chosen.fit.state.u)}
    gain = held_out_gain(model, finding.baseline, chosen.fit)
    found["gain"] = {
        "held_out": gain.held_out or "none",
        "rms_before": gain.rms_before,
        "rms_after": gain.rms_after,
        "rms_noise": gain.rms_noise,
        "log_likelihood": gain.log_likelihood,
    }
    return finding, found
