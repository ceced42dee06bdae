"""Pictures of photographed beams for the page of a diagnosis."""

from calibration.diagnosis.beams import BeamModel
from calibration.diagnosis.drawing import Figure, noise_of, pictures_of
from calibration.diagnosis.report.beams._drawn import drawn, in_time
from calibration.diagnosis.report.beams._noise import noise
from calibration.diagnosis.report.beams._residuals import draw_residuals, draw_rms
from calibration.diagnosis.report.beams._shapes import draw_shapes
from calibration.diagnosis.verdict import Diagnosis


@pictures_of.register
def beam_pictures(model: BeamModel, diagnosis: Diagnosis) -> list[Figure]:
    """Shapes with the departure magnified, what is left along the beams, and its rms.

    ValueError where a beam has no equilibrium.
    """
    beams = drawn(model, diagnosis)
    apart = in_time(model, diagnosis)
    return [
        draw_shapes(beams, apart=apart),
        draw_residuals(beams, apart=apart),
        draw_rms(beams, diagnosis, noise=model.noise_rms()),
    ]


@noise_of.register
def beam_noise(model: BeamModel) -> str:
    return noise(model)
