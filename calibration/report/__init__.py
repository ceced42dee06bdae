"""The page of a calibration: what was found, how far it can be trusted, in words, tables and pictures."""

from calibration.report.page import write_page

__all__ = ["write_page"]
