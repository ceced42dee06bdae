"""The page of a diagnosis: the verdict, the evidence, what the extension buys, and what to measure next."""

from calibration.diagnosis.drawing import Figure, paired_bars
from calibration.diagnosis.report.page import write_report

__all__ = ["Figure", "paired_bars", "write_report"]
