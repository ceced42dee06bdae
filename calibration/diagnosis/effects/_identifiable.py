"""Conditions on the loadings of records under which an effect's amplitude is identifiable, in any test.

`unloads`, `loads_again` and `compared_with_others` are rules as they stand (`EffectModel.identifiable`): they
take the records that a candidate reaches, and all records.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DISTINCT = 1.5  # ratio of two rates above which they count as different


class Loaded(Protocol):
    """A record of a driven test, with the name of its trial and its material.

    unloads, reloaded : True if it has an unloading; if it was loaded again after one, here or earlier.
    """

    @property
    def name(self) -> str: ...
    @property
    def material(self) -> str: ...
    @property
    def unloads(self) -> bool: ...
    @property
    def reloaded(self) -> bool: ...


def unloads(reached: Sequence[Loaded], everything: Sequence[Loaded]) -> bool:
    """True if a record has an unloading."""
    del everything
    return any(r.unloads for r in reached)


def loads_again(reached: Sequence[Loaded], everything: Sequence[Loaded]) -> bool:
    """True if a record has a second loading."""
    del everything
    return any(r.reloaded for r in reached)


def compared_with_others(reached: Sequence[Loaded], everything: Sequence[Loaded]) -> bool:
    """True if there is another record of the same material that the candidate does not reach.

    Records are told apart by name, since a record of some of the points of another is the same test.
    """
    names = {r.name for r in reached}
    materials = {r.material for r in reached}
    return any(r.material in materials and r.name not in names for r in everything)


def different_rates(reached: Sequence[Loaded], rates: Callable[[Any], Array]) -> bool:
    """True if a material is tested at two different rates.

    rates : function from a record to its rates of loading, in any one unit; values that are not finite do not
        count.
    """
    for material in {r.material for r in reached}:
        own = np.concatenate([rates(r) for r in reached if r.material == material])
        own = own[np.isfinite(own)]
        if own.size and own.max() > DISTINCT * own.min():
            return True
    return False
