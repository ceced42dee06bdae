"""All that a simulated bar is told: what effects change, one field or two each."""

from __future__ import annotations

from dataclasses import dataclass

from tisim import Circle, Rectangle

Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A bar along x in one clamp, in the plane (x, z). SI.

    shear: modulus [Pa], E = 3 G, as a swing shows it whose angular frequency is one over `reference` [s];
    viscous: stiffness-proportional damping, its one relaxation time [s]; drag: mass-proportional damping
    [1/s].
    branches: further relaxation, (part of that modulus, time [s]) each, which leaves it as it is there.
    length: free [m]; depth: of the free part inside the clamp [m], at the coordinate x = -depth.
    gravity, tip_force: (x, z); tip_mass: that moves with the tip [kg]; load_height: of the point of the end
    face where tip force and mass act [m].
    clamp_turn [rad/Nm], clamp_sag [m/N]: how the clamp yields to moment and force.
    curvature: of the bar free of stress [1/m]; stiffening: c2/c1 of the strain energy; gradient: relative
    change of the modulus per metre along x, zero in the middle [1/m].
    stiff_root: length next to the clamp that in effect does not bend, since the clamp also holds the
    section's form [m]; from FEM (`_fem`), beam theory does not know it.
    inertia: relative excess of all mass in motion, but not in weight.
    scale, roll, clock: of the cameras' displacements (relative), frame [rad] and time (relative).
    """

    section: Circle | Rectangle
    shear: float
    density: float
    length: float
    viscous: float = 0.0
    drag: float = 0.0
    reference: float = 0.02
    branches: tuple[Pair, ...] = ()
    depth: float = 0.0
    gravity: Pair = (0.0, -9.81)
    tip_force: Pair = (0.0, 0.0)
    tip_mass: float = 0.0
    load_height: float = 0.0
    clamp_turn: float = 0.0
    clamp_sag: float = 0.0
    curvature: float = 0.0
    stiffening: float = 0.0
    gradient: float = 0.0
    stiff_root: float = 0.0
    inertia: float = 0.0
    scale: float = 0.0
    roll: float = 0.0
    clock: float = 0.0
