"""Effects of the simulator: discretisation and solver errors."""

from __future__ import annotations

from calibration.measurements._effect import Effect

LOCKING = Effect(
    name="locking",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator's elements lock: its beams are too stiff",
    remedy="use elements with a pressure of their own; refine the mesh to see the answer move",
)

COARSE_MESH = Effect(
    name="coarse-mesh",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator's mesh is too coarse",
    remedy="refine the mesh until the answer stands still",
)

NOT_AT_EQUILIBRIUM = Effect(
    name="not-at-equilibrium",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator stops before its beams are at rest",
    remedy="judge rest by the force that is out of balance, not by how slowly the beam moves",
)
