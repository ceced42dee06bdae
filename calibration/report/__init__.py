"""The page of a calibration: results and their uncertainty in sentences, tables and pictures.

Frame, paper, colours and figures are those of the page of a diagnosis too.
"""

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
from calibration.report._html import template
from calibration.report._tables import Cell
from calibration.report._turned import turned_parts
from calibration.report._words import NOTHING, headline, listed, significant, with_sd
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
    "headline",
    "listed",
    "paper",
    "picture",
    "plain",
    "significant",
    "template",
    "turned_parts",
    "with_sd",
    "write_page",
]
