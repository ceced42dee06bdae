"""Largest Euclidean distance, the paper's."""

from learn.metrics._cases import Cases, Floats, metric


@metric("max", units="mm", text="largest |predicted - true| of a frame")
def max_distance(cases: Cases) -> Floats:
    """One value a frame [mm]."""
    return cases.distance_mm.max(axis=1)
