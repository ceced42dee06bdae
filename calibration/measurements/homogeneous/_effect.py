"""Effects in homogeneous tests: they change the stress, or the stretch that causes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._effect import EffectModel
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]
Term = Callable[[Array, float, Record], Array]


@dataclass(frozen=True, kw_only=True)
class HomogeneousEffect(EffectModel):
    """An effect in homogeneous tests. The functions take the stretch s (k,), the amplitude and the record.

    Attributes
    ----------
    extra : function to a stress, over the shear modulus, that is added to the baseline's.
    extra_of : function from a variant to its `extra`.
    form : the variant, after `formed`.
    factor : function to a factor on the whole stress.
    shift : function to a shift of the stretch.
    yields : strain of the rig per unit stress and unit amplitude [1/Pa]; the specimen does not have it.
    bounds_in : function from the records that it applies to, to narrower bounds of the amplitude [SI].
    richer : True if the amplitude is the fraction of the stress that comes from the model's richer law in
        place of the baseline's; only models with a richer law have the effect.
    """

    extra: Term | None = None
    extra_of: Callable[[float], Term] | None = None
    form: float | None = None
    factor: Term | None = None
    shift: Term | None = None
    yields: float = 0.0
    bounds_in: Callable[[Sequence[Record]], tuple[float, float]] | None = None
    richer: bool = False

    def formed(self, variant: float | None) -> HomogeneousEffect:
        """The effect in one of its variants."""
        if variant is None or self.extra_of is None:
            return self
        return replace(self, extra=self.extra_of(variant), form=variant)

    @property
    def simulated(self) -> bool:
        return False
