"""Common elements of all HTML pages of calibration, diagnosis and prediction: frame, figures, numbers."""

from calibration.pages._figure import (
    BAND,
    COLOURS,
    FAINT,
    INK,
    Look,
    Picture,
    file_name,
    looks,
    paper,
    picture,
    plain,
    round_magnification,
)
from calibration.pages._frame import template
from calibration.pages._numbers import NOTHING, Cell, listed, millimetres, seconds, significant, with_sd
from calibration.pages._turned import turned_parts

__all__ = [
    "BAND",
    "COLOURS",
    "FAINT",
    "INK",
    "NOTHING",
    "Cell",
    "Look",
    "Picture",
    "file_name",
    "listed",
    "looks",
    "millimetres",
    "paper",
    "picture",
    "plain",
    "round_magnification",
    "seconds",
    "significant",
    "template",
    "turned_parts",
    "with_sd",
]
