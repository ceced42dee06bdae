"""Names and units of parameters for people, parsed from their names in files."""

from __future__ import annotations

_UNITS = {
    "mm": "mm",
    "m": "m",
    "m2": "m²",
    "g": "g",
    "kg": "kg",
    "deg": "°",
    "rad": "rad",
    "N": "N",
    "mN": "mN",
    "Nm": "N m",
    "Pa": "Pa",
    "kPa": "kPa",
    "MPa": "MPa",
    "s": "s",
    "percent": "%",
}


def quantity_and_unit(parameter: str) -> tuple[str, str]:
    """Split a parameter's name in files into (name, unit); either may be empty.

    `curvature_per_m` is a curvature in 1/m, `rad_per_Nm` has a unit but no name, `c2_over_c1` a name but no
    unit.
    """
    head, per, below = parameter.rpartition("per_")
    if per and (not head or head.endswith("_")):
        name, above = quantity_and_unit(head.rstrip("_")) if head else ("", "")
        return name, _quotient(above, below)
    head, _, last = parameter.rpartition("_")
    if last in _UNITS:
        return head.replace("_", " "), _UNITS[last]
    return parameter.replace("_", " "), ""


def _quotient(above: str, below: str) -> str:
    if below in _UNITS:
        unit = _UNITS[below]
        return f"{above or '1'}/{f'({unit})' if ' ' in unit else unit}"
    counted = below.lstrip("0123456789")
    number = below.removesuffix(counted)
    spoken = f"{number} {_UNITS[counted]}" if number and counted in _UNITS else below.replace("_", " ")
    return f"{above} per {spoken}".strip()
