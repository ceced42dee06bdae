"""A view as HTML: compressed numbers, and one script and one style for all views of a page."""

from __future__ import annotations

import base64
import json
import zlib
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from jinja2 import Environment, StrictUndefined
from numpy.typing import NDArray

from tisim.view._view import Array, Field, Surface, View

COLOURS = "viridis"
LEVELS = 255
SECONDS = 4.0  # duration of all frames when played
# Percentage of a field's values that may lie beyond either end of the colour range, if they reach further
# than BEYOND times that range: a few nodes at a rod's edge should not determine the colours.
OUTSIDE, BEYOND = 2.0, 0.25


@cache
def _text(name: str) -> str:
    return (files("tisim.view") / name).read_text(encoding="utf-8")


def style() -> str:
    """CSS of all views of a page."""
    return _text("view.css")


def script() -> str:
    """JavaScript that draws all views of a page; it has to be included once, after them."""
    return _text("view.js")


def page(view: View) -> str:
    """One page with one view."""
    return _filled("page.html", view=view, style=style(), script=script(), section=section(view, themed=True))


def section(view: View, *, themed: bool = False) -> str:
    """HTML of the view for a page that includes `style` and `script`.

    If `themed`, it is dark on systems with a dark theme.
    """
    data = json.dumps(content(view), separators=(",", ":"), allow_nan=False)
    return _filled("view.html", view=view, data=data.replace("<", "\\u003c"), themed=themed)


def _filled(name: str, **values: Any) -> str:
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    return environment.from_string(_text(name)).render(**values)


class _Numbers:
    """Concatenated arrays, each aligned to 4 bytes."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._size = 0

    def add(self, values: NDArray[Any]) -> dict[str, int]:
        data = np.ascontiguousarray(values).tobytes()
        place = {"at": self._size, "count": values.size}
        self._parts += [data, bytes(-len(data) % 4)]
        self._size += len(data) + -len(data) % 4
        return place

    def packed(self) -> str:
        return base64.b64encode(zlib.compress(b"".join(self._parts), 9)).decode("ascii")


def content(view: View) -> dict[str, Any]:
    """Data of the view for the page's script."""
    from matplotlib import colormaps

    numbers = _Numbers()
    corner, size = _box(view.surfaces)
    extremes = _extremes(view)
    ranges = colour_ranges(view)
    ramp = np.round(255.0 * colormaps[COLOURS](np.linspace(0.0, 1.0, 256))[:, :3]).astype(np.uint8)
    x, y, z = view.towards
    curve = view.curve
    return {
        "labels": view.labels,
        "pace": max(40, round(1e3 * SECONDS / len(view.labels))),
        "opened": view.opened,
        "rest": view.rest,
        "edges": True,
        "corner": _rounded(corner),
        "size": _rounded(size),
        "camera": {
            "turn": float(np.arctan2(y, x)),
            "rise": float(np.arctan2(z, np.hypot(x, y))),
            "radius": float(np.linalg.norm(np.ptp(extremes, axis=0))),
            "corners": [_rounded(c) for c in extremes],
        },
        "ramp": numbers.add(ramp),
        "swatches": ["#{:02x}{:02x}{:02x}".format(*ramp[k]) for k in range(0, 256, 15)],
        "colourings": [
            {"name": f.name, "unit": f.unit, "ticks": ticks_of(f, *ends)} for f, ends in ranges.values()
        ],
        "meshes": [_mesh(s, corner, size, ranges, numbers) for s in view.surfaces],
        "curve": None
        if curve is None or len(curve.x) < 2
        else {
            "x": _rounded(curve.x),
            "y": _rounded(curve.y),
            "x_name": curve.x_name,
            "x_unit": curve.x_unit,
            "y_name": curve.y_name,
            "y_unit": curve.y_unit,
            "x_from_zero": bool(curve.x.min() < 0.5 * curve.x.max()),
        },
        "numbers": numbers.packed(),
    }


def _rounded(values: Array) -> list[float]:
    return [float(f"{v:.8g}") for v in np.asarray(values, dtype=float)]


