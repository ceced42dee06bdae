"""Support of a kind of measurement for fits of viscosity, softening and fibres (parts beside the law).

A kind declares it by `Kind.over_time`; a kind without it is not fitted with such parts. The model finds them
in the baseline (`baseline.law.parts`), and must evaluate materials that have them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.parameters import Option, ProtocolWindow, part_kind


def _anything(experiment: Experiment, specs: Sequence[str]) -> None:
    del experiment, specs


@dataclass(frozen=True, kw_only=True)
class OverTime:
    """Support of one kind of measurement for fits with parts.

    Attributes
    ----------
    options : tuple
        Options of a fit ("time", "damage", "fibres") whose parts are supported.
    window : callable
        Function from an experiment of one material to the range of times and peaks that its trials cover;
        times are 0 if no trial has a clock.
    check : callable
        Function of an experiment of one material and the specs of parts ("prony:2"); raises InputError, in
        one sentence, for trials that cannot be fitted with them.
    why_not : str
        Reason why other parts are not supported, as the end of a sentence.
    """

    options: tuple[Option, ...]
    window: Callable[[Experiment], ProtocolWindow]
    check: Callable[[Experiment, Sequence[str]], None] = _anything
    why_not: str = ""


def need_clock(trial: str, specs: Sequence[str]) -> None:
    """InputError for a trial without a clock if a part needs one."""
    for spec in specs:
        part = part_kind(spec)
        if part.needs_time:
            raise InputError(f"trial {trial}: --{part.option} {spec}: expected a column time_s in its record")


def union(windows: Sequence[ProtocolWindow]) -> ProtocolWindow:
    """Union of the windows of several kinds of tests."""
    timed = [w for w in windows if w.last > 0.0]
    return ProtocolWindow(
        first=min((w.first for w in timed), default=0.0),
        last=max((w.last for w in timed), default=0.0),
        peaks=max((w.peaks for w in windows), default=0),
    )
