"""Extended material cards: results of a diagnosis in the format of `factory.build` and `calibration.fit`.

One MATERIAL.yaml per material, as written by `calibration.fit`, with the effects of the specimen; and
rig.yaml, if effects of rig, camera or simulator were found. Its key `use` states whether `calibration.fit`
can read it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from calibration._files import on_any_disk
from calibration.diagnosis._card_numbers import (
    Modulus,
    baseline_entry,
    correlations,
    file_covariance,
    gain,
    model_error,
    moduli,
    rounded,
    valid_range,
    widened,
)
from calibration.diagnosis._handed_on import becomes, handed_on, law_of
from calibration.diagnosis._rig_file import FORMAT, USES, corrects
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.measurements._effect import Candidate, HandedOn
from calibration.parameters import part_entry
from calibration.study import Calibration
from calibration.study.cards import card, save
from tisim import laws

RIG = "rig.yaml"
_BY = "by calibration.diagnose"  # in the provenance of cards of a diagnosis, and of no others


def check_names(materials: Collection[str]) -> None:
    """InputError if a material is named as the rig's card is."""
    for name in materials:
        if on_any_disk(name) == Path(RIG).stem:
            raise InputError(f"material {name}: expected another name, since {RIG} is the rig's card")


def write_cards(folder: Path, diagnosis: Diagnosis, experiment: Experiment) -> list[Path]:
    """Write folder/MATERIAL.yaml for each diagnosed material, and folder/rig.yaml if rig effects are named.

    A rig.yaml and material cards of an earlier diagnosis are removed; cards of another origin stay. Without a
    named cause the cards are of the baseline. Returns the paths written. InputError if a material is named
    "rig".
    """
    check_names((diagnosis.extended or diagnosis.baseline).shear_modulus_Pa)
    known = moduli(diagnosis)
    (folder / RIG).unlink(missing_ok=True)
    for earlier in sorted(folder.glob("*.yaml")):
        if _diagnosed(earlier):
            earlier.unlink()
    heading = "Moduli in Pa, density in kg/m3. Diagnosed: see provenance and effects."
    written = []
    for name, modulus in known.items():
        content = _material(name, modulus, diagnosis, experiment)
        written.append(save(folder / f"{name}.yaml", content, heading))
    at_fault = [k for k, c in enumerate(diagnosis.fit.candidates) if not _of_specimen(c, diagnosis)]
    if at_fault:
        content = _rig(at_fault, diagnosis, experiment)
        written.append(save(folder / RIG, content, "What a diagnosis found beside the specimens: see use."))
    return written


