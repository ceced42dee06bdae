"""The tables' rows: modulus errors of the default, of linear elements and of faceted sections."""

from __future__ import annotations

import numpy as np

from calibration.measurements.outlines import Fidelity
from studies.corrections.bench import MIXTURES, RATIOS, Beams, note, percent, signed
from studies.corrections.fits import Fitted, default_fit, least_squares
from studies.corrections.shortcuts import Faceted
from tisim.mesh import PAPER_LAYER, PAPER_RINGS

POLYGONS = {12: 2, 30: 5}  # sides of the inscribed section: rings of elements


def default() -> list[list[str]]:
    """The default fit, and by least squares with K/G held."""
    rows = []
    for mixture in MIXTURES:
        fit = default_fit(mixture)
        error = signed(percent(mixture, fit.shear))
        rows.append([mixture, "default, likelihood", error, f"chi2/n {fit.misfit:.2f}"])
        note(f"{rows[-1]}")
        beams = Beams(mixture, Fidelity())
        for ratio in RATIOS:
            squares = least_squares(beams, ratio, fit.shear)
            rows.append(_row(f"default, K/G {ratio:.0f}", mixture, squares))
    return rows


def linear() -> list[list[str]]:
    """Plain 4-node tetrahedra at the paper's fineness."""
    rows = []
    fidelity = Fidelity(element="tet4", axial_element_size=PAPER_LAYER, radial_elements=PAPER_RINGS)
    for mixture in MIXTURES:
        beams = Beams(mixture, fidelity)
        start = default_fit(mixture).shear
        for ratio in RATIOS:
            squares = least_squares(beams, ratio, start)
            start = squares.shear if np.isfinite(squares.shear) else start
            rows.append(_row(f"4-node, K/G {ratio:.0f}", mixture, squares))
    return rows


def faceted() -> list[list[str]]:
    """The section as an inscribed polygon, all else as by default (K/G 300 held)."""
    rows = []
    for mixture in MIXTURES:
        for sides, rings in POLYGONS.items():
            beams = Faceted(mixture, Fidelity(radial_elements=rings))
            squares = least_squares(beams, 300.0, default_fit(mixture).shear)
            rows.append(_row(f"{sides} sides", mixture, squares))
    return rows


def _row(label: str, mixture: str, squares: Fitted) -> list[str]:
    row = [mixture, label, signed(percent(mixture, squares.shear)), f"{1e3 * squares.misfit:.2f}"]
    note(f"{label}, {mixture}: {row[2:]}, {squares.steps} steps")
    return row
