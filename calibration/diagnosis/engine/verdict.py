"""Result of a diagnosis: its numbers, its file (`diagnosis.json`) and its verdict in a sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.explanation import Explanation, Names
from calibration.diagnosis.engine.fitting import Fit
from calibration.diagnosis.engine.held_out import HeldOut
from calibration.diagnosis.engine.model_error import ModelError
from calibration.diagnosis.engine.partly import Assessed
from calibration.diagnosis.engine.remainder import Remainder
from calibration.diagnosis.engine.search import Finding
from calibration.diagnosis.engine.sentences import sentence
from calibration.diagnosis.engine.shares import Interval
from calibration.measurements._effect import Candidate, HandedOn
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise_known import STATED, NoiseKnown
from calibration.parameters import Parameters, implausible

Array = NDArray[np.float64]

FORMAT = 2


@dataclass(frozen=True, kw_only=True)
class Undetectable:
    """An effect that this design cannot detect.

    Attributes
    ----------
    effect : its name.
    parameter : name of its amplitude in files, which ends with the unit.
    threshold : 5 standard deviations of its amplitude in the file's unit; inf if no amplitude is detectable.
    remedy : recommended measure on the bench.
    """

    effect: str
    parameter: str
    threshold: float
    remedy: str


@dataclass(frozen=True, kw_only=True)
class Numbers:
    """Summary of a fit.

    Attributes
    ----------
    reduced_chi2 : chi-square per degree of freedom.
    p_value : p-value of the test for lack of fit.
    rms : root mean square of the residuals, in the unit of the diagnosis.
    shear_modulus_Pa : shear modulus by material [Pa].
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
    """Data of the model and the reported fit that material cards need.

    Attributes
    ----------
    kind : kind of measurement.
    unit : unit of rms residuals in files ("mm", "kPa", "N"), and its number per SI unit.
    law : material law of the baseline.
    bulk_ratio : fixed ratio K/G of the baseline.
    modulus_weights : derivatives of ln G of each material by the baseline's coordinates, shape (n,).
    ranges : measured range for each named candidate, by the quantity's name in files.
    materials : materials that each named candidate concerns.
    other_laws : law and its parameters at the fitted modulus, for each material in which an effect replaces
        the baseline's law.
    handed_on : for each named candidate, its contribution to the constitutive model of each material.
    """

    kind: str
    unit: tuple[str, float]
    law: str = "neo-hookean"
    bulk_ratio: float = 300.0
    modulus_weights: Mapping[str, Array] = field(default_factory=dict)
    ranges: Mapping[Candidate, Mapping[str, tuple[float, float]]] = field(default_factory=dict)
    materials: Mapping[Candidate, frozenset[str]] = field(default_factory=dict)
    other_laws: Mapping[str, tuple[str, Parameters]] = field(default_factory=dict)
    handed_on: Mapping[Candidate, Mapping[str, HandedOn]] = field(default_factory=dict)

    @classmethod
    def of(cls, model: MeasurementModel, fit: Fit) -> Subject:
        """Collect the data from a model and the fit that is reported."""
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
            other_laws={m: own for m in base.materials if (own := model.law_in(m, fit.state)) is not None},
            handed_on={c: model.hands_on(c, fit.state) for c in fit.candidates},
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis:
    """Result of a diagnosis.

    Attributes
    ----------
    finding : result of the search.
    chosen : the explanation that is named, refined; None if none is named.
    effects : effects of the model by name.
    baseline : numbers of the baseline's fit in the search.
    extended : numbers of the refined fit with the named causes; None if none is named.
    held_out : held-out scores of the named explanation; None if none is named or they were not computed.
    subject : data of the model and the reported fit.
    next_experiment : recommended next experiment or check; "" if there is none.
    undetectable : effects that this design cannot detect.
    notes : remarks on noise, model, fits and alternatives, a sentence each.
    seconds : wall time [s].
    share : fraction of the explainable misfit that the chosen explanation removes.
    shares : Shapley values of its causes, which add up to `share`.
    resampled : groups that the bootstrap intervals are over, in words; "" if there is no bootstrap.
    nearest : if the data are unexplained, the explanation that comes nearest.
    equally_large : if the data are partly explained, alternative sets of effects with their explained
        fractions.
    remainder : unexplained misfit; None if the baseline leaves only noise.
    model_error : the unexplained misfit as a model error; None unless more than noise is left.
    noise : knowledge of the noise.
    """

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
    share: Interval | None = None
    shares: Mapping[Candidate, Interval] = field(default_factory=dict)
    resampled: str = ""
    nearest: Assessed | None = None
    equally_large: Mapping[Names, Interval] = field(default_factory=dict)
    remainder: Remainder | None = None
    model_error: ModelError | None = None
    noise: NoiseKnown = STATED

    @property
    def unit(self) -> tuple[str, float]:
        """Unit of rms residuals in files, and its number per SI unit."""
        return self.subject.unit

    @property
    def fit(self) -> Fit:
        """Fit with the named causes; the baseline's fit if none is named."""
        return self.finding.baseline if self.chosen is None else self.chosen.fit

    @property
    def implausible(self) -> tuple[str, ...]:
        """A sentence for each material whose shear modulus no soft material has."""
        moduli = (self.extended or self.baseline).shear_modulus_Pa
        return tuple(f"{name}: {why}" for name, g in moduli.items() if (why := implausible(g)))

    def causes(self) -> list[dict[str, Any]]:
        """One entry of diagnosis.json for each cause of the chosen explanation."""
        if self.chosen is None:
            return []
        found = _causes(self.chosen, self.effects, self.finding.confidence)
        for cause, c in zip(found, self.chosen.candidates, strict=True):
            own = self.shares.get(c)
            cause["share"] = None if own is None else _interval(own)
        return found

    def to_json(self) -> dict[str, Any]:
        """Content of diagnosis.json (docs/explanation/diagnosis.md)."""
        unit = self.unit
        return {
            "format": FORMAT,
            "kind": self.subject.kind,
            "verdict": self.finding.verdict,
            "sentence": self.sentence(),
            "causes": self.causes(),
            "alternatives": [list(names) for names in self.finding.equivalent],
            "share": None if self.share is None else _interval(self.share),
            "resampled_over": self.resampled,
            "baseline": self.baseline.to_json(unit[0]),
            "extended": self.extended.to_json(unit[0]) if self.extended else None,
            "gain": None if self.held_out is None else _held_out(self.held_out, unit),
            "nearest": None if self.nearest is None else self._nearest(self.nearest),
            "remainder": None if self.remainder is None else _remainder(self.remainder, unit),
            "model_error": None if self.model_error is None else self.model_error.to_json(unit),
            "noise": self.noise.to_json(),
            "next_experiment": self.next_experiment,
            "not_visible": [
                {
                    "effect": i.effect,
                    i.parameter: i.threshold if math.isfinite(i.threshold) else None,
                    "instead": i.remedy,
                }
                for i in self.undetectable
            ],
            "notes": [*self.implausible, *self.notes],
            "seconds": round(self.seconds, 1),
        }

    def _nearest(self, nearest: Assessed) -> dict[str, Any]:
        causes = _causes(nearest.explanation, self.effects, nearest.confidence)
        return {
            "causes": [{k: v for k, v in c.items() if k != "confidence"} for c in causes],
            "share": _interval(nearest.share),
            "gain": None if nearest.held_out is None else _held_out(nearest.held_out, self.unit),
            "not_named_because": list(nearest.against),
        }

    def sentence(self) -> str:
        """The verdict in sentences (`sentences.sentence`)."""
        return sentence(
            self.finding,
            self.chosen,
            self.effects,
            unit=self.unit,
            share=self.share,
            shares=self.shares,
            held_out=self.held_out,
            nearest=self.nearest,
            remainder=self.remainder,
        )


