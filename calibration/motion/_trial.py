"""What a marker objective takes from a trial, and what it says where the trial lacks it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.errors import InputError
from calibration.experiment.model import BeamTrial, Marker, MaterialBelief

SPREAD_OFF = 1e-3  # of two directions [rad], for a tip force to count as a hung mass


def hung_mass(trial: BeamTrial) -> float:
    """Mass whose weight is the trial's tip force [kg]; InputError where that does not pull along gravity."""
    force, gravity = np.asarray(trial.tip_force), np.asarray(trial.gravity)
    pull, g = float(np.linalg.norm(force)), float(np.linalg.norm(gravity))
    if pull == 0.0:
        return 0.0
    if g == 0.0 or float(np.linalg.norm(force / pull - gravity / g)) > SPREAD_OFF:
        raise InputError(
            f"experiment.yaml: trials.{trial.id}.tip_force_N: expected a force along gravity for a hung mass;"
            " give the mass that moves with the tip"
        )
    return pull / g


def density(trial: BeamTrial, belief: MaterialBelief) -> float:
    """Density [kg/m3]; InputError where the lab does not say."""
    if belief.density is None:
        raise InputError(
            f"experiment.yaml: materials.{belief.name}.density_kg_m3: expected, since its weight bends"
            f" {trial.id}"
        )
    return belief.density


def noise(trial: BeamTrial) -> float:
    """Standard deviation of a marker's displacement [m]; InputError where the lab does not say."""
    if trial.marker_sd is None or not trial.marker_sd > 0.0:
        raise InputError(
            f"experiment.yaml: trials.{trial.id}.marker_sd_mm: expected above 0 to weigh markers by"
        )
    return trial.marker_sd


def chosen(trial: BeamTrial, names: Sequence[str] | None) -> tuple[Marker, ...]:
    """Markers of these names (None: all); InputError where there is none."""
    known = {m.name: m for m in trial.markers}
    if not known:
        raise InputError(f"experiment.yaml: trials.{trial.id}.markers: expected markers, got none")
    for name in names or ():
        if name not in known:
            raise InputError(
                f"experiment.yaml: trials.{trial.id}.markers: expected {name} among"
                f" {', '.join(sorted(known))}"
            )
    return tuple(known.values()) if names is None else tuple(known[n] for n in names)
