"""The lab does what a diagnosis advised: a direct measurement, by scales, callipers, a level and the like.

What experiment.yaml has a key with a standard deviation for is entered there. Of what it has none for the
lab knows whether it is there or not, by three of the gauge's standard deviations, and takes causes that are
refuted by that out of the catalogue.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml
from _blind_cases import TIMES, Case, true_beam
from _blind_effects import DEGREE

Names = tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Gauge:
    """sds: standard deviation [SI] with which it reads an amplitude; enters: the effects whose readings the
    experiment's file holds."""

    sds: dict[str, float] = field(default_factory=dict)
    enters: Names = ()


GAUGES: dict[str, Gauge] = {
    "weigh": Gauge(sds={"added-mass": 2e-5}, enters=("density",)),
    "callipers": Gauge(sds={"taper": 0.03, "grip-squeeze": 5e-3}, enters=("radius",)),
    "level": Gauge(
        sds={"clamp-tilt": 0.1 * DEGREE, "gravity-tilt": 0.1 * DEGREE, "camera-roll": 0.1 * DEGREE}
    ),
    "gauge-block": Gauge(sds={"clamp-gap": 5e-5, "image-scale": 1e-3}, enters=("free-length",)),
    "metal-bar": Gauge(sds={"grip-length": 1e-4, "clamp-compliance": 0.2}),
    "lens": Gauge(sds={"lens-distortion": 0.2, "image-scale": 1e-3}),
    "cut": Gauge(sds={"void": 0.03, "skin": 0.05}),
}
DENSITY_SD, RADIUS_SD, LENGTH_SD = 2.0, 2e-5, 5e-5  # [kg/m3], [m], [m]
PRESENT = 3.0


def measure(case: Case, name: str, alternatives: Iterable[Names], folder: Path) -> tuple[Names, Names]:
    """Read the gauge; enter in the experiment in `folder` what it has keys for. Returns the effects that were
    entered, and the ones that readings refute among `alternatives`, sets of effects: those that stand in no
    set with which the readings agree, and what was read to be absent."""
    gauge = GAUGES[name]
    rng = np.random.default_rng([case.seed, case.index, 4, list(GAUGES).index(name)])
    _enter(case, gauge.enters, folder, rng)
    true = {h.effect: abs(h.amplitude) for h in case.hidden}
    there = {
        effect: abs(true.get(effect, 0.0) + sd * rng.standard_normal()) > PRESENT * sd
        for effect, sd in gauge.sds.items()
    }
    return gauge.enters, refuted(there, alternatives)


def refuted(there: dict[str, bool], alternatives: Iterable[Names]) -> Names:
    """there: whether an effect was seen by the gauge, by name."""
    sets = [set(names) for names in alternatives]
    standing = [s for s in sets if all((effect in s) == seen for effect, seen in there.items())]
    kept = set().union(*standing)
    fallen = set().union(*sets) - kept
    absent = {effect for effect, seen in there.items() if not seen}
    present = {effect for effect, seen in there.items() if seen}
    return tuple(sorted((fallen | absent) - present))


def _enter(case: Case, effects: Names, folder: Path, rng: np.random.Generator) -> None:
    path = folder / "experiment.yaml"
    experiment = yaml.safe_load(path.read_text(encoding="utf-8"))
    if "density" in effects:
        for material, entry in experiment["materials"].items():
            true = next(t.density for t in case.trials if t.material == material)
            entry["density_kg_m3"] = round(float(true + DENSITY_SD * rng.standard_normal()), 1)
            entry["density_sd_kg_m3"] = DENSITY_SD
    radii: dict[str, float] = {}  # of a specimen, measured once
    for k, (trial, entry) in enumerate(zip(case.trials, experiment["trials"], strict=True)):
        beam = true_beam(case, k, len(TIMES) - 1)
        if "radius" in effects:
            if trial.specimen not in radii:
                radii[trial.specimen] = beam.radius + RADIUS_SD * float(rng.standard_normal())
            entry["section"]["circle"] = {
                "radius_mm": round(1e3 * radii[trial.specimen], 4),
                "radius_sd_mm": 1e3 * RADIUS_SD,
            }
        if "free-length" in effects:
            read = beam.length + LENGTH_SD * float(rng.standard_normal())
            entry["free_length_mm"] = round(1e3 * read, 4)
            entry["free_length_sd_mm"] = 1e3 * LENGTH_SD
        assert entry["id"] == trial.id
    path.write_text(yaml.safe_dump(experiment, sort_keys=False), encoding="utf-8")
