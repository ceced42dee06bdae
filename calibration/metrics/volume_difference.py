"""Difference of two bodies' volumes."""

from __future__ import annotations

import trimesh

from calibration.metrics._metric import Metric, check_body


def volume_difference(simulated: trimesh.Trimesh, measured: trimesh.Trimesh) -> float:
    """|V(simulated) - V(measured)| / V(measured), a ratio (0.01 is 1 %); the order of the bodies matters.

    It says whether the bodies are of one size, not whether they lie at one place: for a beam it is a matter
    of the reference geometry (section, facets, stretch of the mid line) more than of the material law.
    Raises InputError where a surface is not closed.
    Source: relative absolute volume difference, Heimann et al., IEEE Trans. Med. Imaging 28 (2009) 1251-1265.
    """
    check_body(simulated, "simulated")
    check_body(measured, "measured")
    return abs(float(simulated.volume) - float(measured.volume)) / float(measured.volume)


METRIC = Metric(
    name="volume_difference",
    title="volume difference",
    unit="1",
    higher_is_better=False,
    compute=volume_difference,
)
