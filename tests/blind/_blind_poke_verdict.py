"""The diagnosis under test, on a folder that holds no truth: what `diagnosis.json` would say of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from calibration.diagnosis.heldout import held_out_gain
from calibration.diagnosis.pokes import PokeModel
from calibration.diagnosis.search import search
from calibration.experiment import read


def verdict_on(folder: Path, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """The part of the format that is scored; rms in the model's own unit."""
    model = PokeModel(read(folder), without=without, workers=1)
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
        "simulated": model.curves.simulated,
        "core_seconds": model.curves.core_seconds,
    }
    if chosen is None:
        return found
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
        "log_likelihood": gain.log_likelihood,
    }
    return found
