"""Mean distance by how far a point rests from first touch."""

import functools
import itertools

import numpy as np

from learn.metrics._cases import Cases, Floats, metric

EDGES_MM = (0.0, 5.0, 10.0, 20.0, 40.0, np.inf)


def ring(cases: Cases, low: float, high: float) -> Floats:
    """Mean distance [mm] of points that rest low to high [mm] from first touch; NaN where there are none."""
    inside = (cases.away * 1e3 >= low) & (cases.away * 1e3 < high)
    count = inside.sum(axis=1)
    total = np.where(inside, cases.distance_mm, 0).sum(axis=1)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))


for _low, _high in itertools.pairwise(EDGES_MM):
    _name = f"{_low:g}+" if np.isinf(_high) else f"{_low:g}-{_high:g}"
    metric(f"{_name} mm", units="mm", text=f"mean distance of points {_name} mm from first touch")(
        functools.partial(ring, low=_low, high=_high)
    )
