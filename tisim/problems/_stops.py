"""Ends of the steps of a scene: the stops of its course, or its stretches in order."""

from __future__ import annotations

from typing import Any

from tisim.course import Stop
from tisim.scene import Material


def shortest_time(material: Material) -> float | None:
    """The shortest relaxation time that a material has [s]; None for one that does not relax."""
    if material.viscosity is None:
        return None
    spectrum = material.viscosity.spectrum()
    times = spectrum.times[spectrum.strengths > 0.0]
    return float(times.min()) if len(times) else None


def stops_of(scene: Any) -> list[Stop]:
    """Stops of a scene with stretches or a course."""
    if scene.course is None:
        return [Stop(time=0.0, value=float(stretch), frame=True) for stretch in scene.stretches]
    return list(scene.course.stops(shortest_time(scene.material)))
