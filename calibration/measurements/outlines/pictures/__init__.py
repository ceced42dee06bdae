"""Pictures of photographed beams for the page of a diagnosis."""

from calibration.diagnosis.drawing import Figure
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.pictures._drawn import drawn, in_time
from calibration.measurements.outlines.pictures._residuals import draw_residuals, draw_rms
from calibration.measurements.outlines.pictures._shapes import draw_shapes


def pictures(model: OutlineModel, diagnosis: Diagnosis) -> list[Figure]:
    """Shapes with the misfit magnified, what is left along the beams, and its rms.

    ValueError where a beam has no equilibrium.
    """
    beams = drawn(model, diagnosis)
    apart = in_time(model, diagnosis)
    return [
        draw_shapes(beams, apart=apart),
        draw_residuals(beams, apart=apart),
        draw_rms(beams, diagnosis, noise=model.noise_rms()),
    ]
