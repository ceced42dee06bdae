"""The page of a calibration: results and their uncertainty in sentences, tables and pictures."""

from calibration.report._words import headline
from calibration.report.page import write_page

__all__ = ["headline", "write_page"]
