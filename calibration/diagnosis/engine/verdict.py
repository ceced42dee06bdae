"""A diagnosis: its numbers, its file (`diagnosis.json`), and one sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.held_out import HeldOut
from calibration.diagnosis.engine.search import Finding
from calibration.measurements._effect import Candidate, HandedOn
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]

FORMAT = 1


@dataclass(frozen=True, kw_only=True)
class Undetectable:
    """An effect that this design cannot detect.

    Attributes
    ----------
    threshold : 5 standard deviations of its amplitude, in the file's unit; inf where no amplitude shows.
    remedy : what to do about it.
    """

    effect: str
    parameter: str
    threshold: float
    remedy: str


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """A fit in numbers.

    Attributes
    ----------
    reduced_chi2 : over the degrees of freedom.
    p_value : of the test for lack of fit.
    rms : of the residuals, in the unit of the diagnosis.
    shear_modulus_Pa : by material.
    """

    reduced_chi2: float
    p_value: float
    rms: float
    shear_modulus_Pa: dict[str, float]

    def to_json(self, unit: str) -> dict[str, Any]:
        return {
            "reduced_chi2": self.reduced_chi2,
            "p_value": self.p_value,
            f"rms_{unit}": self.rms,
            "shear_modulus_Pa": self.shear_modulus_Pa,
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Subject:
    """What was diagnosed, as cards need it.

    Attributes
    ----------
    kind : of measurement.
    unit : of rms residuals in files ("mm", "kPa", "N"), and how many of them one SI unit is.
    law, bulk_ratio : of the baseline; K/G that it holds.
    modulus_weights : derivatives of the logarithm of each material's shear modulus by the baseline's
        coordinates, shape (n,).
    ranges : between what each named candidate was measured, by the quantity's name in files.
    materials : that each named candidate concerns.
    handed_on : the part of each material that each named candidate is, where it is one.
    """

    kind: str
    unit: tuple[str, float]
    law: str = "neo-hookean"
    bulk_ratio: float = 300.0
    modulus_weights: Mapping[str, Array] = field(default_factory=dict)
    ranges: Mapping[Candidate, Mapping[str, tuple[float, float]]] = field(default_factory=dict)
    materials: Mapping[Candidate, frozenset[str]] = field(default_factory=dict)
    handed_on: Mapping[Candidate, Mapping[str, HandedOn]] = field(default_factory=dict)

    @classmethod
    def of(cls, model: MeasurementModel, fit: Fit) -> Subject:
        """Of a model, and the fit that is reported."""
        base = model.baseline
        return cls(
            kind=model.kind,
            unit=model.unit,
            law=base.law.law,
            bulk_ratio=base.bulk_ratio,
            modulus_weights={m: base.modulus_weights(m, fit.state.u) for m in base.materials},
            ranges={c: model.valid_range(c) for c in fit.candidates},
            materials={
                c: frozenset(
                    r.material for r, hit in zip(model.records, model.reached(c), strict=True) if hit
                )
                for c in fit.candidates
            },
            handed_on={c: model.hands_on(c, fit.state) for c in fit.candidates},
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis:
    """All that is known of an experiment. chosen: the explanation that is named, refined; it, extended and
    held_out are None where no cause is named."""

    finding: Finding
    chosen: Explanation | None
    effects: dict[str, Any]
    baseline: Numbers
    extended: Numbers | None
    held_out: HeldOut | None
    subject: Subject
    next_experiment: str
    undetectable: tuple[Undetectable, ...]
    notes: tuple[str, ...]
    seconds: float

    @property
    def unit(self) -> tuple[str, float]:
        """Of rms residuals in files, and how many of them one SI unit is."""
        return self.subject.unit

    @property
    def fit(self) -> Fit:
        """With the named causes; the baseline's where none is named."""
        return self.finding.baseline if self.chosen is None else self.chosen.fit

    def causes(self) -> list[dict[str, Any]]:
        """One entry for each effect of the chosen explanation."""
        return [] if self.chosen is None else _causes(self.chosen, self.effects, self.finding.confidence)

    def to_json(self) -> dict[str, Any]:
        found: dict[str, Any] = {
            "format": FORMAT,
            "verdict": self.finding.verdict,
            "causes": self.causes(),
            "alternatives": [list(names) for names in self.finding.equivalent],
            "baseline": self.baseline.to_json(self.unit[0]),
            "extended": self.extended.to_json(self.unit[0]) if self.extended else None,
            "gain": None,
            "next_experiment": self.next_experiment,
            "not_visible": [
                {
                    "effect": i.effect,
                    i.parameter: i.threshold if math.isfinite(i.threshold) else None,
                    "instead": i.remedy,
                }
                for i in self.undetectable
            ],
            "notes": list(self.notes),
            "seconds": round(self.seconds, 1),
        }
        if self.held_out is not None:
            g, (unit, per_si) = self.held_out, self.unit
            found["gain"] = {
                "held_out": g.held_out or "none",
                f"rms_{unit}_before": per_si * g.rms_before if g.held_out else None,
                f"rms_{unit}_after": per_si * g.rms_after if g.held_out else None,
                f"rms_{unit}_noise": per_si * g.rms_noise if g.held_out else None,
                "log_likelihood": g.log_likelihood if g.held_out else None,
                "information_kept": g.kept,
                "note": g.note,
            }
        return found

    def sentence(self) -> str:
        """The verdict for people."""
        verdict = self.finding.verdict
        if verdict == "none":
            return "The simulation agrees with the measurements to within their noise: no cause to name."
        if verdict == "unexplained":
            return (
                "The measurements depart from the simulation, and no effect of the catalogue explains how:"
                " look at the residuals."
            )
        chosen = self.chosen
        assert chosen is not None
        parts = [
            f"{self.effects[c.effect].sentence}{'' if c.at == 'all' else f' ({c.at})'}"
            for c in chosen.candidates
        ]
        named = " and ".join(parts) if len(parts) < 3 else f"{'; '.join(parts[:-1])}; and {parts[-1]}"
        if verdict == "found":
            return f"Found: {named} ({' + '.join(chosen.names)})."
        others = "; or ".join(" + ".join(names) for names in self.finding.equivalent[1:])
        return (
            f"Something is wrong, but these data cannot say which: most likely {named}"
            f" ({' + '.join(chosen.names)}); or {others}."
        )


