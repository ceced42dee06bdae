"""Mean distance of two surfaces."""

from __future__ import annotations

import trimesh

from calibration.metrics._metric import Metric, check_body
from calibration.metrics.distances import SAMPLES_LOG2, SEED, both_ways


def surface_distance(
    simulated: trimesh.Trimesh,
    measured: trimesh.Trimesh,
    *,
    samples_log2: int = SAMPLES_LOG2,
    seed: int = SEED,
) -> float:
    """Mean distance [m] from points of either surface to the nearest place on the other one.

    The mean over each surface's area, then the mean of the two directions ("average symmetric surface
    distance"): 2**samples_log2 points a surface, spread by area, to triangles, not to vertices.
    Raises InputError where a surface is not closed.
    Source: Heimann et al., IEEE Trans. Med. Imaging 28 (2009) 1251-1265, there with pooled points.
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    there, back = both_ways(simulated, measured, samples_log2=samples_log2, seed=seed)
    return float(there.mean() + back.mean()) / 2


METRIC = Metric(
    name="surface_distance",
    title="mean surface distance",
    unit="m",
    higher_is_better=False,
    compute=surface_distance,
)
