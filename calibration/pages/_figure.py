"""Figure kit of all pages: paper, colours, PNG. Matplotlib without a display."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable
from dataclasses import dataclass
from math import floor, log10
from typing import Any

from matplotlib.figure import Figure

# Okabe and Ito's palette, which colour-blind people tell apart.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C6D31")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<")
LINES = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (8, 2, 2, 2)), (0, (4, 4)), (0, (1, 3)))
INK, FAINT, BAND = "#222222", "#A0A6AD", "#E4E9EF"
DPI = 120


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A PNG with the name of its file and what it shows."""

    name: str
    png: bytes
    caption: str

    @property
    def source(self) -> str:
        """A data URI."""
        return "data:image/png;base64," + base64.b64encode(self.png).decode("ascii")


def paper(width: float, height: float) -> Figure:
    """An empty figure [inches], outside pyplot: saved as a PNG it is drawn by Agg, whatever the backend."""
    return Figure(figsize=(width, height), layout="constrained")


def picture(figure: Figure, name: str, caption: str) -> Picture:
    """The figure as a PNG; the name, made fit for a file, without its ending."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=DPI, metadata={"Software": None})
    return Picture(name=file_name(name) + ".png", png=file.getvalue(), caption=caption)


def file_name(name: str) -> str:
    """The name with ASCII letters, digits, dots and dashes alone; two names may become one."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", name).strip("-.") or "picture"


def round_magnification(wanted: float, digits: Iterable[float] = (1, 2, 5)) -> float:
    """The largest round factor up to `wanted`, one of `digits` times a power of ten; at least 1."""
    if wanted <= 1.0:
        return 1.0
    power = 10.0 ** floor(log10(wanted))
    return float(max(d * power for d in digits if d * power <= wanted))


def plain(axes: Any) -> Any:
    """Axes without a box."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)
    return axes


@dataclass(frozen=True, kw_only=True)
class Look:
    """Colour, marker and line style of a law, chosen so that coinciding lines are visible."""

    colour: str
    marker: str
    line: Any


def looks(labels: Iterable[str]) -> dict[str, Look]:
    """The look of each law, in order of appearance."""
    return {
        name: Look(colour=COLOURS[i % 8], marker=MARKERS[i % 8], line=LINES[i % len(LINES)])
        for i, name in enumerate(dict.fromkeys(labels))
    }
