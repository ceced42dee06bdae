"""The model under test, with the catalogue's effects; apart from `release_records`, which makes the data."""

from __future__ import annotations

from collections.abc import Sequence

from calibration.diagnosis.catalogue import effects_of
from calibration.experiment import Experiment
from calibration.measurements.release.model import ReleaseModel


def bar_model(
    made: Experiment, *, without: Sequence[str] = (), workers: int | None = None, fem: bool = True
) -> ReleaseModel:
    """With the catalogue's effects."""
    effects = {n: e for n, e in effects_of("release").items() if n not in without}
    return ReleaseModel(made, effects=effects, workers=workers, fem=fem)  # type: ignore[arg-type]
