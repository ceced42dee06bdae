"""The surrogate whose depths are shares of each block's height: for `learn.train --plugin`, to compare."""

from __future__ import annotations

from dataclasses import replace

from learn.data import Statistics
from learn.models import InvariantGnn, register_model


@register_model("own-height")
def own_height(statistics: Statistics) -> InvariantGnn:
    """`invariant-gnn` that is not told the height of a block: equal shares of it look alike."""
    return InvariantGnn(replace(statistics, block_height=None))
