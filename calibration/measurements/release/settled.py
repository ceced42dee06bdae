"""Measurement model of marked beams at rest: where markers are once the beam has settled, by FEM.

For beams without a free vibration, which `ReleaseModel` cannot compare. A fit and a prediction use it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._baseline import Baseline
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._noisy_model import Shown
from calibration.measurements._state import State
from calibration.measurements.release._record import OfMarkers
from calibration.measurements.release.objective import AtRest, MarkerObjective

Array = NDArray[np.float64]

SHEARS = np.geomspace(1e3, 1e6, 13)  # of the scan for a start [Pa]
SETTLED = 1.0 / 3.0  # last part of a record, whose mean is the position at rest


@dataclass(frozen=True, eq=False, kw_only=True)
class SettledRecord(OfMarkers):
    """Markers of one trial at rest; its rows are x, y and z of each marker.

    Attributes
    ----------
    trial : the trial.
    markers : its simulation and the measured positions.
    """

    trial: BeamTrial
    markers: MarkerObjective

    @property
    def points(self) -> int:
        return self.markers.points

    @cached_property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.specimen, "trial": self.name}


class SettledModel(MeasurementModel):
    """Measurement model of beams whose markers are compared at rest only.

    Nuisances are the positions of the markers and the frame of their displacements.

    Parameters
    ----------
    experiment : experiment with beams with markers; other trials are ignored.
    baseline : baseline of one law.
    workers : number of processes for FEM; None for all cores.

    Raises
    ------
    InputError
        If there is no beam with markers, or a trial is incomplete.
    """

    kind = "release"
    unit = ("mm", 1e3)
    coordinate_step = 1e-3  # beyond the tolerance of the equilibrium
    compares_specimens = False
    no_answer = "the beam has no equilibrium at this state"

    records: Sequence[SettledRecord]

    def __init__(self, experiment: Experiment, *, baseline: Baseline, workers: int | None = None) -> None:
        trials = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.markers]
        if not trials:
            raise InputError("experiment.yaml: trials: expected a beam with markers")
        self.experiment = experiment
        self.baseline = baseline
        self.effects = {}
        self.records = [
            SettledRecord(trial=t, markers=_at_rest(t, experiment, workers=workers)) for t in trials
        ]
        self.row_record = np.repeat(np.arange(len(trials)), [r.points for r in self.records])
        sds = [r.markers.sd for r in self.records]
        self.noise = Noise.independent(np.repeat(sds, [r.points for r in self.records]))
        self._set_candidates()

    def start(self) -> Array:
        """Start coordinates (n,) by a scan of the shear modulus. ValueError if no beam has an equilibrium."""
        found = [self.baseline.start(dict.fromkeys(self.baseline.specimens, float(g))) for g in SHEARS]
        misfit = self._misfit([State(u=u) for u in found])
        costs = np.sum((misfit / self.noise.sd) ** 2, axis=1)
        if not np.isfinite(costs).any():
            raise ValueError(self.no_answer)
        return found[int(np.nanargmin(costs))]

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        del rough
        whole = []
        for k, own in enumerate(self._rows()):
            (rest,) = self._simulated(k, [state])
            if rest is None:
                raise ValueError(self.no_answer)
            whole.append(np.pad(rest.columns, ((own.start, len(self.row_record) - own.stop), (0, 0))))
        names = [f"{r.name} {n}" for r in self.records for n in r.markers.nuisance_names]
        self.noise = self.noise.with_nuisances(np.concatenate(whole, axis=1), names)

    def shown(self, k: int) -> Shown:
        r = self.records[k]
        return Shown(
            axis="x, y and z of each marker",
            x=np.arange(float(r.points)),
            quantity="displacement at rest",
            unit=self.unit,
            measured=r.markers.settled.ravel(),
        )

    def _misfit(self, states: Sequence[State]) -> Array:
        found = np.full((len(states), len(self.row_record)), np.nan)
        for k, (r, own) in enumerate(zip(self.records, self._rows(), strict=True)):
            for row, rest in zip(found, self._simulated(k, states), strict=True):
                if rest is not None:
                    row[own] = (rest.displacement - r.markers.settled).ravel()
        return found

    def _rows(self) -> list[slice]:
        ends = np.cumsum([0, *(r.points for r in self.records)]).tolist()
        return [slice(a, b) for a, b in pairwise(ends)]

    def _simulated(self, k: int, states: Sequence[State]) -> list[AtRest | None]:
        """Markers of record `k` at states; None where its beam has no equilibrium.

        At rest, what relaxes has relaxed: the law's moduli are those of long times.
        """
        r = self.records[k]
        materials = [replace(self.baseline.material(r.specimen, s.u), viscosity=None) for s in states]
        return r.markers.at_rest(materials)

    def _discrepancies(self) -> Mapping[str, Array]:
        return {}

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        return {"leave-one-trial-out": [self.records[k].name for k in self.row_record]}

    def noise_sentence(self) -> str:
        return (
            f"{len(self.records)} records at rest, {self.points} points: the marker error that the lab"
            " states. Nuisances: the cameras' frame (2 degrees), the position of each marker (1 mm)."
        )


def _at_rest(trial: BeamTrial, experiment: Experiment, *, workers: int | None) -> MarkerObjective:
    first = min(float(m.time[0]) for m in trial.markers)
    last = min(float(m.time[-1]) for m in trial.markers)
    return MarkerObjective(
        trial,
        experiment.materials[trial.material],
        stages=("settled",),
        window=(1.0 - SETTLED) * (last - first),
        workers=workers,
    )
