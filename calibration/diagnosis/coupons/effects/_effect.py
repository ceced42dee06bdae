"""An effect on coupons: how its amplitude enters the stress, or the stretch that makes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.effect import Effect

Array = NDArray[np.float64]

Reach = Literal["material", "rig"]
Term = Callable[[Array, float, Record], Array]


def always(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    del reached, everything
    return True


def any_record(record: Record) -> bool:
    del record
    return True


@dataclass(frozen=True, kw_only=True)
class CouponEffect(Effect):
    """What the specimen is strained to, and what stress that makes, of the stretch s (k,), the amplitude and
    the record:

    extra: a stress beside the baseline's, over its shear modulus. factor: on the whole stress. shift: of the
    stretch. yields: strain of the rig by the stress [1/Pa], which the specimen does not see.
    touches: whether a record can have it. shows: whether the records that a candidate reaches, among all, let
    its amplitude be seen at all: a candidate that no protocol shows has no column.
    reach: where it may sit: "material": in all trials, one material or one specimen; "rig": in all trials,
    those of one mode or one of them.
    """

    extra: Term | None = None
    factor: Term | None = None
    shift: Term | None = None
    yields: float = 0.0
    touches: Callable[[Record], bool] = any_record
    shows: Callable[[Sequence[Record], Sequence[Record]], bool] = always
    reach: Reach = "material"

    @property
    def simulated(self) -> bool:
        return False
