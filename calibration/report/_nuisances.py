"""Nuisances that a fit moved far: where a photograph, a radius or a length is not what the lab believes."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

from calibration.experiment.model import BeamTrial, Experiment
from calibration.study.calibration import Calibration
from tisim import Circle

FAR = 2.0


@dataclass(frozen=True, kw_only=True)
class Moved:
    """name; by how many of its standard deviations; amount: the same with a unit, "" where it has none."""

    name: str
    sds: float
    amount: str


def far_nuisances(result: Calibration, experiment: Experiment) -> list[Moved]:
    """Nuisances beyond two standard deviations, the farthest first."""
    sizes = _sizes(result.material, experiment)
    found = []
    for name, sds in result.nuisances.items():
        if abs(sds) > FAR:
            sd, unit = sizes.get(name, (None, ""))
            amount = "" if sd is None else f"{sds * sd:+.3g} {unit}"
            found.append(Moved(name=name, sds=sds, amount=amount))
    return sorted(found, key=lambda m: -abs(m.sds))


def _sizes(material: str, experiment: Experiment) -> dict[str, tuple[float, str]]:
    """One sd of each nuisance that `calibration.outlines` names, in units for people."""
    belief = experiment.materials[material]
    sizes = {f"density of {material}": (belief.density_sd, "kg/m³")}
    for trial in experiment.trials:
        if not isinstance(trial, BeamTrial) or trial.material != material:
            continue
        sizes[f"free length of {trial.id}"] = (trial.free_length_sd * 1e3, "mm")
        labels = ("radius",) if isinstance(trial.section, Circle) else ("width", "height")
        for label, sd in zip(labels, trial.section_sd, strict=False):
            sizes.setdefault(f"{label} of {trial.specimen or trial.id}", (sd * 1e3, "mm"))
        for capture in trial.captures:
            if capture.outline is None:
                continue
            where = f"of {trial.id} at {capture.time:g} s"
            registration = capture.outline.registration
            sizes[f"shift x {where}"] = sizes[f"shift z {where}"] = (registration.shift * 1e3, "mm")
            sizes[f"roll {where}"] = (degrees(registration.roll), "deg")
            sizes[f"scale {where}"] = (registration.scale * 100.0, "%")
    return sizes
