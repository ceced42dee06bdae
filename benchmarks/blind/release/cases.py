"""Experiment folders of cantilever release tests: one trial for each hung mass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.release.model import (
    DENSITY,
    GRAVITY,
    HEIGHT,
    LENGTH,
    MARKERS,
    WIDTH,
    Truth,
    displaced,
)

Array = NDArray[np.float64]
MATERIAL = "S0"


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """Unknown quantities of a run.

    Attributes
    ----------
    onset : time of the release [s].
    start : deflection at the release over the static one.
    angle : rotation of the camera [rad].
    """

    onset: float
    start: float
    angle: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """Times [s] of all records, true positions of the markers [mm], and the runs."""

    time: Array
    places: dict[str, Array]
    runs: tuple[Run, ...]

    def seen(self, truth: Truth, hung: float, run: Run) -> dict[str, Array]:
        """Displacements (t, 2) [mm] of each marker, without noise."""
        since = self.time - run.onset
        return displaced(truth, hung, since, self.places, start=run.start, angle=run.angle)


def markers(rng: np.random.Generator) -> dict[str, Array]:
    """True positions [mm], with deviations of 0.5 mm (standard deviation)."""
    return {name: np.array(at) + 0.5 * rng.standard_normal(3) for name, at in MARKERS.items()}


def run_of(rng: np.random.Generator, rate: float) -> Run:
    """Run released 20 ms after the record's start, plus up to one frame; camera rotated by up to 1 degree."""
    return Run(
        onset=0.02 + float(rng.uniform(0.0, 1.0 / rate)),
        start=float(rng.uniform(0.0, 0.1)),
        angle=float(np.radians(rng.uniform(-1.0, 1.0))),
    )


def noise_of(rng: np.random.Generator, time: Array) -> Array:
    """Noise of a run in standard deviations, shape (markers, t, 2)."""
    return rng.standard_normal((len(MARKERS), len(time), 2))


def write_bars(
    folder: Path,
    truth: Truth,
    *,
    hung: Sequence[float] = (0.0, 0.01),
    seconds: float = 1.6,
    rate: float = 200.0,
    sd_mm: float = 0.02,
    seed: int = 0,
    **changed: object,
) -> Path:
    """Write an experiment with one trial for each hung mass [kg]; `changed` holds keys of all trials."""
    rng = np.random.default_rng(seed)
    time, places = np.arange(int(seconds * rate)) / rate, markers(rng)
    runs, noise = zip(*((run_of(rng, rate), noise_of(rng, time)) for _ in hung), strict=True)
    made = Setup(time=time, places=places, runs=runs)
    return write_runs(folder, truth, made, noise, hung=hung, sd_mm=sd_mm, **changed)


def write_runs(
    folder: Path,
    truth: Truth,
    made: Setup,
    noise: Sequence[Array],
    *,
    hung: Sequence[float],
    sd_mm: float,
    **changed: object,
) -> Path:
    """Write an experiment from given runs; `noise` holds one array of `noise_of` per run."""
    folder.mkdir(parents=True, exist_ok=True)
    trials: list[dict[str, Any]] = []
    for k, (mass, run) in enumerate(zip(hung, made.runs, strict=True)):
        rows = ["marker,time_s,ux_mm,uy_mm,uz_mm"]
        for (name, u), drawn in zip(made.seen(truth, mass, run).items(), noise[k], strict=True):
            noisy = u + sd_mm * drawn
            both = zip(made.time.tolist(), noisy.tolist(), strict=True)
            rows += [f"{name},{t!r},{x!r},0.0,{z!r}" for t, (x, z) in both]
        (folder / f"run-{k}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        trials.append(
            {
                "id": f"run-{k}",
                "kind": "beam",
                "material": MATERIAL,
                "section": {"rectangle": {"width_mm": 1e3 * WIDTH, "height_mm": 1e3 * HEIGHT}},
                "free_length_mm": 1e3 * LENGTH,
                "free_length_sd_mm": 0.2,
                "grip_length_mm": 10.0,
                "supports": "clamped-free",
                "gravity_m_s2": [0.0, 0.0, -GRAVITY],
                "tip_force_N": [0.0, 0.0, -mass * GRAVITY],
                "markers": f"run-{k}.csv",
                "marker_sd_mm": sd_mm,
                "marker_positions_mm": {name: list(at) for name, at in MARKERS.items()},
                **changed,
            }
        )
    content = {
        "format": 1,
        "name": "made",
        "materials": {MATERIAL: {"density_kg_m3": DENSITY, "density_sd_kg_m3": 0.0}},
        "trials": trials,
    }
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    return folder
