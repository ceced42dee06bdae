"""Metrics of how far a simulated body is from a measured one. SI units.

>>> import trimesh
>>> from calibration import metrics
>>> body = trimesh.creation.box((0.02, 0.02, 0.10))
>>> moved = body.copy().apply_translation((0.002, 0.0, 0.0))
>>> f"{metrics.dice(body, moved):.3f}"
'0.900'

A metric of one's own is one `Metric` and one call of `register`, in any file:

>>> shift = metrics.Metric(
...     name="centroid_shift",
...     title="distance of the centroids",
...     unit="m",
...     higher_is_better=False,
...     compute=lambda a, b: float(abs(a.centroid - b.centroid).max()),
... )
>>> metrics.register(shift)
>>> f"{metrics.compare(body, moved)['centroid_shift']:.3f}"
'0.002'
>>> metrics.unregister("centroid_shift")
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from calibration.metrics._metric import Metric
from calibration.metrics.distances import (
    HD95,
    SURFACE_DISTANCE,
    hd95,
    point_to_surface,
    surface_distance,
    surface_points,
    vertex_distance,
    vertex_hd95,
)
from calibration.metrics.volumes import DICE, VOLUME_DIFFERENCE, dice, volume_difference

if TYPE_CHECKING:
    import trimesh

# In the order of the paper's table.
_METRICS: dict[str, Metric] = {m.name: m for m in (SURFACE_DISTANCE, HD95, DICE, VOLUME_DIFFERENCE)}

METRICS = MappingProxyType(_METRICS)


def register(metric: Metric) -> None:
    """Add a metric: `compare` computes it, and the table of calibration results has a column of it.

    Raises
    ------
    ValueError
        The name is taken, or is no Python name.
    """
    if metric.name in _METRICS:
        raise ValueError(f"metric: expected a new name, {metric.name!r} is registered already")
    if not metric.name.isidentifier():
        raise ValueError(f"metric: expected a Python name, got {metric.name!r}")
    _METRICS[metric.name] = metric


def unregister(name: str) -> None:
    """Remove a registered metric. Raises KeyError where there is none of that name."""
    del _METRICS[name]


def compare(simulated: trimesh.Trimesh, measured: trimesh.Trimesh) -> dict[str, float]:
    """Every registered metric of one pair of bodies.

    Parameters
    ----------
    simulated, measured : trimesh.Trimesh
        Closed surfaces, faces outward [m], for example from `calibration.shape`.

    Returns
    -------
    dict
        Value by the metric's name, SI (distances in m, the others ratios).

    Raises
    ------
    InputError
        A surface is not closed, or as the metric says.
    """
    return {name: metric.compute(simulated, measured) for name, metric in _METRICS.items()}


__all__ = [
    "METRICS",
    "Metric",
    "compare",
    "dice",
    "hd95",
    "point_to_surface",
    "register",
    "surface_distance",
    "surface_points",
    "unregister",
    "vertex_distance",
    "vertex_hd95",
    "volume_difference",
]
