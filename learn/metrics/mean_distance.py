"""Mean Euclidean distance, the paper's."""

from learn.metrics._cases import Cases, Floats, metric


@metric("mean", units="mm", text="mean over all points of |predicted - true|", digits=4)
def mean_distance(cases: Cases) -> Floats:
    """One value a frame [mm]."""
    return cases.distance_mm.mean(axis=1)
