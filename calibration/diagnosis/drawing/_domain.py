"""Where a domain (beams, coupons, pokes) hands its own pictures and words to the page of a diagnosis.

A domain writes a function of its model and a diagnosis and registers it by the model's type, in the module
that holds its pictures (imported wherever its model is made):

    @pictures_of.register
    def coupon_pictures(model: CouponModel, diagnosis: Diagnosis) -> list[Figure]: ...
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Literal

import matplotlib.figure

from calibration.diagnosis.verdict import Diagnosis

Section = Literal["shapes", "residuals"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Figure:
    """A picture of the page.

    name: of its file, without the ending; what does not fit a file name is replaced. caption: plain text.
    section: "shapes" where measured stands against simulated, "residuals" where what is left is shown before
    and after the extension.
    """

    name: str
    caption: str
    figure: matplotlib.figure.Figure
    section: Section = "shapes"


@singledispatch
def pictures_of(model: object, diagnosis: Diagnosis) -> list[Figure]:
    """The domain's pictures, in the page's order; none where nobody registered the model's type. ValueError
    where they need a simulation that has no answer."""
    del model, diagnosis
    return []


@singledispatch
def noise_of(model: object) -> str:
    """What the noise model consists of, in a sentence or two; empty where nobody registered the type."""
    del model
    return ""
