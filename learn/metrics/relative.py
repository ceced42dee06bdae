"""Relative L2 error of the whole field."""

import numpy as np

from learn.metrics._cases import Cases, Floats, metric


@metric("rel L2", units="", text="sqrt(sum |predicted - true|^2 / sum |true|^2) of a frame")
def relative_l2(cases: Cases) -> Floats:
    """One value a frame."""
    size = np.sqrt((cases.truth.astype(np.float64) ** 2).sum(axis=(1, 2))) * 1e3
    return np.asarray(np.sqrt((cases.distance_mm**2).sum(axis=1)) / size)
