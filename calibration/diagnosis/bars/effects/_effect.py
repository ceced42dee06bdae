"""An effect on a bar that is let go: how its amplitude enters what the reduced bar is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from calibration.diagnosis.bars._record import Record
from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.effect import Effect

Reach = Literal["material", "rig"]


def any_record(record: Record) -> bool:
    del record
    return True


@dataclass(frozen=True, kw_only=True)
class BarEffect(Effect):
    """alter: the setting with the effect in it, of the amplitude and the kind.
    kinds: which variants there are (relaxation times [s]); kind_label: in words.
    touches: whether a record can have it.
    reach: "material": in all trials, one material or one specimen; "rig": in all trials, those of one load or
    one of them.
    """

    alter: Callable[[Setting, float, float | None], Setting]
    kinds: tuple[float | None, ...] = (None,)
    kind_label: Callable[[float], str] = str
    touches: Callable[[Record], bool] = any_record
    reach: Reach = "material"


def hung(record: Record) -> bool:
    return record.loaded