def _causes(chosen: Explanation, effects: dict[str, Any], confidence: float) -> list[dict[str, Any]]:
    found = []
    for c in chosen.candidates:
        effect = effects[c.effect]
        value, sd = chosen.fit.amplitude(c)
        parameters = {effect.parameter: {"value": effect.in_file(value), "sd": abs(effect.in_file(sd))}}
        if c.position is not None:
            parameters["position"] = {"value": c.position, "sd": 0.1}
        entry = {
            "effect": c.effect,
            "parameters": parameters,
            "scope": c.at,
            "confidence": round(confidence, 4),
        }
        said = getattr(c, "variant_name", "")  # which of an effect's forms, where its domain has several
        found.append({**entry, "kind": said} if said else entry)
    return found


def undetectable(model: MeasurementModel, finding: Finding) -> tuple[Undetectable, ...]:
    """Effects of which all measurements together would need more than is plausible to show 5 sigma."""
    found = []
    for name, effect in model.effects.items():
        sizes = [
            s
            for c, s in zip(finding.screened.candidates, finding.screened.sizes, strict=True)
            if c.effect == name and (c.at == "all" or not any(o.at == "all" for o in _of(finding, name)))
        ]
        if not sizes:
            continue  # no measurement that it could touch
        threshold = 5.0 / max(sizes) if max(sizes) > 0.0 else math.inf
        if threshold > effect.prior_scale:
            found.append(
                Undetectable(
                    effect=name,
                    parameter=effect.parameter,
                    threshold=float(abs(effect.in_file(threshold))),
                    remedy=effect.remedy,
                )
            )
    return tuple(found)


def _of(finding: Finding, name: str) -> list[Any]:
    return [c for c in finding.screened.candidates if c.effect == name]


def reduced(fit: Fit) -> float:
    """Chi-square over its degrees of freedom: rows of residuals less the rank of the Jacobian."""
    size = np.linalg.norm(fit.jacobian, axis=0)
    used = fit.jacobian[:, size > 0.0] / size[size > 0.0]
    rank = int(np.linalg.matrix_rank(used)) if used.size else 0
    return fit.chi2 / (len(fit.z) - rank)
