"""A rig with known errors from a diagnosis, by which later calibrations on it are corrected."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis._rig_file import RigFile
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.errors import InputError
from calibration.experiment import parse
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._effect import Candidate, reaches
from calibration.measurements.outlines._effect import OutlineEffect, Situation
from tisim import Beam

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Rig:
    """Effects of rig or camera; a `calibration.measurements.outlines.setup.Setup`.

    Attributes
    ----------
    candidates : effects with the scopes in which they were found.
    amplitudes : their amplitudes [SI], c values.
    covariance : covariance of the amplitudes [SI], (c, c).
    digest : SHA-256 of the file.
    found_on : SHA-256 of the experiment that was diagnosed.
    remarks : sentences that a reader of a corrected calibration must know.
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
        # nearly aliased effects make it singular: a small increase of its diagonal has no practical effect
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
        """The same rig, with remarks that concern its use for an experiment."""
        beams = [t for t in experiment.trials if isinstance(t, BeamTrial)]
        remarks = [
            f"{c.label} reaches no beam of this experiment"
            for c in self.candidates
            if not any(reaches(c, t, EFFECTS[c.effect]) for t in beams)
        ]
        if experiment.digest == self.found_on:
            remarks.append("found on these very measurements, which the error bars thus count twice")
        return replace(self, remarks=(*self.remarks, *remarks))

    def _inside(self, trial: BeamTrial) -> Sequence[tuple[OutlineEffect, float, Situation]]:
        """Effects that act in a trial with amplitudes other than 0, in the catalogue's order.

        Effects of a rig are equal in all photographs of a trial (`RigFile` rejects others), so that the time
        in the situation is arbitrary.
        """
        situation = Situation(trial=trial, time=1.0)
        order = list(EFFECTS)
        pairs = sorted(
            zip(self.candidates, self.amplitudes, strict=True), key=lambda pair: order.index(pair[0].effect)
        )
        mine = [(EFFECTS[c.effect], a) for c, a in pairs if reaches(c, trial, EFFECTS[c.effect])]
        return [(effect, amplitude, situation) for effect, amplitude in mine if amplitude != 0.0]


def read_rig(path: Path) -> Rig:
    """Read rig.yaml of photographed beams.

    Raises
    ------
    InputError : the file cannot be used, for example because it is a record of other measurements or has
        effects of a simulator only, or cannot be read. The sentence names the key.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: the rig file cannot be read: {error.strerror}") from error
    file = parse(content, path, RigFile)
    # a fault of the simulator that was diagnosed is not in the beams of the one that calibrates
    kept = [k for k, f in enumerate(file.effects) if f.belongs_to != "simulator"]
    if not kept:
        names = ", ".join(f.effect for f in file.effects)
        raise InputError(f"{path}: key effects: expected one of rig or camera, got {names} of a simulator")
    used = [file.effects[k] for k in kept]
    effects = [EFFECTS[f.effect] for f in used]
    units = np.array([e.per_unit for e in effects])
    values = [f.parameters[e.parameter].value for f, e in zip(used, effects, strict=True)]
    covariance = np.array(file.covariance.matrix)[np.ix_(kept, kept)] / np.outer(units, units)
    return Rig(
        candidates=tuple(Candidate(effect=f.effect, at=f.scope) for f in used),
        amplitudes=tuple(float(a) for a in values / units),
        covariance=tuple(tuple(float(x) for x in row) for row in covariance),
        digest=hashlib.sha256(content).hexdigest(),
        found_on=file.experiment_sha256,
        remarks=tuple(
            f"{f.effect} is a fault of the diagnosed simulator and corrects nothing here"
            for f in file.effects
            if f.belongs_to == "simulator"
        ),
    )


def _shown(candidate: Candidate, amplitude: float) -> str:
    return f"{EFFECTS[candidate.effect].in_file(amplitude):.3g}"


def _inside(candidate: Candidate, amplitude: float) -> float:
    """Amplitude clipped to the bounds of its effect, beyond which there is no scene (compliance below 0)."""
    return float(np.clip(amplitude, *EFFECTS[candidate.effect].bounds))
