"""How much better than doing nothing."""

import numpy as np

from learn.metrics._cases import Cases, Floats, metric


@metric(
    "skill",
    units="",
    digits=2,
    text="1 - mean distance / mean size of the true displacement of a frame: 0 is doing nothing, 1 perfect",
)
def skill(cases: Cases) -> Floats:
    """One value a frame."""
    still = np.sqrt((cases.truth.astype(np.float64) ** 2).sum(axis=2)).mean(axis=1) * 1e3
    return np.asarray(1 - cases.distance_mm.mean(axis=1) / still)
