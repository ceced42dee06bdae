"""How an effect enters indentation: the simulated scene, the depth, or the record's force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._effect import EffectModel
from calibration.measurements.indentation._record import Record
from tisim import Mesh, Poke

Array = NDArray[np.float64]

Scene = Callable[[Poke, Mesh | None, float, float | None], Poke]
Force = Callable[[Array, float, Record, float | None], Array]


@dataclass(frozen=True, kw_only=True)
class IndentationEffect(EffectModel):
    """One of `scene`, `shift` and `force`; hooks take the amplitude and the variant.

    Attributes
    ----------
    scene : the simulated scene with the effect.
    nodes : amplitudes at which the scene is simulated, 0 among them; parabolas between.
    straight : lines between the nodes.
    chord : the node towards which the first column is taken.
    chords : variants are no forms of the effect but nodes that the first column may be taken towards, where
        these differ.
    fits : whether a scene can be so simulated.
    finer : it is simulated on the finer mesh, since it changes where cells come to touch.
    retracts : the indenter's retraction is simulated, since the force there differs from loading.
    shift : of the depth [m].
    force : the force of a record [N] (k,) with the effect; applied in the order of `stage`.
    """

    scene: Scene | None = None
    nodes: tuple[float, ...] = ()
    chord: float = 0.0
    fits: Callable[[Poke], bool] = lambda _: True
    straight: bool = False
    finer: bool = False
    retracts: bool = False
    shift: Callable[[float, Record], float] | None = None
    force: Force | None = None
    stage: int = 0
    chords: bool = False

    @property
    def simulated(self) -> bool:
        return self.scene is not None
