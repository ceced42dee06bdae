"""Effects in indentation tests: they change the simulated scene, the depth, or the record's force."""

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
    """An effect in indentation tests; it has one of `scene`, `shift` and `force`.

    Attributes
    ----------
    scene : function of (scene, mesh, amplitude, variant) to the simulated scene with the effect.
    nodes : amplitudes at which the scene is simulated, including 0, with parabolic interpolation between.
    straight : True for linear interpolation between the nodes.
    chord : node to which the finite difference at amplitude 0 goes.
    chords : True if the variants are alternative nodes for that difference, not forms of the effect.
    fits : function that is True for a scene that can be simulated.
    finer : True if it is simulated on the finer mesh, since it changes where cells come into contact.
    retracts : True if the retraction of the indenter is simulated, since its force differs from loading.
    shift : function of (amplitude, record) to a shift of the depth [m].
    force : function of (force [N] (k,), amplitude, record, variant) to the force with the effect.
    stage : order in which forces are applied, ascending.
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
