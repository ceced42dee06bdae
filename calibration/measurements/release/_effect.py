"""How an effect enters a cantilever release: the parameters of the reduced beam."""

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
    alter : the parameters with the effect in them, from those without it, the amplitude and the variant.
    """

    alter: Callable[[BeamParameters, float, float | None], BeamParameters]


def hung(record: Record) -> bool:
    """A mass hangs on the free end."""
    return record.loaded