def _interval(share: Interval) -> dict[str, float | None]:
    return {
        "value": share.value,
        "low": share.low if math.isfinite(share.low) else None,
        "high": share.high if math.isfinite(share.high) else None,
    }


def _held_out(g: HeldOut, unit: tuple[str, float]) -> dict[str, Any]:
    name, per_si = unit

    def figure(x: float) -> float | None:
        return x if g.held_out and math.isfinite(x) else None

    return {
        "held_out": g.held_out or "none",
        f"rms_{name}_before": figure(per_si * g.rms_before),
        f"rms_{name}_after": figure(per_si * g.rms_after),
        f"rms_{name}_noise": figure(per_si * g.rms_noise),
        "skill": figure(g.skill),
        "folds": [
            {
                "left_out": p.name,
                f"rms_{name}_before": per_si * p.rms_before,
                f"rms_{name}_after": per_si * p.rms_after,
                f"rms_{name}_noise": per_si * p.rms_noise,
                "skill": p.skill if math.isfinite(p.skill) else None,
            }
            for p in g.parts
        ],
        "log_likelihood": figure(g.log_likelihood),
        "information_kept": g.kept,
        "note": g.note,
    }


def _remainder(left: Remainder, unit: tuple[str, float]) -> dict[str, Any]:
    return {
        f"rms_{unit[0]}": unit[1] * left.rms,
        "of_full_scale": left.of_full_scale,
        "negligible": left.negligible,
        "repeats": left.repeats,
        "cosines": left.cosines,
        "records": list(left.records),
        "place": left.place,
    }


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
        variant = getattr(c, "variant_name", "")  # name of the effect's form, if its domain has several
        found.append({**entry, "kind": variant} if variant else entry)
    return found


def undetectable(model: MeasurementModel, finding: Finding) -> tuple[Undetectable, ...]:
    """Effects that would need an amplitude above `prior_scale` to reach 5 standard deviations.

    If an effect has candidates in scope "all", these decide; effects without candidates are left out.
    """
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
    """Reduced chi-square: chi-square / (rows of residuals - rank of the Jacobian)."""
    size = np.linalg.norm(fit.jacobian, axis=0)
    used = fit.jacobian[:, size > 0.0] / size[size > 0.0]
    rank = int(np.linalg.matrix_rank(used)) if used.size else 0
    return fit.chi2 / (len(fit.z) - rank)
