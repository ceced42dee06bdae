"""Parts of a card beside its laws: viscosity, softening and fibres, by the names of `tisim.parts`.

    viscosity: {kind: prony, fractions: [0.2, 0.1], times_s: [1, 30], modulus: long-time}
    softening: {kind: ogden-roxburgh, r: 2, m_J_per_m3: 2000, beta: 0.1}
    fibres: {kind: holzapfel-gasser-ogden, direction: [1, 0, 0], k1_Pa: 5000, k2: 1}

`kind` is the part's registered name; the other keys are its fields (SI), with or without a unit at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields
from typing import Annotated, Any

from pydantic import BeforeValidator, InstanceOf
from pydantic_core import PydanticCustomError

from factory._errors import one_line
from tisim import Material, parts

UNITS = ("s", "per_s", "Pa", "J_per_m3")  # suffixes that a key may have
FIELDS: dict[str, Any] = {
    "viscosity": parts.Viscosity,
    "softening": parts.Softening,
    "fibres": parts.Fibres,
}
# unit suffix of the fields of tisim's own parts; those of other parts have none
_WRITTEN = {"times": "s", "m": "J_per_m3", "k1": "Pa"}


def part_entry(part: parts.Part) -> dict[str, Any]:
    """A part as a card states it: plain numbers, lists and words."""
    own = part.name in parts.names() and type(part).__module__.startswith("tisim.")
    entry: dict[str, Any] = {"kind": part.name}
    for field in fields(part):
        unit = _WRITTEN.get(field.name) if own else None
        entry[f"{field.name}_{unit}" if unit else field.name] = _plain(getattr(part, field.name))
    return entry


def part_entries(material: Material) -> dict[str, dict[str, Any]]:
    """All parts of a material as a card states them, by the card's keys; empty for a material without."""
    found = {name: getattr(material, name) for name in FIELDS}
    return {name: part_entry(part) for name, part in found.items() if part is not None}


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return value
    return [float(v) for v in value] if hasattr(value, "__iter__") else float(value)


def _reader(name: str) -> Callable[[object], object]:
    """Validator that converts a card's entry to a part, with faults reported under the entry's keys."""

    def read(value: object) -> object:
        if value is None or isinstance(value, FIELDS[name]):
            return value
        if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
            raise PydanticCustomError("part", "expected the key kind and the parameters of that kind")
        kind = _kind(name, value)
        keys = _keys(kind, value)
        found = {field: value[key] for field, key in keys.items()}
        for field, key in keys.items():
            if not _sound(found[field]):
                raise _faults(("value", key, "expected a number, a word or a list of numbers", found[field]))
        try:
            part = kind(**found)
            part.check()
        except ValueError as error:  # its text begins with the field
            field, _, text = one_line(error).partition(": ")
            key = keys.get(field, "")
            raise _faults(("value", key, text if key else one_line(error), None)) from None
        except Exception as error:  # a part from outside may raise anything
            text = f"{kind.name}: {type(error).__name__}: {one_line(error)}"
            raise _faults(("value", "", text, None)) from None
        return part

    return read


def _kind(name: str, value: Mapping[str, object]) -> type[parts.Part]:
    known = [n for n in parts.names() if issubclass(parts.get(n), FIELDS[name])]
    if "kind" not in value:
        raise _faults(("missing", "kind", "", None))
    if value["kind"] not in known:
        raise _faults(("value", "kind", f"expected one of {', '.join(known)}", value["kind"]))
    return parts.get(str(value["kind"]))


def _keys(kind: type[parts.Part], value: Mapping[str, object]) -> dict[str, str]:
    """Key of each given field; unknown, doubled and missing keys are refused."""
    found: dict[str, str] = {}
    problems: list[tuple[str, str, str, object]] = []
    known = {f.name: f for f in fields(kind) if f.init}
    for key in value:
        if key == "kind":
            continue
        field = next((f for f in known if key == f or key in {f"{f}_{unit}" for unit in UNITS}), None)
        if field is None:
            problems.append(("extra_forbidden", key, "", None))
        elif field in found:
            problems.append(("value", key, f"states the same as {found[field]}: expected one of them", None))
        else:
            found[field] = key
    lacking = [field for name, field in known.items() if name not in found and not _has_default(field)]
    problems += [("missing", f.name, "", None) for f in lacking]
    if problems:
        raise _faults(*problems)
    return found


def _has_default(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _sound(value: object) -> bool:
    if isinstance(value, tuple | list):
        return all(isinstance(v, int | float) and not isinstance(v, bool) for v in value)
    return isinstance(value, int | float | str) and not isinstance(value, bool)


def _faults(*problems: tuple[str, str, str, object]) -> PydanticCustomError:
    """Error to be reported under an entry's keys; each problem is (type, key, sentence, value)."""
    listed = [
        {"type": kind, "loc": (key,) if key else (), "msg": text or kind, "input": value}
        for kind, key, text, value in problems
    ]
    return PydanticCustomError("nested", "{text}", {"text": "nested", "problems": listed})


Viscosity = Annotated[InstanceOf[parts.Viscosity] | None, BeforeValidator(_reader("viscosity"))]
Softening = Annotated[InstanceOf[parts.Softening] | None, BeforeValidator(_reader("softening"))]
Fibres = Annotated[InstanceOf[parts.Fibres] | None, BeforeValidator(_reader("fibres"))]
