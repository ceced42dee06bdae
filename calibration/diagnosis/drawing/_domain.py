"""A picture of the page of a diagnosis, as `MeasurementModel.pictures` returns it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import matplotlib.figure

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
