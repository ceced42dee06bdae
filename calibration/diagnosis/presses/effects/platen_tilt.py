"""An end face and its platen are not parallel: one edge touches first, the rest of the face later. Columns of
the cylinder are pressed side by side, each from where the platen meets it: a foundation of springs, which
leaves out that neighbours hold each other."""

from __future__ import annotations

from calibration.diagnosis.presses.effects._effect import PressEffect

EFFECT = PressEffect(
    name="platen-tilt",
    parameter="gap_percent",
    per_unit=100.0,
    belongs_to="rig",
    step=1e-3,
    bounds=(0.0, 0.1),
    plausible=0.03,
    sentence="platen and end face are not parallel: an edge touches first",
    remedy="seat the platen on a ball, or measure the gap with feelers before the test",
    tilts=True,
    reach="rig",
)