def _box(surfaces: Any) -> tuple[Array, Array]:
    """Lowest corner and size of the bounding box of surfaces over all frames [m]."""
    low = np.min([s.positions.min(axis=(0, 1)) for s in surfaces], axis=0)
    high = np.max([s.positions.max(axis=(0, 1)) for s in surfaces], axis=0)
    return low, np.maximum(high - low, 1e-9)


def drawn_positions(view: View, *, rest: bool) -> list[Array]:
    """Positions (f, k, 3) [m] of the drawn nodes of each initially shown surface; rest shapes if `rest`."""
    found = []
    for s in view.surfaces:
        if not s.rest or rest:
            drawn = s.opened if view.opened and s.opened is not None else s.triangles
            found.append(s.positions[:, np.unique(drawn)])
    return found


def _extremes(view: View) -> Array:
    """Extreme points (k, 3) of the initial view in many directions [m]."""
    points = [p.reshape(-1, 3) for p in drawn_positions(view, rest=view.rest)]
    turn = 2.4 * np.arange(100)  # the golden angle: directions all around
    height = np.linspace(-1.0, 1.0, len(turn))
    width = np.sqrt(1.0 - height**2)
    directions = np.column_stack([width * np.cos(turn), width * np.sin(turn), height])
    found = [p[np.argmax(p @ directions.T, axis=0)] for p in points]
    return np.unique(np.concatenate(found), axis=0)


def colour_ranges(view: View) -> dict[str, tuple[Field, tuple[float, float]]]:
    """Each field by name with the values at the ends of its colour range, the same in all frames."""
    found: dict[str, tuple[Field, tuple[float, float]]] = {}
    for name in view.colourings:
        of_name = [f for s in view.surfaces for f in s.fields if f.name == name]
        values = np.concatenate([f.values.ravel() for f in of_name])
        low, high = (float(v) for v in np.percentile(values, [OUTSIDE, 100.0 - OUTSIDE]))
        least, most = float(values.min()), float(values.max())
        reach = BEYOND * (high - low)
        low, high = (least if low - least <= reach else low), (most if most - high <= reach else high)
        if 0.0 <= least < 0.2 * high:
            low = 0.0
        if high - low < 1e-12 * max(abs(high), 1e-30):
            low, high = least, most if most > least else least + 1.0
        found[name] = of_name[0], (low, high)
    return found


def ticks_of(colouring: Field, low: float, high: float) -> list[str]:
    """Labels of the ends and the middle of the colour range, with ≤ and ≥ if values lie beyond."""
    size = max(abs(low), abs(high))
    under, over = colouring.values.min() < low - 0.01 * size, colouring.values.max() > high + 0.01 * size
    marks = ["≤ " if under else "", "", "≥ " if over else ""]
    return [m + _plain(v, size) for m, v in zip(marks, (low, 0.5 * (low + high), high), strict=True)]


def _plain(value: float, size: float) -> str:
    text = f"{value:.3g}" if abs(value) > 1e-3 * size else "0"
    return f"{float(text):g}" if abs(float(text)) < 1e6 else text


def _mesh(
    surface: Surface,
    corner: Array,
    size: Array,
    ranges: dict[str, tuple[Field, tuple[float, float]]],
    numbers: _Numbers,
) -> dict[str, Any]:
    scaled = np.round((surface.positions - corner) / size * 65535.0).astype(np.uint16)
    moved = np.concatenate([scaled[:1], np.diff(scaled, axis=0)])  # modulo 2^16, as uint16 is
    found: dict[str, Any] = {
        "name": surface.name,
        "rest": surface.rest,
        "frame": surface.frame,
        "frames": len(scaled),
        "nodes": scaled.shape[1],
        "colour": surface.colour,
        "positions": numbers.add(moved),
        "fields": [],
    }
    for name in ("triangles", "edges", "opened", "opened_edges"):
        part = getattr(surface, name)
        found[name] = None if part is None else numbers.add(part.astype(np.uint32))
    for colouring in surface.fields:
        low, high = ranges[colouring.name][1]
        part = np.clip((colouring.values - low) / (high - low), 0.0, 1.0)
        found["fields"].append(numbers.add(np.round(LEVELS * part).astype(np.uint8)))
    return found
