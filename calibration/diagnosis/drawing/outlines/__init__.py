"""Figures of photographed beams for the page of a diagnosis."""

from dataclasses import replace

from calibration.diagnosis.drawing._domain import Figure, figures_of
from calibration.diagnosis.drawing.outlines._drawn import drawn, explained_photographs, in_time
from calibration.diagnosis.drawing.outlines._residuals import draw_residuals, draw_rms
from calibration.diagnosis.drawing.outlines._shapes import draw_shapes
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.turned import turned


@figures_of.register(OutlineModel)
def outline_figures(model: OutlineModel, diagnosis: Diagnosis) -> list[Figure]:
    """Figures of shapes with magnified misfit, of residuals along the beams, and of their rms.

    ValueError if a beam has no equilibrium.
    """
    seen = explained_photographs(model, diagnosis)
    beams = drawn(model, diagnosis, seen)
    apart = in_time(model, diagnosis)
    return [
        replace(draw_shapes(beams, apart=apart), view=turned(seen, title=_title(diagnosis))),
        draw_residuals(beams, apart=apart),
        draw_rms(beams, diagnosis, noise=model.noise_rms()),
    ]


def _title(diagnosis: Diagnosis) -> str:
    chosen = diagnosis.chosen
    by = "the baseline" if chosen is None else f"the baseline extended by {' and '.join(chosen.names)}"
    return f"Measured outlines over the beams of {by}"
