"""Search coordinates of Mullins softening (`tisim.OgdenRoxburgh`): r, m and beta."""

from __future__ import annotations

from calibration.parameters._coordinates import Coordinate, ProtocolWindow, Values
from calibration.parameters._parts import one_form, register_part
from tisim import OgdenRoxburgh
from tisim.parts import Part

R = Coordinate(
    name="mullins_r",
    unit="-",
    log=True,
    low=1.0,
    high=100.0,
    spread=0.3,
    start=2.0,
    limit_high="no softening",
)
M = Coordinate(
    name="mullins_m",
    unit="J/m3",
    log=True,
    low=0.1,
    high=1e8,
    spread=0.5,
    start=1e4,
    start_per_shear=0.1,
    limit_high="no softening",
)
BETA = Coordinate(
    name="mullins_beta",
    unit="-",
    log=False,
    low=0.0,
    high=5.0,
    spread=0.1,
    start=0.1,
    prior=(0.1, 0.5),
    limit_low="softening of one energy",
)


def assemble(v: Values) -> OgdenRoxburgh:
    """The softening at these values."""
    return OgdenRoxburgh(r=v["mullins_r"], m=v["mullins_m"], beta=v["mullins_beta"])


def take_apart(part: Part) -> Values:
    """Values of a softening of this form."""
    if not isinstance(part, OgdenRoxburgh):
        raise ValueError(f"mullins: expected an ogden-roxburgh softening, got {part.name}")
    return {"mullins_r": part.r, "mullins_m": part.m, "mullins_beta": part.beta}


def describe(values: Values, window: ProtocolWindow) -> list[str]:
    """Properties of the part that the tests cannot show."""
    del values
    if window.peaks == 0:
        return ["no test unloads, so that nothing shows the softening: r, m and beta are not measured"]
    if window.peaks == 1:
        return [
            "all tests unload from one largest strain, so that m and beta cannot be told apart: their sum"
            " m + beta W_m is measured, beta is its prior's"
        ]
    return []


register_part(
    one_form(
        "mullins",
        option="damage",
        field="softening",
        coordinates=(R, M, BETA),
        assemble=assemble,
        describe=describe,
        take_apart=take_apart,
    )
)
