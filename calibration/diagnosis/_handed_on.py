"""Effects that become parts of a material card: viscosity, softening, fibres and law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._effect import Candidate, HandedOn
from tisim.parts import Prony


def handed_on(material: str, diagnosis: Diagnosis) -> Mapping[Candidate, HandedOn]:
    """Parts and law of a material, by the effects of the chosen explanation that define them, in its order.

    A material has one part per field. Two relaxation spectra are added. If two other effects define the same
    field, the first one is used.
    """
    found: dict[Candidate, HandedOn] = {}
    taken: dict[str, Candidate] = {}
    for c in diagnosis.fit.candidates:
        part = diagnosis.subject.handed_on.get(c, {}).get(material)
        if part is None:
            continue
        if part.made and part.field in taken:
            first = taken[part.field]
            whole = _together(found[first], part)
            if whole is not None:
                # the first entry has the sum, so that moduli and parts count once
                found[first] = whole
                part = replace(part, part=None, modulus_ratio=1.0, shared=True)
            else:
                said = f"not handed on: the card's {part.field} is that of {first.label}"
                part = replace(part, part=None, law=None, modulus_ratio=1.0, remarks=(said,))
        elif part.made:
            taken[part.field] = c
        found[c] = part
    return found


def _together(a: HandedOn, b: HandedOn) -> HandedOn | None:
    """Sum of two Prony series, R = R_a + R_b - 1 relative to the modulus of the fit.

    None for other parts, or if the long-time modulus of the sum is not positive.
    """
    if not (isinstance(a.part, Prony) and isinstance(b.part, Prony)):
        return None
    left = a.modulus_ratio + b.modulus_ratio - 1.0
    if not left > 0.0:
        return None
    terms: dict[float, float] = {}
    for one in (a, b):
        assert isinstance(one.part, Prony)
        for fraction, time in zip(one.part.fractions, one.part.times, strict=True):
            terms[time] = terms.get(time, 0.0) + fraction * one.modulus_ratio
    times = tuple(sorted(terms))
    part = Prony(fractions=tuple(terms[t] / left for t in times), times=times)
    return replace(a, part=part, modulus_ratio=left)


def becomes(part: HandedOn | None) -> dict[str, Any]:
    """Entry `becomes` of an effect in a card: the field that it defines; {} if it defines none."""
    return {} if part is None or not (part.made or part.shared) else {"becomes": part.field}


def law_of(
    handed: Mapping[Candidate, HandedOn], shear: float, bulk: float
) -> tuple[str, Mapping[str, float]] | None:
    """Law that an effect defines and its parameters for these small-strain moduli [Pa]; None if none does."""
    found = next((h.law for h in handed.values() if h.law is not None), None)
    return None if found is None else found(shear, bulk)
