"""The surrogate that is told no time, on a dataset with time: for `learn.train --plugin`, to compare."""

from __future__ import annotations

from dataclasses import replace

from learn.data.statistics import Statistics
from learn.models import register_model
from learn.models.invariant_gnn import InvariantGnn


@register_model("without-time")
def without_time(statistics: Statistics) -> InvariantGnn:
    """`invariant-gnn-small` without the invariants of time: nothing that it sees tells it."""
    told_none = replace(statistics, log_time_mean=None, log_speed_mean=None)
    model = InvariantGnn(told_none, hidden=32, messages=8, directions=4)
    model.takes_clock = True  # it is offered the clock, and does not look
    return model
