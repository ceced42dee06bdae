"""Contribution of one kind of measurement to a fit of one material: objectives, and what they leave out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from calibration.experiment.model import Experiment
from calibration.parameters import Parametrisation

if TYPE_CHECKING:
    from calibration.inference import Objective
    from calibration.measurements.outlines.setup import Setup
    from calibration.measurements.outlines.simulators import Simulator

ObjectiveName = Literal["likelihood", "dice"]


@dataclass(frozen=True, eq=False, kw_only=True)
class FitContext:
    """Options of a fit that all kinds of measurement use.

    Attributes
    ----------
    law : the law in search coordinates.
    simulator : simulator of beams.
    workers : number of processes, as in `tisim.simulate`.
    setup : known setup of rig and camera; None if it is not known.
    """

    law: Parametrisation
    simulator: Simulator
    workers: int | None = None
    setup: Setup | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Contribution:
    """Contribution of one kind of measurement.

    Attributes
    ----------
    objectives : its objectives.
    left_out : a sentence for each part of a record that they do not compare.
    steps : factor on the search's steps of moduli (`Parametrisation.in_steps`).
    """

    objectives: tuple[Objective, ...]
    left_out: tuple[str, ...] = ()
    steps: float = 1.0


# from an experiment of a kind's trials of one material
Contribute = Callable[[Experiment, FitContext], Contribution]
