"""Error at the tip relative to the depth. The paper does not define its tip error; this is our choice."""

import numpy as np

from learn.metrics._cases import Cases, Floats, metric


@metric(
    "tip",
    units="%",
    percent=True,
    digits=2,
    text="|predicted - true| at the point that rests nearest to first touch, relative to the depth",
)
def tip_error(cases: Cases) -> Floats:
    """One value a frame, as a share."""
    nearest = cases.away.argmin(axis=1)
    return np.asarray(cases.distance_mm[np.arange(len(nearest)), nearest] / (cases.depth * 1e3))
