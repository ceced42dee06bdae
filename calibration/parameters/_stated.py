"""Parts beside a law as a material card states them: written, and held in a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from calibration.parameters._coordinates import PartCoordinates, ProtocolWindow
from calibration.parameters._parts import Option
from tisim import parts
from tisim.parts import Part

OPTIONS: dict[str, Option] = {"viscosity": "time", "softening": "damage", "fibres": "fibres"}  # of a fit


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
    """A part as cards and fits state it, to six digits."""
    return parts.encode(part, digits=6)


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
