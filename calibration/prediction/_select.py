"""Selection of trials: patterns of a command line."""

from __future__ import annotations

import csv
from collections.abc import Callable
from fnmatch import fnmatchcase

from calibration.errors import OptionError
from calibration.experiment.model import BeamTrial, Experiment, Trial, specimen_of

# what a pattern may be asked of, beside a trial's id
BY: dict[str, Callable[[Trial], str]] = {
    "id": lambda t: t.id,
    "material": lambda t: t.material,
    "specimen": specimen_of,
    "length": lambda t: f"{1e3 * t.free_length:g}" if isinstance(t, BeamTrial) else "",
    "mode": lambda t: str(getattr(t, "mode", "")),
}


def chosen(experiment: Experiment, pattern: str, option: str) -> tuple[Trial, ...]:
    """Trials that a pattern means: ids with * and ?, or material=, specimen=, length= (of beams [mm]) or
    mode= (of coupons) before one; several by commas, one with a comma in double quotes.

    OptionError where it means none, or asks for something else.
    """
    found: list[Trial] = []
    for one in (p.strip() for p in next(csv.reader([pattern], skipinitialspace=True), [])):
        by, equals, value = one.partition("=")
        if not equals:
            by, value = "id", one
        if by not in BY or not value:
            others = ", ".join(f"{b}=..." for b in BY if b != "id")
            raise OptionError(option, pattern, f"expected ids of trials, or {others}")
        mine = [t for t in experiment.trials if fnmatchcase(BY[by](t), value)]
        if not mine:
            known = ", ".join(dict.fromkeys(v for t in experiment.trials if (v := BY[by](t))))
            raise OptionError(option, one, f"no trial has that {by}: expected some of {known or 'none'}")
        found += mine
    if not found:
        raise OptionError(option, None, "expected ids of trials, got none")
    return tuple(t for t in experiment.trials if t in found)


def split(
    experiment: Experiment, calibrate: str, predict: str
) -> tuple[tuple[Trial, ...], tuple[Trial, ...]]:
    """The trials to fit, and those to predict. OptionError where a trial is both."""
    fitted, wanted = chosen(experiment, calibrate, "calibrate"), chosen(experiment, predict, "predict")
    both = [t.id for t in wanted if t in fitted]
    if both:
        names = ", ".join(both)
        raise OptionError("predict", predict, f"expected trials that are not fitted to, got {names}")
    return fitted, wanted
