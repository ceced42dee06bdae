"""Metrics of predictions, one a file; `METRICS` in the order of the tables."""

# imported for what they register, in the tables' order
from learn.metrics import (  # noqa: F401, I001
    mean_distance as _mean,
    max_distance as _max,
    tip as _tip,
    force as _force,
    rings as _rings,
    relative as _relative,
    worst as _worst,
    skill as _skill,
)
from learn.metrics._cases import METRICS, Cases, Metric, join_cases

__all__ = ["METRICS", "Cases", "Metric", "join_cases"]
