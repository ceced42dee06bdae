"""Report page of a diagnosis: verdict, evidence, improvement by the extension, recommended experiment."""

from calibration.diagnosis.report.page import write_report

__all__ = ["write_report"]
