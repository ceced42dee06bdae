"""The release model under test, with the catalogue's effects; `benchmarks.blind.release` makes the data."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.catalogue import effects_of
from calibration.experiment import Experiment
from calibration.measurements.release.model import ReleaseModel


def bar_model(
    made: Experiment,
    *,
    without: Sequence[str] = (),
    workers: int | None = None,
    fem: bool = True,
    further: bool = False,
) -> ReleaseModel:
    """Model with the catalogue's effects; those of the second round only if `further`."""
    known = effects_of("release").items()
    effects = {n: e for n, e in known if n not in without and (further or not e.further)}
    return ReleaseModel(made, effects=effects, workers=workers, fem=fem)  # type: ignore[arg-type]
