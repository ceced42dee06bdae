"""A rig of which a diagnosis knows what it does wrong, so that later calibrations on it are corrected."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis._rig_file import RigFile
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.experiment import parse
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._effect import Candidate, reaches
from calibration.measurements.outlines._effect import OutlineEffect, Situation
from tisim import Beam

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Effects of rig and camera where they were found, with amplitudes [SI] and their covariance.

    A `calibration.measurements.outlines.setup.Setup`. digest: sha256 of the file; found_on: of
    the experiment that it was found on. remarks: what the reader of a corrected calibration must know.
    """

    candidates: tuple[Candidate, ...]
    amplitudes: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    digest: str
    found_on: str
    remarks: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        sds = np.sqrt(np.diag(self.covariance))
        parts = [
            f"{c.label}, {EFFECTS[c.effect].parameter} {_shown(c, a)} ± {_shown(c, sd)}"
            for c, a, sd in zip(self.candidates, self.amplitudes, sds, strict=True)
        ]
        known = f"corrected for what the rig is known to do: {'; '.join(parts)} (sha256 {self.digest[:16]})"
        return "; ".join([known, *self.remarks])

    def bend(self, beam: Beam, trial: BeamTrial) -> Beam:
        for effect, amplitude, situation in self._inside(trial):
            beam = effect.bend(beam, amplitude, situation)
        return beam

    def image(self, points: Array, trial: BeamTrial) -> Array:
        for effect, amplitude, situation in self._inside(trial):
            if effect.image is not None:
                points = effect.image(points, amplitude, situation)
        return points

    def doubts(self) -> list[tuple[str, Rig]]:
        sds = np.sqrt(np.diag(self.covariance))
        scale = np.where(sds > 0.0, sds, 1.0)
        correlation = np.array(self.covariance) / np.outer(scale, scale)
        # effects that are nearly one make it singular: a trifle more on its diagonal does not matter
        root = scale[:, None] * np.linalg.cholesky(correlation + 2e-4 * np.eye(len(sds)))
        found = []
        for c, direction, sd in zip(self.candidates, root.T, sds, strict=True):
            if sd > 0.0:
                moved = [
                    _inside(k, a) for k, a in zip(self.candidates, self.amplitudes + direction, strict=True)
                ]
                found.append((f"{c.label} (rig)", replace(self, amplitudes=tuple(moved))))
        return found

    def on(self, experiment: Experiment) -> Rig:
        """The same with remarks on what it means for an experiment."""
        beams = [t for t in experiment.trials if isinstance(t, BeamTrial)]
        remarks = [
            f"{c.label} reaches no beam of this experiment"
            for c in self.candidates
            if not any(reaches(c, t, EFFECTS[c.effect]) for t in beams)
        ]
        if experiment.digest == self.found_on:
            remarks.append("found on these very measurements, which the error bars thus count twice")
        return replace(self, remarks=tuple(remarks))

    def _inside(self, trial: BeamTrial) -> Sequence[tuple[OutlineEffect, float, Situation]]:
        """What reaches a trial, in the catalogue's order. No effect of a rig differs from one photograph of a
        trial to the next (`RigFile` refuses those that do), so that the time is of no matter."""
        situation = Situation(trial=trial, time=1.0)
        order = list(EFFECTS)
        pairs = sorted(
            zip(self.candidates, self.amplitudes, strict=True), key=lambda pair: order.index(pair[0].effect)
        )
        mine = [(EFFECTS[c.effect], a) for c, a in pairs if reaches(c, trial, EFFECTS[c.effect])]
        return [(effect, amplitude, situation) for effect, amplitude in mine if amplitude != 0.0]


def read_rig(path: Path) -> Rig:
    """Of a file on photographed beams. InputError, in one sentence, names the key where it cannot be used, as
    in a record of other measurements; OSError as it comes."""
    content = path.read_bytes()
    file = parse(content, path, RigFile)
    effects = [EFFECTS[e.effect] for e in file.effects]
    units = np.array([e.per_unit for e in effects])
    values = [f.parameters[e.parameter].value for f, e in zip(file.effects, effects, strict=True)]
    covariance = np.array(file.covariance.matrix) / np.outer(units, units)
    return Rig(
        candidates=tuple(Candidate(effect=f.effect, at=f.scope) for f in file.effects),
        amplitudes=tuple(float(a) for a in values / units),
        covariance=tuple(tuple(float(x) for x in row) for row in covariance),
        digest=hashlib.sha256(content).hexdigest(),
        found_on=file.experiment_sha256,
    )


def _shown(candidate: Candidate, amplitude: float) -> str:
    return f"{EFFECTS[candidate.effect].in_file(amplitude):.3g}"


def _inside(candidate: Candidate, amplitude: float) -> float:
    """Beyond its bounds an effect has no scene: a compliance is not negative."""
    return float(np.clip(amplitude, *EFFECTS[candidate.effect].bounds))
