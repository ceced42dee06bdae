"""The zero of the depth is off: the surface was touched earlier, or later, than the record says."""

from __future__ import annotations

from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects._effect import PokeEffect


def _shift(amplitude: float, record: Record) -> float:
    del record
    return amplitude


EFFECT = PokeEffect(
    name="depth-offset",
    parameter="offset_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=1e-6,
    bounds=(-2e-3, 2e-3),
    plausible=0.5e-3,
    sentence="the zero of the depth is off: the rod is deeper, or less deep, than the record says",
    remedy="begin the record above the surface, so that the first touch is in it",
    shift=_shift,
    reach="rig",
)
