"""The simulator's mesh is too coarse: this part of the way to a mesh three times finer."""

from dataclasses import replace

from calibration.diagnosis.beams.effects._effect import BeamEffect
from tisim import Beam


def _instead(beam: Beam) -> Beam:
    return replace(beam, layer=beam.layer / 3.0, rings=beam.rings + 1)


EFFECT = BeamEffect(
    name="coarse-mesh",
    parameter="corrected_part",
    per_unit=1.0,
    belongs_to="simulator",
    step=1.0,
    bounds=(-1.0, 3.0),
    plausible=1.0,
    sentence="the simulator's mesh is too coarse",
    remedy="refine the mesh until the answer stands still",
    instead=_instead,
    faulty=lambda simulator: simulator.reference is None and simulator.fidelity.element != "tet4",
)
