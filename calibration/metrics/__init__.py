"""How far a simulated body is from a measured one: one file a metric, one line here. SI units.

>>> import trimesh
>>> from calibration import metrics
>>> body = trimesh.creation.box((0.02, 0.02, 0.10))
>>> moved = body.copy().apply_translation((0.002, 0.0, 0.0))
>>> f"{metrics.dice(body, moved):.3f}"
'0.900'
"""

from __future__ import annotations

import trimesh

from calibration.metrics._metric import Metric
from calibration.metrics.dice import METRIC as _DICE
from calibration.metrics.dice import dice
from calibration.metrics.distances import point_to_surface, surface_points
from calibration.metrics.hd95 import METRIC as _HD95
from calibration.metrics.hd95 import hd95
from calibration.metrics.surface_distance import METRIC as _SURFACE_DISTANCE
from calibration.metrics.surface_distance import surface_distance
from calibration.metrics.vertices import vertex_distance, vertex_hd95
from calibration.metrics.volume_difference import METRIC as _VOLUME_DIFFERENCE
from calibration.metrics.volume_difference import volume_difference

# In the order of the paper's table.
METRICS: dict[str, Metric] = {
    metric.name: metric for metric in (_SURFACE_DISTANCE, _HD95, _DICE, _VOLUME_DIFFERENCE)
}


def compare(simulated: trimesh.Trimesh, measured: trimesh.Trimesh) -> dict[str, float]:
    """Every metric of one pair of bodies, by name, in SI (distances in m, the others ratios).

    simulated, measured: closed surfaces in m, for example from `calibration.shape`.
    Raises InputError as the metrics do.
    """
    return {name: metric.compute(simulated, measured) for name, metric in METRICS.items()}


__all__ = [
    "METRICS",
    "Metric",
    "compare",
    "dice",
    "hd95",
    "point_to_surface",
    "surface_distance",
    "surface_points",
    "vertex_distance",
    "vertex_hd95",
    "volume_difference",
]
