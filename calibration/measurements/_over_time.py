"""What a kind of measurement follows of what a material has beside its law: viscosity, softening, fibres.

A kind says so by `Kind.over_time`; one that says nothing is not fitted with such parts. Its model then finds
them in the baseline (`baseline.law.parts`), and must evaluate materials that have them.
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
    """Fits of one kind of measurement over time.

    Attributes
    ----------
    options : tuple
        Of a fit ("time", "damage", "fibres"): parts of these are followed.
    window : callable
        Trials of one material -> what they show of its parts. Times are 0 where no trial has a clock.
    check : callable
        Trials of one material and the specs of parts ("prony:2") -> None; InputError, in one sentence, for
        trials that cannot be fitted with them.
    why_not : str
        Why other parts are not followed, to end a sentence.
    """

    options: tuple[Option, ...]
    window: Callable[[Experiment], ProtocolWindow]
    check: Callable[[Experiment, Sequence[str]], None] = _anything
    why_not: str = ""


def need_clock(trial: str, specs: Sequence[str]) -> None:
    """InputError for a trial without a clock where some part needs one."""
    for spec in specs:
        part = part_kind(spec)
        if part.needs_time:
            raise InputError(f"trial {trial}: --{part.option} {spec}: expected a column time_s in its record")


def union(windows: Sequence[ProtocolWindow]) -> ProtocolWindow:
    """What several kinds of tests show together."""
    timed = [w for w in windows if w.last > 0.0]
    return ProtocolWindow(
        first=min((w.first for w in timed), default=0.0),
        last=max((w.last for w in timed), default=0.0),
        peaks=max((w.peaks for w in windows), default=0),
    )
