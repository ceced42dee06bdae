"""The page of a diagnosis: the verdict, the evidence, the held-out improvement, and what to measure next."""

from calibration.diagnosis.report.page import write_report

__all__ = ["write_report"]
