"""Effects that are parts of a material: which of them become a card's viscosity, softening and fibres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._effect import Candidate, HandedOn


def handed_on(material: str, diagnosis: Diagnosis) -> Mapping[Candidate, HandedOn]:
    """Parts of a material by the effects of the chosen explanation that state them, in its order.

    A material has one part of each field: of two effects that ask for the same, the first has it.
    """
    found: dict[Candidate, HandedOn] = {}
    taken: dict[str, str] = {}
    for c in diagnosis.fit.candidates:
        part = diagnosis.subject.handed_on.get(c, {}).get(material)
        if part is None:
            continue
        if part.part is not None and part.field in taken:
            said = f"not handed on: the card's {part.field} is that of {taken[part.field]}"
            part = replace(part, part=None, modulus_ratio=1.0, remarks=(said,))
        elif part.part is not None:
            taken[part.field] = c.label
        found[c] = part
    return found


def becomes(part: HandedOn | None) -> dict[str, Any]:
    """What an effect's entry in a card says of its part."""
    return {} if part is None or part.part is None else {"becomes": part.field}
