"""Checks of plausibility: a unit that was read wrongly shows in the modulus, the strain or the clock.

Each is a name and a function; what it finds is asked about, or refused unless the answers accept it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calibration.new._trial import Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A coupon's record: stretch (1 + gamma in simple shear) and nominal stress [Pa], shape (k,)."""

    mode: str
    stretch: Array
    stress: Array
    time: Array | None
    force: Array | None = None
    area: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Push:
    """A poke's record: depth [m], force [N], time [s], shape (k,); radius and height of the block [m]."""

    depth: Array
    force: Array
    time: Array
    radius: float
    height: float


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A beam: free length and height of its section [m], density [kg/m3], times of its captures [s]."""

    free_length: float
    height: float
    density: float


Made = Curve | Push | Bar

# Soft tissue, gels and silicones: brain has some 1 kPa, the stiffest castable silicones some 3 MPa (Shore A
# 60); a rubber that stretches beyond 1.5 stays below 10 MPa, and what is stiffer does not stretch so far.
_SOFTEST, _STIFFEST, _STIFFEST_STRETCHED = 100.0, 30e6, 10e6
_STRETCHED = 1.5
_LONGEST_STRETCH = 20.0  # the softest silicones break at 10 to 17 between the grips
_SMALL = 0.5  # logarithmic strain up to which a modulus is read off
_LIGHT, _HEAVY = 500.0, 2500.0  # kg/m3
_BRIEF, _LONG = 0.1, 3e6  # s


@dataclass(frozen=True, kw_only=True)
class Check:
    """A check: of what it takes, a sentence where that is implausible, else None."""

    name: str
    about: str
    test: Callable[[Made], str | None]


def _modulus(made: Made) -> str | None:
    if isinstance(made, Curve):
        modulus = young(made)
        reach = float(max(made.stretch.max(), 1.0 / max(made.stretch.min(), 1e-3)))
    elif isinstance(made, Push):
        modulus, reach = _punch(made), 1.0
    else:
        return None
    if modulus is None:
        return None
    far = reach > _STRETCHED
    stiffest = _STIFFEST_STRETCHED if far else _STIFFEST
    if _SOFTEST <= modulus <= stiffest:
        return None
    body = f"in a specimen that is stretched to {reach:.3g}" if far else "in a soft material"
    slip = "kPa as MPa, N as kN, or cm as mm" if modulus > stiffest else "MPa as kPa, kN as N, or mm as cm"
    return (
        f"a Young's modulus of {_pascals(modulus)} {body} is implausible;"
        f" was a unit read as another ({slip})?"
    )


def young(curve: Curve) -> float | None:
    """Young's modulus 3 mu of the neo-Hookean curve nearest to the record at small strains [Pa], or None.

    Nominal stress mu g, with g = x - x^-2 (uniaxial), x - x^-5 (equibiaxial), x - x^-3 (planar), x - 1
    (simple shear, x = 1 + gamma).
    """
    x = curve.stretch
    if curve.mode == "simple-shear":
        g, small = x - 1.0, np.abs(x - 1.0) <= 1.0
    else:
        power = {"uniaxial": 2, "equibiaxial": 5, "planar": 3}[curve.mode]
        with np.errstate(all="ignore"):
            g, small = x - x ** (-power), np.abs(np.log(x)) <= _SMALL
    if not (np.isfinite(g).all() and small.any()):
        return None
    scale = float(np.sum(g[small] ** 2))
    return abs(3.0 * float(np.sum(curve.stress[small] * g[small])) / scale) if scale > 0 else None


def _punch(push: Push) -> float | None:
    """Young's modulus at the largest depth, of a half space under a flat punch: 0.75 F / (2 a d) [Pa]."""
    at = int(np.argmax(push.depth))
    depth = float(push.depth[at])
    if depth <= 0 or push.force[at] <= 0:
        return None
    return 0.75 * float(push.force[at]) / (2.0 * push.radius * depth)


def _strain(made: Made) -> str | None:
    if isinstance(made, Push):
        deepest = float(made.depth.max())
        if deepest > made.height:
            return (
                f"the deepest depth, {deepest * 1e3:.4g} mm, is more than the block's height of"
                f" {made.height * 1e3:.4g} mm; is the displacement in mm, and its zero right?"
            )
        if deepest <= 0:
            return "the displacement never goes into the block; which direction is positive?"
        return None
    if not isinstance(made, Curve):
        return None
    low, high = float(made.stretch.min()), float(made.stretch.max())
    if high > _LONGEST_STRETCH:
        return f"a stretch of {high:.4g} is implausible; is the strain in %, not a ratio?"
    if max(high - 1.0, 1.0 - low) < 2e-3:
        largest = max(high - 1.0, 1.0 - low)
        return f"the largest strain is {largest:.2g}; is it a ratio that was read as %, or a length in cm?"
    return None


def _sign(made: Made) -> str | None:
    if isinstance(made, Push):
        at = int(np.argmax(np.abs(made.force)))
        if made.force[at] < 0:
            return "the largest force pulls on the indenter; which direction is positive?"
        return None
    if not isinstance(made, Curve):
        return None
    x = made.stretch - 1.0
    far = np.abs(x) > 0.5 * np.abs(x).max()
    against = float(np.mean(made.stress[far] * x[far] < 0)) if far.any() else 0.0
    if against > 0.5:
        return f"{against:.0%} of the stresses act against the strain; which direction is positive?"
    return None


def _area(made: Made) -> str | None:
    if not isinstance(made, Curve) or made.force is None or made.area is None:
        return None
    high = np.abs(made.stress) > 0.2 * np.abs(made.stress).max()
    if not high.any():
        return None
    ratio = float(np.median(np.abs(made.force[high]) / (np.abs(made.stress[high]) * made.area)))
    if 0.8 < ratio < 1.25:
        return None
    return (
        f"the file's force is {ratio:.3g} times its stress on the area of {made.area * 1e6:.4g} mm2; is a"
        " unit or the area wrong?"
    )


def _duration(made: Made) -> str | None:
    time = made.time if isinstance(made, Curve | Push) else None
    if time is None:
        return None
    lasted = float(time[-1] - time[0])
    if _BRIEF <= lasted <= _LONG:
        return None
    return f"a test of {lasted:.3g} s is implausible; is its time in another unit (s, ms, min)?"


def _density(made: Made) -> str | None:
    if not isinstance(made, Bar) or _LIGHT <= made.density <= _HEAVY:
        return None
    return f"a density of {made.density:g} kg/m3 is implausible for silicone or tissue; is it in kg/m3?"


def _slenderness(made: Made) -> str | None:
    if not isinstance(made, Bar) or 1.0 <= made.free_length / made.height <= 100.0:
        return None
    return (
        f"a beam of {made.free_length * 1e3:g} mm free length and {made.height * 1e3:g} mm height is"
        " implausible; is a length in another unit?"
    )


CHECKS = (
    Check(name="modulus", about="Young's modulus by the first strains, or by a flat punch", test=_modulus),
    Check(name="strain", about="stretch, or depth against the block's height", test=_strain),
    Check(name="sign", about="stress and strain of one sign, a rod that pushes", test=_sign),
    Check(name="area", about="the file's force against its stress and the area", test=_area),
    Check(name="duration", about="time from first to last row", test=_duration),
    Check(name="density", about="density of a beam's material", test=_density),
    Check(name="slenderness", about="free length of a beam against its height", test=_slenderness),
)


def _pascals(value: float) -> str:
    for unit, size in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} Pa"
