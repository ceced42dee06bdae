"""The bridge is slack (positive: its clamps are nearer to each other than its free length) or stretched."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect, Situation, bridge
from tisim import Beam


def _bend(beam: Beam, amplitude: float, _: Situation) -> Beam:
    # the clamps stay where they are seen; more material hangs between them
    dx, dz = beam.clamps.far_shift
    return replace(
        beam,
        length=beam.length + amplitude,
        clamps=replace(beam.clamps, far_shift=(dx - amplitude, dz)),
    )


EFFECT = BeamEffect(
    name="clamp-gap",
    parameter="gap_mm",
    per_unit=1e3,
    belongs_to="rig",
    step=2e-4,
    bounds=(-5e-3, 5e-3),
    plausible=1.5e-3,
    sentence="the beam held at both ends is slack or stretched",
    remedy="measure the distance of the clamps with a gauge block, and the specimen's length",
    bend=_bend,
    touches=bridge,
)
