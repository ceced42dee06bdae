"""Drawing of beams: shades of time, clamps, magnification, scale bar."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib import colormaps
from matplotlib.patches import Rectangle

from calibration.diagnosis.drawing.outlines._drawn import DrawnTrial
from calibration.pages import INK, round_magnification

MEASURED, EXTENDED = "Blues", "Oranges"
CLAMP = "#6B7480"
_AWAY = 0.8  # largest distance as drawn, over half a beam's height: edges must not meet


def shade(family: str, nth: int, count: int) -> Any:
    """Shade of the nth photograph of `count`; later ones are darker."""
    return colormaps[family](0.45 + 0.5 * (nth / (count - 1) if count > 1 else 0.7))


def magnification(beams: Sequence[DrawnTrial]) -> float:
    """Round magnification for all panels: the largest residual is drawn as up to _AWAY half heights."""
    half = min(0.5 * float(abs(b.body[0][0] - b.body[1][0]).max()) for b in beams)
    largest = max(b.largest for b in beams)
    return round_magnification(_AWAY * half / largest, (1, 1.5, 2, 3, 5, 7)) if largest > 0.0 else 1.0


def clamps(axes: Any, beam: DrawnTrial, depth_mm: float) -> None:
    """Draw the grips of a beam; depth_mm : their length."""
    upper, lower = (1e3 * line for line in beam.body)
    places = [(upper[0], lower[0], -depth_mm)]
    if beam.trial.supports == "clamped-clamped":
        places.append((upper[-1], lower[-1], depth_mm))
    for top, bottom, width in places:
        high = 1.15 * (top[1] - bottom[1])
        axes.add_patch(
            Rectangle(
                (0.5 * (top[0] + bottom[0]), 0.5 * (top[1] + bottom[1] - high)),
                width,
                high,
                color=CLAMP,
                lw=0,
                zorder=1,
            )
        )


def scale_bar(axes: Any, length_mm: float) -> None:
    """Draw a scale bar in the lower left corner."""
    x, z = axes.get_xlim()[0], axes.get_ylim()[0]
    axes.plot([x, x + length_mm], [z, z], color=INK, lw=2.5, solid_capstyle="butt", clip_on=False)
    axes.annotate(
        f"{length_mm:g} mm",
        (x + length_mm, z),
        xytext=(4, 0),
        textcoords="offset points",
        fontsize=8,
        va="center",
        annotation_clip=False,
    )
