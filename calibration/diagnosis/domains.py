"""Which kinds of measurements can be diagnosed, and the model of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from calibration.diagnosis.beams.model import BeamModel
from calibration.diagnosis.run import Diagnosable
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment


def _beams(experiment: Experiment, without: Sequence[str], workers: int | None) -> Diagnosable:
    return BeamModel(experiment, without=without, workers=workers)


# A new kind is its trial's type and its model, here.
KINDS: dict[str, tuple[type, Callable[[Experiment, Sequence[str], int | None], Diagnosable]]] = {
    "beams": (BeamTrial, _beams),
}


def model_of(
    experiment: Experiment,
    *,
    kind: str | None = None,
    without: Sequence[str] = (),
    workers: int | None = None,
) -> Diagnosable:
    """The model of an experiment's beams, pokes or coupons; kind may be left out where there is one only.

    without: effects taken out of the catalogue. InputError where the kind is not there, or not said.
    """
    there = [n for n, (trial, _) in KINDS.items() if any(isinstance(t, trial) for t in experiment.trials)]
    if kind is not None and kind not in KINDS:
        raise InputError(f"--kind {kind}: expected one of {', '.join(KINDS)}")
    if kind is not None and kind not in there:
        raise InputError(f"--kind {kind}: the experiment has none; it has {', '.join(there) or 'no trials'}")
    if not there:
        raise InputError(f"experiment.yaml: trials: expected some of {', '.join(KINDS)}")
    if kind is None and len(there) > 1:
        raise InputError(f"the experiment has {' and '.join(there)}: say which with --kind")
    model = KINDS[kind or there[0]][1](experiment, tuple(without), workers)
    unknown = [n for n in without if n not in model.effects and not _known(n)]
    if unknown:
        raise InputError(f"--without {unknown[0]}: no effect of that name")
    return model


def _known(name: str) -> bool:
    from calibration.diagnosis.beams.effects import EFFECTS

    return name in EFFECTS
