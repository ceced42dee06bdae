"""The page of a diagnosis: the verdict, the evidence, what the extension buys, and what to measure next."""

from calibration.diagnosis.coupons import pictures as _coupon_pictures  # noqa: F401 - registers them
from calibration.diagnosis.drawing import Figure, noise_of, paired_bars, pictures_of
from calibration.diagnosis.pokes import pictures as _poke_pictures  # noqa: F401 - registers them
from calibration.diagnosis.report import beams
from calibration.diagnosis.report.page import write_report

__all__ = ["Figure", "beams", "noise_of", "paired_bars", "pictures_of", "write_report"]
