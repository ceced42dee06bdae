"""Metric: a measure of two bodies, and the check of a body that all metrics share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from calibration.errors import InputError

if TYPE_CHECKING:
    import trimesh

BodyMetric = Callable[["trimesh.Trimesh", "trimesh.Trimesh"], float]


@dataclass(frozen=True, kw_only=True)
class Metric:
    """A measure of how far a simulated body is from a measured one.

    Attributes
    ----------
    name : str
        Its key in `compare`.
    title : str
        Heading in tables.
    unit : str
        Unit of its value: "m" or "1" (a ratio).
    higher_is_better : bool
        True if a perfect match has the largest value.
    compute : callable
        (simulated, measured) -> value; closed surfaces in m, faces outward.
    """

    name: str
    title: str
    unit: str
    higher_is_better: bool
    compute: BodyMetric


def check_body(mesh: trimesh.Trimesh, name: str) -> None:
    """InputError where a surface bounds no body; `name` says which of the two it is."""
    if not len(mesh.faces):
        raise InputError(f"{name} body: it has no triangles")
    if not mesh.is_watertight or not mesh.is_winding_consistent:
        raise InputError(
            f"{name} body: expected a closed surface with consistent normals, it is open or twisted"
        )
    if not mesh.volume > 0:
        raise InputError(f"{name} body: expected faces turned outward, its volume is {mesh.volume:.3g} m3")
