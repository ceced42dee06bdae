"""The diagnosis of coupons under test, and the experiment that it advises where it is not sure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from _blind_record_verdict import told

from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.coupons.advice import advise
from calibration.experiment import read


def verdict_on(folder: Path, *, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """As `told`; "next": the name of the advised experiment, None where the verdict is not ambiguous."""
    model = CouponModel(read(folder), without=without)
    finding, found = told(model)
    found["next"] = None
    if finding.verdict == "ambiguous":
        one_each = [next(e for e in finding.explanations if e.names == names) for names in finding.rivals]
        found["next"] = advise(model, one_each)[0].name
    return found
