"""The made experiment that all is fitted to, and its truth, which is read for the percentages alone."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import cache

import numpy as np
import yaml
from numpy.typing import NDArray

import tisim
from calibration.experiment import BeamTrial, read
from calibration.measurements.objective import ModelObjective
from calibration.measurements.outlines import Fidelity, away_from_clamps, beam_scene, edges, project
from calibration.measurements.outlines.model import OutlineModel
from calibration.parameters import parametrisation
from calibration.study import measurements
from studies.measured import MADE

Array = NDArray[np.float64]

LAW = parametrisation("neo-hookean")
CLAMP_ZONE = 0.5  # half heights next to a clamp that the least squares leave out
BENCH = MADE / "bench" / "clean"
MIXTURES = ("S0", "S0.5", "S1")
RATIOS = (20.0, 100.0, 1000.0)  # K/G; the bench was made with 1000
BEGUN = time.process_time()


@cache
def truth() -> dict[str, float]:
    """The moduli that the bench was made with [Pa]."""
    text = (BENCH / "truth.yaml").read_text(encoding="utf-8")
    return {k: float(v) for k, v in yaml.safe_load(text)["shear_modulus_Pa"].items()}


def percent(mixture: str, shear: float) -> float:
    return 100.0 * (shear / truth()[mixture] - 1.0)


@cache
def objective(mixture: str) -> ModelObjective[OutlineModel]:
    """The likelihood that calibration.fit uses, with its mesh correction."""
    found = measurements(read(BENCH), mixture, LAW, workers=1).outlines
    assert found is not None
    return found


class Beams:
    """Traced photographs of a mixture, and a simulation of its beams without mesh correction."""

    def __init__(self, mixture: str, fidelity: Fidelity) -> None:
        data = read(BENCH)
        self.trials = [t for t in data.trials if isinstance(t, BeamTrial) and t.material == mixture]
        self.density = data.materials[mixture].density or 1000.0
        self.fidelity = fidelity
        self.photographs = [
            (i, away_from_clamps(c.outline, t, zone=CLAMP_ZONE))
            for i, t in enumerate(self.trials)
            for c in t.captures
            if c.outline is not None
        ]

    @property
    def points(self) -> int:
        return sum(len(o.upper) + len(o.lower) for _, o in self.photographs)

    def beam(self, trial: BeamTrial, material: tisim.Material) -> tisim.Beam:
        return beam_scene(trial, material, density=self.density, fidelity=self.fidelity)

    def simulate(self, materials: Sequence[tisim.Material]) -> list[list[tisim.Result]]:
        """Every trial with every material."""
        results = tisim.simulate([self.beam(t, m) for t in self.trials for m in materials], workers=1)
        n = len(materials)
        return [[results[i * n + k] for i in range(len(self.trials))] for k in range(n)]

    def distances(self, results: Sequence[tisim.Result]) -> Array:
        """Distances of all points as measured, nothing taken out, (points,) [m]."""
        found = []
        for i, traced in self.photographs:
            for points, edge in zip((traced.upper, traced.lower), edges(results[i]), strict=True):
                found.append(project(points, edge).distance)
        return np.concatenate(found)


def signed(value: float) -> str:
    return f"{value:+.1f}" if np.isfinite(value) else "none"


def note(line: str) -> None:
    print(f"[{time.process_time() - BEGUN:5.0f} core-s] {line}", flush=True)
