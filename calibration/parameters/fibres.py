"""Search coordinates of one family of fibres (`tisim.HolzapfelGasserOgden`): k1, k2 and their angle.

The fibres lie in the plane of axes 1 (which a homogeneous test pulls) and 2, turned from axis 1 to axis 2 by
the same angle in all tests. An angle and its negative are the same to every test.
"""

from __future__ import annotations

import math

from calibration.parameters._coordinates import Coordinate, ProtocolWindow, Values
from calibration.parameters._parts import one_form, register_part
from tisim import HolzapfelGasserOgden
from tisim.parts import Part

ALONG = 5.0  # an angle so near to an axis is not known to better [deg]

K1 = Coordinate(
    name="fibres_k1",
    unit="Pa",
    log=True,
    low=0.1,
    high=1e9,
    spread=0.4,
    start=1e4,
    start_per_shear=0.5,
    limit_low="no fibres",
)
K2 = Coordinate(
    name="fibres_k2",
    unit="-",
    log=True,
    low=1e-3,
    high=100.0,
    spread=0.5,
    start=0.5,
    prior=(0.0, 2.0),
    limit_low="fibres that do not stiffen",
)
ANGLE = Coordinate(name="fibres_angle_deg", unit="deg", log=False, low=0.0, high=90.0, spread=5.0, start=45.0)


def assemble(v: Values) -> HolzapfelGasserOgden:
    """The fibres at these values."""
    a = math.radians(v["fibres_angle_deg"])
    return HolzapfelGasserOgden(
        direction=(math.cos(a), math.sin(a), 0.0), k1=v["fibres_k1"], k2=v["fibres_k2"]
    )


def take_apart(part: Part) -> Values:
    """Values of fibres of this form. ValueError where they leave the plane of axes 1 and 2."""
    if not isinstance(part, HolzapfelGasserOgden) or part.direction[2] != 0.0:
        raise ValueError(
            f"fibres: expected holzapfel-gasser-ogden in the plane of axes 1 and 2, got {part!r}"
        )
    angle = math.degrees(math.atan2(abs(part.direction[1]), abs(part.direction[0])))
    return {"fibres_k1": part.k1, "fibres_k2": part.k2, "fibres_angle_deg": angle}


def describe(values: Values, window: ProtocolWindow) -> list[str]:
    """Notes for the reader on the fibres."""
    del window
    said = ["the law's moduli are those without the fibres"]
    if not ALONG < values["fibres_angle_deg"] < 90.0 - ALONG:
        said.append("the fibres lie along an axis of the tests, near which their angle is hard to see")
    return said


register_part(
    one_form(
        "fibres",
        option="fibres",
        field="fibres",
        coordinates=(K1, K2, ANGLE),
        assemble=assemble,
        describe=describe,
        take_apart=take_apart,
    )
)
