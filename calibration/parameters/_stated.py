"""Parts beside a law as a material card states them: read, written, and held in a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from calibration.parameters._parts import Option, PartCoordinates, ProtocolWindow
from tisim import parts
from tisim.parts import Part

UNITS = ("s", "per_s", "Pa", "J_per_m3")  # that a key of a part may end with
FIELDS: dict[str, Any] = {
    "viscosity": parts.Viscosity,
    "softening": parts.Softening,
    "fibres": parts.Fibres,
}
OPTIONS: dict[str, Option] = {"viscosity": "time", "softening": "damage", "fibres": "fibres"}  # of a fit


def part_of(field: str, entry: Mapping[str, Any]) -> Part:
    """A part as a card states it, with or without units behind its keys. ValueError for one that is none."""
    kinds = [n for n in parts.names() if issubclass(parts.get(n), FIELDS[field])]
    if entry.get("kind") not in kinds:
        raise ValueError(f"key {field}.kind: expected one of {', '.join(kinds)}, got {entry.get('kind')!r}")
    kind = parts.get(entry["kind"])
    known = {f.name for f in fields(kind) if f.init}
    values: dict[str, Any] = {}
    for key, value in entry.items():
        if key == "kind":
            continue
        name = next((n for n in known if key == n or key in {f"{n}_{unit}" for unit in UNITS}), None)
        if name is None:
            raise ValueError(f"key {field}.{key}: expected {', '.join(sorted(known))}")
        values[name] = tuple(value) if isinstance(value, list) else value
    try:
        found = kind(**values)
        found.check()
    except (TypeError, ValueError) as error:
        raise ValueError(f"key {field}: {error}") from None
    return found


def long_time_parts(stated: Mapping[str, Part]) -> tuple[dict[str, Part], float]:
    """Parts beside a law, by field, as they stand beside its long-time moduli.

    Returns
    -------
    tuple of (dict, float)
        The parts, and the ratio of the long-time modulus to the stated one: 1 unless a Prony series has the
        instantaneous one, to which stiffness of fibres and softening energy refer as well.
    """
    found = dict(stated)
    viscosity = found.get("viscosity")
    left = viscosity.spectrum().equilibrium if isinstance(viscosity, parts.Viscosity) else 1.0
    if viscosity is None or left == 1.0:
        return found, 1.0
    spectrum = viscosity.spectrum()  # type: ignore[attr-defined]
    fractions, times = ((tuple(float(v) for v in x)) for x in (spectrum.strengths / left, spectrum.times))
    found["viscosity"] = parts.Prony(fractions=fractions, times=times, modulus="long-time")
    fibres, softening = found.get("fibres"), found.get("softening")
    if isinstance(fibres, parts.HolzapfelGasserOgden):
        found["fibres"] = replace(fibres, k1=left * fibres.k1)
    if isinstance(softening, parts.OgdenRoxburgh):
        found["softening"] = replace(softening, m=left * softening.m)
    return found, left


def part_entry(part: Part) -> dict[str, Any]:
    """A part as a card states it: its kind, and its parameters to six digits."""
    entry: dict[str, Any] = {"kind": part.name}
    for f in fields(part):
        value = getattr(part, f.name)
        if isinstance(value, tuple):
            entry[f.name] = [_rounded(x) for x in value]
        else:
            entry[f.name] = value if isinstance(value, str) else _rounded(value)
    return entry


def _rounded(x: float) -> float:
    return float(f"{x:.6g}")


def held_part(field: str, part: Part, window: ProtocolWindow) -> PartCoordinates:
    """A part that a fit takes as it is: it has no coordinates."""
    return PartCoordinates(
        spec="",
        label=f"{part.name}-held",
        field=field,
        window=window,
        coordinates=(),
        assemble=lambda _: part,
        describe=lambda *_: [],
    )
