"""Parts of a card beside its laws, as fields of a model; `tisim.parts` reads and writes their entries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from pydantic import BeforeValidator, InstanceOf
from pydantic_core import PydanticCustomError

from tisim import Material, parts

# a key's fault as pydantic calls it
_TYPES = {"missing": "missing", "unknown": "extra_forbidden", "value": "value"}


def part_entries(material: Material) -> dict[str, dict[str, object]]:
    """All parts of a material as a card states them, by the card's keys; empty for a material without."""
    return {field: parts.encode(part) for field, part in parts.of(material).items()}


def _reader(field: str) -> Callable[[object], object]:
    """Validator that converts a card's entry to a part, with faults reported under the entry's keys."""

    def read(value: object) -> object:
        if value is None or isinstance(value, parts.FIELDS[field]):
            return value
        try:
            return parts.decode(field, value)
        except parts.EntryError as error:
            listed = [
                {
                    "type": _TYPES[problem.what],
                    "loc": (problem.key,) if problem.key else (),
                    "msg": problem.text or problem.what,
                    "input": problem.value,
                }
                for problem in error.problems
            ]
            raise PydanticCustomError("nested", "{text}", {"text": "nested", "problems": listed}) from None

    return read


Viscosity = Annotated[InstanceOf[parts.Viscosity] | None, BeforeValidator(_reader("viscosity"))]
Softening = Annotated[InstanceOf[parts.Softening] | None, BeforeValidator(_reader("softening"))]
Fibres = Annotated[InstanceOf[parts.Fibres] | None, BeforeValidator(_reader("fibres"))]
