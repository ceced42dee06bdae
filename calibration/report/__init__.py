"""The page of a calibration: what was found, how far it can be trusted, in words, tables and pictures.

Frame, paper, colours and figures are those of the page of a diagnosis too.
"""

from calibration.report._base import template
from calibration.report._figure import (
    BAND,
    COLOURS,
    FAINT,
    INK,
    Picture,
    file_name,
    paper,
    picture,
    plain,
)
from calibration.report._numbers import NOTHING, significant, with_sd
from calibration.report._tables import Cell
from calibration.report._words import listed
from calibration.report.page import write_page

__all__ = [
    "BAND",
    "COLOURS",
    "FAINT",
    "INK",
    "NOTHING",
    "Cell",
    "Picture",
    "file_name",
    "listed",
    "paper",
    "picture",
    "plain",
    "significant",
    "template",
    "with_sd",
    "write_page",
]
