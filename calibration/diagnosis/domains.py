"""Which kinds of measurements can be diagnosed, and the model of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calibration.diagnosis.bars import EFFECTS as BAR_EFFECTS
from calibration.diagnosis.bars import BarModel, all_let_go, holds_let_go
from calibration.diagnosis.beams.effects import EFFECTS
from calibration.diagnosis.beams.model import BeamModel
from calibration.diagnosis.beams.simulators import OURS, SIMULATORS
from calibration.diagnosis.coupons import EFFECTS as COUPON_EFFECTS
from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.pokes import EFFECTS as POKE_EFFECTS
from calibration.diagnosis.pokes import PokeModel
from calibration.diagnosis.presses import EFFECTS as PRESS_EFFECTS
from calibration.diagnosis.presses import PressModel, all_pressed, holds_pressed
from calibration.diagnosis.run import Diagnosable
from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, CouponTrial, Experiment, PokeTrial


def _beams(experiment: Experiment, options: Options) -> Diagnosable:
    return BeamModel(
        experiment,
        simulator=SIMULATORS[options.simulator],
        without=options.without,
        workers=options.workers,
    )


@dataclass(frozen=True)
class Options:
    """without: effects taken out of the catalogue. simulator: of beams, a name of `SIMULATORS`. workers:
    processes (None: all cores)."""

    without: tuple[str, ...] = ()
    simulator: str = OURS.name
    workers: int | None = None


@dataclass(frozen=True)
class Kind:
    """The type of its trials, its model, and its catalogue."""

    trial: type
    model: Callable[[Experiment, Options], Diagnosable]
    effects: tuple[str, ...]


def _coupons(experiment: Experiment, options: Options) -> Diagnosable:
    return CouponModel(experiment, without=options.without)


def _pokes(experiment: Experiment, options: Options) -> Diagnosable:
    return PokeModel(experiment, without=options.without, workers=options.workers)


def _presses(experiment: Experiment, options: Options) -> Diagnosable:
    return PressModel(experiment, without=options.without)


def _bars(experiment: Experiment, options: Options) -> Diagnosable:
    return BarModel(experiment, without=options.without, workers=options.workers)


# A new kind is its trial's type and its model, here.
KINDS: dict[str, Kind] = {
    "beams": Kind(BeamTrial, _beams, tuple(EFFECTS)),
    "pokes": Kind(PokeTrial, _pokes, tuple(POKE_EFFECTS)),
    "coupons": Kind(CouponTrial, _coupons, tuple(COUPON_EFFECTS)),
    "presses": Kind(CouponTrial, _presses, tuple(PRESS_EFFECTS)),
    "bars": Kind(BeamTrial, _bars, tuple(BAR_EFFECTS)),
}


def model_of(
    experiment: Experiment,
    *,
    kind: str | None = None,
    without: Sequence[str] = (),
    simulator: str = OURS.name,
    workers: int | None = None,
) -> Diagnosable:
    """The model of an experiment's beams, pokes or coupons; kind may be left out where there is one only.

    without: effects taken out of the catalogue. simulator: see `calibration.diagnosis.beams.simulators`.
    InputError where the kind is not there, or not said, or where a name is not known.
    """
    there = [n for n, k in KINDS.items() if any(isinstance(t, k.trial) for t in experiment.trials)]
    if "presses" in there and not holds_pressed(experiment):
        there.remove("presses")
    if "bars" in there and not holds_let_go(experiment):
        there.remove("bars")
    if kind is not None and kind not in KINDS:
        raise InputError(f"--kind {kind}: expected one of {', '.join(KINDS)}")
    if kind is not None and kind not in there:
        raise InputError(f"--kind {kind}: the experiment has none; it has {', '.join(there) or 'no trials'}")
    if not there:
        raise InputError(f"experiment.yaml: trials: expected some of {', '.join(KINDS)}")
    if kind is None and "presses" in there:  # coupons that are all pressed cylinders, or not
        there.remove("coupons" if all_pressed(experiment) else "presses")
    if kind is None and "bars" in there:  # beams that are all seen through time, by markers, or not
        there.remove("beams" if all_let_go(experiment) else "bars")
    if kind is None and len(there) > 1:
        raise InputError(f"the experiment has {' and '.join(there)}: say which with --kind")
    chosen = KINDS[kind or there[0]]
    for name in without:
        if name not in chosen.effects:
            raise InputError(f"--without {name}: expected some of {', '.join(chosen.effects)}")
    if simulator not in SIMULATORS:
        raise InputError(f"--simulator {simulator}: expected one of {', '.join(SIMULATORS)}")
    if simulator != OURS.name and chosen is not KINDS["beams"]:
        raise InputError(f"--simulator {simulator}: only beams are simulated in several ways")
    return chosen.model(experiment, Options(tuple(without), simulator, workers))
