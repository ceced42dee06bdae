"""The words of pressed cylinders on the page of a diagnosis; its pictures are those of coupons."""

from __future__ import annotations

from calibration.diagnosis.coupons import pictures as _coupon_pictures
from calibration.diagnosis.drawing import noise_of
from calibration.diagnosis.presses.model import PressModel


@noise_of.register
def press_noise(model: PressModel) -> str:
    known = (
        "a smooth deviation of each record as large as the repeats of the experiment show"
        if model.wobble.told_by
        else "no scatter from test to test, since there are too few repeats"
    )
    return (
        f"{_coupon_pictures.coupon_noise(model)[:-1]}; {known}; 0.3 % of mesh error in what bonded"
        " platens add."
    )
