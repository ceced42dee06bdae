"""A beam as it truly is, with the faults that are hidden in it, and how finely it is solved.

Coordinates as in measured/FORMAT.md: x out of the clamp face, z up. Signs of the faults stand in `Beam`.
"""

from __future__ import annotations

from dataclasses import dataclass

GRAVITY = 9.81
WINDOW = 0.015  # length of a void [m]


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A beam as it truly is. Lengths [m], angles [rad], mu [Pa], density [kg/m3].

    grip_depth: free material inside each grip. near_tilt: positive lifts the free end. compliance
    [rad/(N m)]: each clamp yields to its moment. squeeze: the held section lower by this part, wider so that
    its area stays. gravity_angle: positive pulls towards +x. taper, axial_gradient [1/m]: of the size and of
    the modulus along x, about the middle. transverse_gradient [1/m]: of the modulus along z, positive:
    stiffer on top. curvature [1/m]: of the stress-free axis, positive upwards. void: part of stiffness and
    weight missing over 15 mm about void_at. skin: excess modulus of the outer skin_depth. gap: the far clamp
    is nearer by this. far_pinned: the far face turns freely about its centre. blob [kg]: hung over the last
    3 mm. string [N]: lifts the middle 3 mm. tip [kg]: a known mass, on the free face.
    """

    length: float
    bridge: bool
    mu: float
    density: float = 1000.0
    radius: float = 0.010
    bulk_ratio: float = 1000.0
    stiffening: float = 0.0
    grip_depth: float = 0.0
    near_tilt: float = 0.0
    compliance: float = 0.0
    squeeze: float = 0.0
    gravity_angle: float = 0.0
    taper: float = 0.0
    axial_gradient: float = 0.0
    transverse_gradient: float = 0.0
    curvature: float = 0.0
    void: float = 0.0
    void_at: float = 0.0
    skin: float = 0.0
    skin_depth: float = 0.001
    gap: float = 0.0
    far_pinned: bool = False
    blob: float = 0.0
    string: float = 0.0
    tip: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Resolution:
    """degree: of the bricks; split: each quadrilateral of the section into split^2; first, growth, longest:
    of the layers along the beam [m]. A finer `first` lets the lower edge of a soft long beam crease at the
    clamp, with several equilibria 0.5 mm apart: real perhaps, but of no use here."""

    degree: int = 2
    split: int = 1
    first: float = 0.0018
    growth: float = 1.6
    longest: float = 0.006
