"""Effects that are parts of a material: which of them become a card's viscosity, softening and fibres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._effect import Candidate, HandedOn


def handed_on(material: str, diagnosis: Diagnosis) -> Mapping[Candidate, HandedOn]:
    """Parts and law of a material by the effects of the chosen explanation that state them, in its order.

    A material has one part of each field: of two effects that ask for the same, the first has it.
    """
    found: dict[Candidate, HandedOn] = {}
    taken: dict[str, str] = {}
    for c in diagnosis.fit.candidates:
        part = diagnosis.subject.handed_on.get(c, {}).get(material)
        if part is None:
            continue
        if part.made and part.field in taken:
            said = f"not handed on: the card's {part.field} is that of {taken[part.field]}"
            part = replace(part, part=None, law=None, modulus_ratio=1.0, remarks=(said,))
        elif part.made:
            taken[part.field] = c.label
        found[c] = part
    return found


def becomes(part: HandedOn | None) -> dict[str, Any]:
    """What an effect's entry in a card says of its part."""
    return {} if part is None or not part.made else {"becomes": part.field}


def law_of(
    handed: Mapping[Candidate, HandedOn], shear: float, bulk: float
) -> tuple[str, Mapping[str, float]] | None:
    """The law that an effect asks for with these small-strain moduli [Pa], and its parameters."""
    found = next((h.law for h in handed.values() if h.law is not None), None)
    return None if found is None else found(shear, bulk)
