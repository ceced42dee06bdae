"""What kinds that measure curves share: how records of trials are thinned, grouped and spoken of."""

from calibration.diagnosis.records._bins import bins
from calibration.diagnosis.records._columns import Columns, legendre
from calibration.diagnosis.records._families import distinct, fifths
from calibration.diagnosis.records._names import listed
from calibration.diagnosis.records._scopes import scopes

__all__ = ["Columns", "bins", "distinct", "fifths", "legendre", "listed", "scopes"]
