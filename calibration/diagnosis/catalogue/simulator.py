"""Effects of the simulator: discretisation and solver errors."""

from __future__ import annotations

from calibration.measurements._effect import Effect

LOCKING = Effect(
    name="locking",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator's elements lock: its beams are too stiff",
    remedy="use elements with an independent pressure; refine the mesh to see the result change",
)

COARSE_MESH = Effect(
    name="coarse-mesh",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator's mesh is too coarse",
    remedy="refine the mesh until the result no longer changes",
)

NOT_AT_EQUILIBRIUM = Effect(
    name="not-at-equilibrium",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    sentence="the simulator stops before its beams are at rest",
    remedy="judge rest by the residual force, not by the velocity of the beam",
)
