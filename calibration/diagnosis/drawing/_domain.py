"""Figures of the page of a diagnosis, and the function that a kind of measurement registers for its own."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Literal

import matplotlib.figure

from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements._model import MeasurementModel
from tisim.view import View

Section = Literal["shapes", "residuals"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Figure:
    """A figure of the page.

    Attributes
    ----------
    name : file name without extension; characters that are invalid in file names are replaced.
    caption : plain text.
    figure : the figure itself.
    section : "shapes" for measured against simulated data, "residuals" for residuals before and after the
        extension.
    view : interactive 3D view that is shown below the figure; None if there is none.
    """

    name: str
    caption: str
    figure: matplotlib.figure.Figure
    section: Section = "shapes"
    view: View | None = None


@singledispatch
def figures_of(model: MeasurementModel, diagnosis: Diagnosis) -> list[Figure]:
    """Figures of a diagnosis, by the class of its measurement model; none for a kind that registers nothing.

    A kind of measurement registers its own by `figures_of.register(Model)`.

    Raises
    ------
    ValueError
        If a simulation has no result.
    """
    del model, diagnosis
    return []