def _diagnosed(path: Path) -> bool:
    """True for the material card of a diagnosis."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError):
        return False
    return isinstance(content, dict) and "laws" in content and _BY in str(content.get("provenance", ""))


def _material(name: str, modulus: Modulus, diagnosis: Diagnosis, experiment: Experiment) -> dict[str, Any]:
    shear, law, bulk_ratio = modulus.value, diagnosis.subject.law, diagnosis.subject.bulk_ratio
    numbers = diagnosis.extended or diagnosis.baseline
    handed = handed_on(name, diagnosis)
    stated = shear * prod(h.modulus_ratio for h in handed.values())
    relative_sd = modulus.relative_sd * widened(diagnosis.fit, modulus.direction)
    if diagnosis.model_error is not None:
        relative_sd = max(relative_sd, diagnosis.model_error.shear_modulus_relative_sd.get(name, 0.0))
    own, parameters = _law(name, stated / shear, bulk_ratio * shear, stated, diagnosis)
    fit = Calibration(
        material=name,
        law=own,
        label=own,
        status="converged",  # or the provenance says how it ended
        message="",
        density=experiment.materials[name].density,
        parameters=parameters,
        shear_modulus=stated,
        shear_modulus_sd=relative_sd * stated,
        bulk_modulus=bulk_ratio * shear,
        reduced_chi2=numbers.reduced_chi2,
    )
    content = card([fit], experiment)
    content["provenance"] = _provenance(name, modulus, diagnosis, experiment, handed)
    content["fitted_to"]["kinds"] = [diagnosis.subject.kind]
    if not diagnosis.fit.converged:
        content["fitted_to"] |= {"status": "not converged", "why": diagnosis.fit.message}
    content["uncertainty"]["text"] = (
        "95 % interval of the shear modulus, nuisances and the amplitudes of all effects free, wider by the"
        " root of the reduced chi-square of the material's own records where that is above 1, and at least"
        " the modulus' spread over resampled measurements where the data are explained in part or not at all."
        f" The bulk modulus is {bulk_ratio:g} shear moduli by assumption, but for a compressibility among the"
        " effects."
    )
    content["model_error"] = model_error(diagnosis.fit, modulus.direction)
    content["baseline"] = baseline_entry(name, modulus, diagnosis)
    content.update({h.field: part_entry(h.part) for h in handed.values() if h.part is not None})
    asked = law_of(handed, stated, bulk_ratio * shear)
    if asked is not None:
        content["law"] = asked[0]
        content["laws"][asked[0]] = {n: rounded(x) for n, x in asked[1].items()}
    effects = [
        {
            **_entry(k, diagnosis),
            **({"becomes": "law"} if _replaces_law(c, name, diagnosis) else becomes(handed.get(c))),
            "applies_to": "material" if diagnosis.effects[c.effect].effect.with_material else "shape",
            "base_law": law,
            "correlations": correlations(k, modulus, diagnosis),
            "gain": gain(diagnosis),
            "experiment_sha256": experiment.digest,
        }
        for k, c in enumerate(diagnosis.fit.candidates)
        if _of_specimen(c, diagnosis) and name in diagnosis.subject.materials.get(c, frozenset())
    ]
    return {**content, "effects": effects} if effects else content


def _law(
    name: str, ratio: float, bulk: float, shear: float, diagnosis: Diagnosis
) -> tuple[str, dict[str, float | tuple[float, ...]]]:
    """Law of a material and its parameters.

    The baseline's law with these moduli [Pa]; if an effect replaces it, the effect's law with all parameters
    in Pa multiplied by `ratio`.
    """
    if name not in diagnosis.subject.other_laws:
        law = diagnosis.subject.law
        return law, laws.get(law).from_moduli(shear, bulk)
    law, parameters = diagnosis.subject.other_laws[name]
    return law, laws.scaled(law, parameters, ratio)


def _rig(at_fault: list[int], diagnosis: Diagnosis, experiment: Experiment) -> dict[str, Any]:
    covariance, names = file_covariance(diagnosis)
    candidates = diagnosis.fit.candidates
    said = corrects(diagnosis.effects[candidates[k].effect] for k in at_fault)
    content = {
        "format": FORMAT,
        "experiment": experiment.name,
        "experiment_sha256": experiment.digest,
        "base_law": diagnosis.subject.law,
        "corrects": said,
        "use": USES[said],
        "effects": [_entry(k, diagnosis) for k in at_fault],
        "covariance": {
            "names": [names[k] for k in at_fault],
            "matrix": [[rounded(x) for x in row] for row in covariance[np.ix_(at_fault, at_fault)]],
        },
    }
    held_out = gain(diagnosis)
    return content if held_out is None else {**content, "gain": held_out}


def _entry(index: int, diagnosis: Diagnosis) -> dict[str, Any]:
    """Entries of an effect that are common to material cards and rig.yaml."""
    candidate = diagnosis.fit.candidates[index]
    amplitudes = diagnosis.causes()[index]["parameters"]
    return {
        "effect": candidate.effect,
        "belongs_to": diagnosis.effects[candidate.effect].belongs_to,
        "scope": candidate.at,
        "parameters": {n: {key: rounded(x) for key, x in a.items()} for n, a in amplitudes.items()},
        "valid_range": valid_range(candidate, diagnosis),
        "rivals": [" + ".join(r) for r in diagnosis.finding.equivalent if candidate.effect not in r],
    }


def _provenance(
    name: str,
    modulus: Modulus,
    diagnosis: Diagnosis,
    experiment: Experiment,
    handed: Mapping[Candidate, HandedOn],
) -> str:
    numbers = diagnosis.extended or diagnosis.baseline
    fit = diagnosis.fit
    lines = [
        f"Fitted to experiment {experiment.name!r} (sha256 {experiment.digest[:16]}) {_BY},"
        f" baseline law {diagnosis.subject.law}, other laws filled in from the moduli: shear modulus"
        f" {modulus.value:.5g} Pa,"
        f" reduced chi-square {numbers.reduced_chi2:.2f}.",
        f"Verdict: {diagnosis.finding.verdict}. {diagnosis.sentence()}",
    ]
    if fit.candidates:
        before = diagnosis.baseline
        lines.append(
            f"The modulus is that beside {fit.label}; without it {before.shear_modulus_Pa[name]:.5g} Pa"
            f" at a reduced chi-square of {before.reduced_chi2:.2f}."
        )
    for c, h in handed.items():
        if h.part is not None:
            lines.append(
                f"{c.label} is the card's {h.field} ({h.part.title}); the laws' modulus is {h.states},"
                f" {h.modulus_ratio:.4g} times that beside the effect."
            )
        elif h.shared:
            lines.append(f"{c.label} is in the card's {h.field} too.")
        elif h.law is not None:
            lines.append(f"{c.label} is the card's law, {h.law(1.0, 1.0)[0]}.")
        lines += [f"{c.label}: {remark}." for remark in h.remarks]
    lines += [
        f"{c.label} is the card's law, {diagnosis.subject.other_laws[name][0]}."
        for c in fit.candidates
        if _replaces_law(c, name, diagnosis)
    ]
    if diagnosis.finding.verdict == "unexplained":
        lines.append("Unexplained: this is the baseline's modulus, and the measurements depart from it.")
    if not fit.converged:
        lines.append(f"The fit did not converge: {fit.message}.")
    if experiment.materials[name].density is None:
        lines.append("Density not stated by the lab: 1000 kg/m3 assumed.")
    return "\n".join(lines)


def _replaces_law(candidate: Candidate, material: str, diagnosis: Diagnosis) -> bool:
    """True for an effect that is another law in place of the baseline's, which the card then names."""
    here = diagnosis.subject.materials.get(candidate, frozenset())
    switch = diagnosis.effects[candidate.effect].switch
    return switch and material in here and material in diagnosis.subject.other_laws


def _of_specimen(candidate: Candidate, diagnosis: Diagnosis) -> bool:
    return bool(diagnosis.effects[candidate.effect].belongs_to == "specimen")
