"""An effect on pokes: how its amplitude enters the simulated poke, the depth or the record's force."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.effect import Effect
from calibration.diagnosis.pokes._record import Record
from tisim import Mesh, Poke

Array = NDArray[np.float64]

Reach = Literal["material", "block", "rig"]
Scene = Callable[[Poke, Mesh | None, float, float | None], Poke]
Force = Callable[[Array, float, Record, float | None], Array]


def always(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    del reached, everything
    return True


def one_kind(records: Sequence[Record]) -> tuple[float | None, ...]:
    del records
    return (None,)


@dataclass(frozen=True, kw_only=True)
class PokeEffect(Effect):
    """One of these three, with the amplitude and the kind (below):

    scene: the simulated poke with the effect in it; `nodes`: amplitudes at which it is simulated, 0 among
    them, parabolas between, or lines where it is `straight`; chord: the node towards which the first column
    is taken. fits: whether a poke can be so simulated. finer: it is simulated on the finer mesh, since what
    it changes is where cells come to touch; back: the rod's way back is simulated, since the force there is
    another. shift: of the depth [m]. force: what becomes of the force [N] (k,) of a record, in the order of
    `stage`.

    kinds: variants of the effect (a time constant, a direction); what it is called: see `kind_label`. chords:
    they are no variants but nodes that the first column may be taken towards, where these are unlike.
    touches: whether a record can have it. shows: whether the records that a candidate reaches, among all, let
    its amplitude be seen at all: a candidate that no protocol shows has no column. reach: where it may sit:
    "material": in all trials, one material or one specimen; "block": also in blocks of one size; "rig": in
    all trials, those of one rod or one of them.
    """

    scene: Scene | None = None
    nodes: tuple[float, ...] = ()
    chord: float = 0.0
    fits: Callable[[Poke], bool] = lambda _: True
    straight: bool = False
    finer: bool = False
    back: bool = False
    shift: Callable[[float, Record], float] | None = None
    force: Force | None = None
    stage: int = 0
    kinds: Callable[[Sequence[Record]], tuple[float | None, ...]] = one_kind
    kind_label: Callable[[float], str] = lambda kind: f"{kind:g}"
    chords: bool = False
    touches: Callable[[Record], bool] = lambda _: True
    shows: Callable[[Sequence[Record], Sequence[Record]], bool] = always
    reach: Reach = "rig"

    @property
    def simulated(self) -> bool:
        return self.scene is not None
