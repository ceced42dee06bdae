"""The page's sliders, its table of trained ranges and the poses that it refuses, in mm, degrees and kPa."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from learn.data import Setup, Store
from learn.pose_limits import ANGLE_TEXT, INCLUSION_TEXT, LEAST_COSINE, STEEPEST, SiteLimits
from learn.quantities import QUANTITIES
from learn.validity import Domain

# The sliders end beyond what was trained, and beyond what is refused, so that these limits are visible.
_BEYOND = 1.5  # ratio of the depth slider's end to the trained depth
_STEEPER = 5.0  # degrees
DEGREES = "\N{DEGREE SIGN}"


def sliders(store: Store, setup: Setup, domain: Domain | None) -> dict[str, dict[str, Any]]:
    """Sliders by key of the page's poke: limits, units, trained range ({range, text}; None: not known)."""
    half = np.array(setup.block_size[:2]) / 2
    low, high = ((setup.middle - half) * 1e3).tolist(), ((setup.middle + half) * 1e3).tolist()
    moduli = store.modulus[store.done] * 1e-3
    least, most = float(moduli.min()), float(moduli.max())
    deepest, depth = float(store.depth.max()) * 1e3, _trained(domain, "depth_mm")
    modulus = _trained(domain, "shear_modulus_kPa")
    if depth and depth["range"]:
        deepest = max(deepest, depth["range"][1])
    if modulus and modulus["range"]:
        least, most = min(least, modulus["range"][0]), max(most, modulus["range"][1])
    lowest = min(deepest * _BEYOND, setup.block_size[2] * 1e3)
    return {
        "depth": {"low": 0.0, "high": lowest, "step": 0.05, "units": "mm", "trained": depth},
        "x": _along(0, low, high, setup, domain),
        "y": _along(1, low, high, setup, domain),
        "angle": {
            "low": 0.0,
            "high": STEEPEST + _STEEPER,
            "step": 0.5,
            "units": DEGREES,
            "trained": _trained(domain, "angle_deg"),
        },
        "heading": {"low": -180.0, "high": 180.0, "step": 1.0, "units": DEGREES, "trained": None},
        "modulus": {"low": least / 2, "high": most * 2, "scale": "log", "units": "kPa", "trained": modulus},
    }


def _along(
    k: int, low: list[float], high: list[float], setup: Setup, domain: Domain | None
) -> dict[str, Any]:
    """The slider of x or y, its trained range from the trained distance to the block's sides."""
    trained = None
    if domain is not None and "site_to_side_mm" in domain.ranges:
        reach = setup.block_size[k] * 5e2 - domain.ranges["site_to_side_mm"][0]
        middle = float(setup.middle[k]) * 1e3
        ends = [middle - reach, middle + reach]
        trained = {"range": ends, "text": f"{ends[0]:.3g} to {ends[1]:.3g} mm"}
    return {"low": low[k], "high": high[k], "step": 0.1, "units": "mm", "trained": trained}


def _trained(domain: Domain | None, key: str) -> dict[str, Any] | None:
    if domain is None:
        return None
    if key in domain.proportional:
        return {"range": None, "text": "any value; the force is proportional"}
    if key not in domain.ranges:
        return None
    low, high = domain.ranges[key]
    units = QUANTITIES[key].units.replace("degrees", DEGREES)
    return {"range": [low, high], "text": f"{low:.3g} to {high:.3g} {units}"}


def checks(domain: Domain | None) -> list[dict[str, Any]]:
    """Rows of the table, in the order of the graph's `beyond`; empty without a domain."""
    if domain is None:
        return []
    found = domain.check(dict.fromkeys(QUANTITIES, 0.0), "none")
    units = [quantity.units for quantity in QUANTITIES.values()]
    rows: list[dict[str, Any]] = [
        {
            "key": check.key,
            "name": check.name,
            "units": units,
            "trained": check.trained or "not known",
            "unit": check.unit,
        }
        for check, units in zip(found, [*units, ""], strict=True)
    ]
    rows[-1]["kinds"] = True
    return rows


def with_units(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of `checks` from a zip of before they had the unit of an excess, which is read off the range."""
    units = {True: "the range", False: "the trained value"}
    ranged = (" to ", " or ")
    return [{"unit": units[any(word in row["trained"] for word in ranged)], **row} for row in rows]


def refusals(block: dict[str, Any], rod: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Limits of the poses that no indentation can have, and their refusals, by `learn.errors.Reason`.

    `block` and `rod` are those of the page's description [mm]. The script fills in the pose (x, y, depth,
    angle), and where the tip comes to the inclusion (limit, cover).
    """
    size, middle = ([1e-3 * v for v in block[key]] for key in ("size", "middle"))
    limits = SiteLimits.around(size, middle, 1e-3 * rod["radius"])
    met = INCLUSION_TEXT.format(depth="{limit}", cover="{cover}", unit="mm")
    return {
        # rounded, since the sliders' values are decimal numbers
        "site": {
            "low": [round(1e3 * v, 6) for v in limits.low],
            "high": [round(1e3 * v, 6) for v in limits.high],
            "text": f"contact point: {limits.site_text('mm')}, got ({{x}}, {{y}}) mm",
        },
        "depth": {
            "least": round(1e3 * limits.height, 6),
            "text": f"depth: {limits.height_text('mm')}, got {{depth}} mm",
        },
        "angle": {
            "most": math.degrees(math.acos(LEAST_COSINE)),
            "text": f"angle: {ANGLE_TEXT}, got {{angle}}",
        },
        "inclusion": {"text": f"depth: {met}, got {{depth}} mm"},
    }


def levels(store: Store) -> list[dict[str, Any]]:
    """The dataset's softness levels with their shear moduli [kPa]."""
    found = []
    for k, name in enumerate(store.softness_names):
        mine = (store.softness == k) & store.done
        if mine.any():
            found.append({"name": name, "modulus": float(store.modulus[mine][0]) * 1e-3})
    return found


def middle_modulus(store: Store) -> float:
    """Geometric mean of the pokes' moduli [kPa]."""
    return math.exp(np.log(store.modulus[store.done]).mean()) * 1e-3
