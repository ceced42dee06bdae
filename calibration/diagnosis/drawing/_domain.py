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
    """A picture of the page.

    name: of its file, without the ending; what does not fit a file name is replaced. caption: plain text.
    section: "shapes" where measured stands against simulated, "residuals" where what is left is shown before
    and after the extension. view: the same to turn around, below it.
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
