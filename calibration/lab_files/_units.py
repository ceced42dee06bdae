"""Units as machines write them, and the header of a column taken apart into name and unit."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

Dimension = Literal["time", "length", "force", "ratio", "stress", "area", "torque", "angle", "other"]


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit of measurement.

    Attributes
    ----------
    text : str
        Unit as it is written.
    dimension : str
        Quantity that it measures; "other" for a known unit of no use here.
    factor : float
        One unit in SI (s, m, N, 1, Pa, m2).
    """

    text: str
    dimension: Dimension
    factor: float = 1.0


_GRAVITY = 9.80665  # m/s2, of a gram-force: CGPM 1901

_OTHER = (
    *("°c", "c", "k", "hz", "rpm", "cycles", "1/s", "1/min", "s^-1", "rad/s", "%/s", "%/min", "mm/s"),
    *("mm/sec", "mm/min", "µm/s", "nm/s", "cm/s", "cm/min", "m/s", "in/s", "in/min", "g", "kg", "kg/m3"),
    *("kg/m³", "g/cm3", "g/cm³", "mm3", "mm³", "j", "mj", "kj", "j/m2", "j/m²", "kj/m2", "kj/m²", "w", "v"),
    *("mv", "pa.s", "pa·s", "kpa/s", "mpa/s", "n/s", "n/min", "kn/s", "n/m", "n/mm", "kn/m", "n/tex"),
)
# by the text in lower case; MPa and mPa are told apart below
_TABLE: dict[str, tuple[Dimension, float]] = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "sek", "sekunden"), ("time", 1.0)),
    **dict.fromkeys(("ms", "msec"), ("time", 1e-3)),
    **dict.fromkeys(("min", "mins", "minutes"), ("time", 60.0)),
    **dict.fromkeys(("h", "hr", "hours"), ("time", 3600.0)),
    **dict.fromkeys(("mm", "millimeter", "millimetre", "millimeters", "millimetres"), ("length", 1e-3)),
    **dict.fromkeys(("µm", "μm", "um", "micron", "microns", "micrometer"), ("length", 1e-6)),
    "cm": ("length", 1e-2),
    "m": ("length", 1.0),
    **dict.fromkeys(("in", "inch", "inches"), ("length", 25.4e-3)),
    **dict.fromkeys(("n", "newton", "newtons"), ("force", 1.0)),
    "kn": ("force", 1e3),
    "cn": ("force", 1e-2),
    "dan": ("force", 10.0),
    "µn": ("force", 1e-6),
    "μn": ("force", 1e-6),
    **dict.fromkeys(("gf", "grf", "gram-force"), ("force", 1e-3 * _GRAVITY)),
    **dict.fromkeys(("kgf", "kp"), ("force", _GRAVITY)),
    **dict.fromkeys(("lbf", "lb", "lbs"), ("force", 4.4482216152605)),
    **dict.fromkeys(("%", "percent", "pct", "prozent"), ("ratio", 1e-2)),
    **dict.fromkeys(("-", "1", "mm/mm", "m/m", "in/in"), ("ratio", 1.0)),
    "pa": ("stress", 1.0),
    "kpa": ("stress", 1e3),
    "gpa": ("stress", 1e9),
    **dict.fromkeys(("n/mm²", "n/mm2", "n/mm^2"), ("stress", 1e6)),
    **dict.fromkeys(("n/m²", "n/m2", "n/m^2"), ("stress", 1.0)),
    **dict.fromkeys(("n/cm²", "n/cm2", "n/cm^2"), ("stress", 1e4)),
    **dict.fromkeys(("kn/m²", "kn/m2", "kn/m^2"), ("stress", 1e3)),
    **dict.fromkeys(("kn/mm²", "kn/mm2", "kn/mm^2"), ("stress", 1e9)),
    "psi": ("stress", 6894.757293168),
    "ksi": ("stress", 6894757.293168),
    "bar": ("stress", 1e5),
    **dict.fromkeys(("mbar", "hpa"), ("stress", 1e2)),
    **dict.fromkeys(("mm²", "mm2", "mm^2"), ("area", 1e-6)),
    **dict.fromkeys(("cm²", "cm2", "cm^2"), ("area", 1e-4)),
    **dict.fromkeys(("m²", "m2", "m^2"), ("area", 1.0)),
    **dict.fromkeys(("n.m", "n·m", "n*m", "nm", "nmm", "n·mm", "n.mm", "µn.m", "un.m"), ("torque", 1.0)),
    **dict.fromkeys(("rad", "deg", "°"), ("angle", 1.0)),
    **dict.fromkeys(_OTHER, ("other", 1.0)),
}
# the case tells milli from mega
_BY_CASE: dict[str, tuple[Dimension, float]] = {
    "MPa": ("stress", 1e6),
    "Mpa": ("stress", 1e6),
    "MPA": ("stress", 1e6),
    "mPa": ("stress", 1e-3),
    "mN": ("force", 1e-3),
    "MN": ("force", 1e6),
    "nm": ("length", 1e-9),
    "Nm": ("torque", 1.0),
    "min": ("time", 60.0),
}


def unit(text: str) -> Unit | None:
    """The unit that a text stands for, with or without brackets around it; None where it is none."""
    bare = text.strip().strip('"').strip()
    if len(bare) > 1 and (bare[0], bare[-1]) in (("(", ")"), ("[", "]"), ("{", "}")):
        bare = bare[1:-1].strip()
    if bare in _BY_CASE:
        dimension, factor = _BY_CASE[bare]
    elif bare.lower() in ("mpa", "mn"):  # neither milli nor mega for certain
        return None
    elif bare.lower() in _TABLE:
        dimension, factor = _TABLE[bare.lower()]
    else:
        return None
    return Unit(text=bare, dimension=dimension, factor=factor)


_BRACKETS = re.compile(r"^(?P<name>.*\S)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]\s*$")
_SEPARATED = re.compile(r"^(?P<name>.*\S)\s*(?:,|_|\s)\s*(?P<unit>[^\s,_]+)\s*$")
_SLASH = re.compile(r"^(?P<name>.*?[^\s/])\s*/\s*(?P<unit>[^\s,_]+)\s*$")


def name_and_unit(header: str) -> tuple[str, Unit | None]:
    """The two parts of a column's header; no unit where it states none.

    "Force [N]", "Extension (mm)", "strain %", "strain mm/mm", "Time/s", "Stress/N/mm²", "Fz, gf" and
    "depth_mm" state one; "Tensile strain (Extension)", "Rate %/d" and "Cycle count" do not.
    """
    header = header.strip().strip('"').strip()
    for pattern in (_BRACKETS, _SEPARATED, _SLASH):
        found = pattern.match(header)
        given = unit(found["unit"]) if found else None
        if found is None or given is None or (pattern is not _BRACKETS and found["unit"] == "1"):
            continue
        name = re.sub(r"\s+in$", "", found["name"].strip().rstrip(",/_").strip())
        if pattern is _SLASH and unit(name.split()[-1]) is not None:
            continue  # a part of a unit that is not known
        return name, given
    if header.endswith("%") and len(header) > 1:
        return header[:-1].strip(), unit("%")
    return header, None
