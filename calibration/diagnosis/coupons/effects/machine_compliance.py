"""The rig gives way: part of the stretch that is written down is its own, in proportion to the stress."""

from calibration.diagnosis.coupons.effects._effect import CouponEffect

EFFECT = CouponEffect(
    name="machine-compliance",
    parameter="strain_per_MPa",
    per_unit=1e6,
    belongs_to="rig",
    step=1e-9,
    bounds=(0.0, 1e-5),
    plausible=1e-6,
    sentence="the rig gives way, and its travel is taken for the specimen's",
    remedy="measure the strain on the specimen itself (gauge marks), or test a steel bar in the same grips",
    yields=1.0,
    reach="rig",
)
