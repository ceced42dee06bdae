"""Arrangement of panels of beams: rows of materials, columns of supports and lengths."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.drawing.outlines._drawn import DrawnTrial

MOST = 30  # panels of one picture
WIDEST = 5  # panels beside each other where the trials make no grid

Grid = list[list[DrawnTrial | None]]


def grid_of(beams: Sequence[DrawnTrial]) -> tuple[Grid, int]:
    """Rows of panels, and the number of beams left out (those with the smallest residuals).

    There is one row per material, or several if it has several beams of one support and length, and one
    column per support and length. If the grid would be mostly empty or too wide, beams are in their own order
    in up to 3 columns.
    """
    shown = sorted(beams, key=lambda b: -b.largest)[:MOST]
    shown = [b for b in beams if b in shown]
    kinds = sorted({b.kind for b in shown}, key=lambda k: _order(k, shown))
    rows: Grid = []
    for material in dict.fromkeys(b.trial.material for b in shown):
        mine = [b for b in shown if b.trial.material == material]
        by_kind = {k: [b for b in mine if b.kind == k] for k in kinds}
        for n in range(max(len(found) for found in by_kind.values())):
            rows.append([found[n] if n < len(found) else None for found in by_kind.values()])
    if len(rows) * len(kinds) > 1.7 * len(shown) or len(kinds) > WIDEST:
        columns = min(len(shown), 3)
        rows = [list(shown[k : k + columns]) for k in range(0, len(shown), columns)]
        rows[-1] += [None] * (columns - len(rows[-1]))
    return rows, len(beams) - len(shown)


def _order(kind: str, shown: Sequence[DrawnTrial]) -> tuple[str, float]:
    trial = next(b.trial for b in shown if b.kind == kind)
    return ("1" if trial.supports == "clamped-clamped" else "0", trial.free_length)


def left_out(count: int) -> str:
    """Sentence for a caption on beams that are not drawn; "" if there are none."""
    return f" {count} beams that depart less are not drawn." if count else ""
