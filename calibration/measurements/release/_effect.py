"""Effects in cantilever releases: they change the parameters of the reduced beam."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from calibration.measurements._effect import EffectModel
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release._record import Record


@dataclass(frozen=True, kw_only=True)
class ReleaseEffect(EffectModel):
    """An effect on a released beam.

    Attributes
    ----------
    alter : function of (parameters, amplitude, variant) to the parameters with the effect.
    """

    alter: Callable[[BeamParameters, float, float | None], BeamParameters]


def hung(record: Record) -> bool:
    """True if a mass hangs on the free end."""
    return record.loaded
