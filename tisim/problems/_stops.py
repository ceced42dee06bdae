"""Ends of the load steps of a scene: the stops of its course, or its stretches in order."""

from __future__ import annotations

from typing import Any

from tisim.course import Stop
from tisim.material import Material


def shortest_time(material: Material) -> float | None:
    """Shortest relaxation time of a material [s]; None if it does not relax."""
    if material.viscosity is None:
        return None
    spectrum = material.viscosity.spectrum()
    times = spectrum.times[spectrum.strengths > 0.0]
    return float(times.min()) if len(times) else None


def stops_of(scene: Any) -> list[Stop]:
    """Stops of the scene's course; without a course one stop per stretch, all at time 0."""
    if scene.course is None:
        return [Stop(time=0.0, value=float(stretch), frame=True) for stretch in scene.stretches]
    return list(scene.course.stops(shortest_time(scene.material)))
