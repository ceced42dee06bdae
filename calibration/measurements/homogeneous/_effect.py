"""How an effect enters a homogeneous test: the stress, or the stretch that makes it."""

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
    """Hooks take the stretch s (k,), the amplitude and the record.

    Attributes
    ----------
    extra : a stress beside the baseline's, over its shear modulus.
    extra_of : the same of a variant. form : the variant that it has become.
    factor : on the whole stress.
    shift : of the stretch.
    yields : strain of the rig by the stress [1/Pa], which the specimen does not see.
    bounds_in : narrower bounds of the amplitude, from the records that it applies to [SI].
    richer : the amplitude is the part of the strain energy that the model's richer law has in place of the
        baseline's; only models with such a law have the effect.
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
