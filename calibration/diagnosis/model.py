"""Construction of the model that a diagnosis searches: measurements of one kind with effects."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from calibration.diagnosis.catalogue import effects_of, true_name
from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.measurements._kinds import build, kind_of
from calibration.measurements._model import MeasurementModel

DEFAULT_SIMULATOR = "tisim"


def model_of(
    experiment: Experiment,
    *,
    kind: str | None = None,
    without: Sequence[str] = (),
    simulator: str = DEFAULT_SIMULATOR,
    workers: int | None = None,
    further: bool = True,
    **baseline: Any,
) -> MeasurementModel:
    """Build the model of an experiment's measurements with the effects of the catalogue.

    Parameters
    ----------
    kind : kind of measurement; may be omitted if the experiment has one only.
    without : names of effects to leave out.
    simulator : simulator of outlines, a name of `calibration.measurements.outlines.simulators.SIMULATORS`.
    workers : number of processes; None for all cores.
    further : include effects that are searched for only if the others do not explain the data.
    baseline : options law, terms and richer of kinds whose baseline has a choice of laws.

    Raises
    ------
    InputError : the kind is unknown, absent or not named, another name is unknown, or the kind of measurement
        does not take an option.
    """
    chosen = kind_of(experiment, kind)
    effects = effects_of(chosen.name)
    left_out = {true_name(chosen.name, name) for name in without}
    for name in without:
        if true_name(chosen.name, name) not in effects:
            raise InputError(f"--without {name}: expected some of {', '.join(effects)}")
    for name in baseline:
        if name not in chosen.takes:
            raise InputError(f"--{name} {baseline[name]}: {chosen.name} has one law only, expected auto")
    kept = {n: e for n, e in effects.items() if n not in left_out and (further or not e.further)}
    if simulator == DEFAULT_SIMULATOR:
        return build(chosen, experiment, effects=kept, workers=workers, **baseline)
    if "simulator" not in chosen.takes:
        raise InputError(f"--simulator {simulator}: only outlines are simulated in several ways")
    from calibration.measurements.outlines.simulators import SIMULATORS

    if simulator not in SIMULATORS:
        raise InputError(f"--simulator {simulator}: expected one of {', '.join(SIMULATORS)}")
    return build(chosen, experiment, effects=kept, workers=workers, simulator=SIMULATORS[simulator])
