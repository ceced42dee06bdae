"""How many pokes go wrong somewhere."""

import numpy as np

from learn.metrics._cases import Cases, Floats, metric

BAD_MM = 1.0


@metric(
    "worse than 1 mm",
    units="%",
    percent=True,
    digits=0,
    text="share of pokes with any point of any frame more than 1 mm off",
)
def bad_pokes(cases: Cases) -> Floats:
    """One value a poke: 1 where it has such a point."""
    worst = cases.distance_mm.max(axis=1)
    return np.array([float(worst[cases.poke == p].max() > BAD_MM) for p in np.unique(cases.poke)])
