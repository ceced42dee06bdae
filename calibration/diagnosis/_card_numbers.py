"""The numbers on an extended card: moduli with their uncertainty, covariances in file units, ranges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars.effects import BarEffect
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.fitting import Fit
from calibration.diagnosis.verdict import Diagnosis
from calibration.experiment.model import BeamTrial, CouponTrial, Experiment, PokeTrial, Trial
from calibration.pokes import block_names

Array = NDArray[np.float64]

# what a diagnosis is of, by the unit of its residuals
_KINDS: dict[str, type[Trial]] = {"mm": BeamTrial, "kPa": CouponTrial, "N": PokeTrial}


@dataclass(frozen=True, eq=False, kw_only=True)
class Modulus:
    """A material's shear modulus [Pa] and its relative sd; weights (n,) of the fit's coordinates u in its
    logarithm."""

    value: float
    relative_sd: float
    weights: Array


def chosen_fit(diagnosis: Diagnosis) -> Fit:
    """The fit that cards are of: that with the named causes, else the baseline's."""
    chosen = diagnosis.chosen
    return diagnosis.finding.baseline if chosen is None else chosen.fit


def moduli(diagnosis: Diagnosis, experiment: Experiment) -> dict[str, Modulus]:
    """Of each material that was diagnosed. Models begin u with ln G of each specimen, in the order of the
    trials; ValueError where these do not give the moduli that the diagnosis tells."""
    fit = chosen_fit(diagnosis)
    n = len(fit.state.u)
    covariance = fit.covariance()[:n, :n]
    owners: dict[str, str] = {}
    for t in _used(diagnosis, experiment):
        owners.setdefault(t.specimen or t.material, t.material)
    found = {}
    for name, value in (diagnosis.extended or diagnosis.baseline).shear_modulus_Pa.items():
        weights = np.zeros(n)
        mine = [k for k, owner in enumerate(owners.values()) if owner == name]
        if not mine or len(owners) > n:
            raise ValueError(f"material {name}: no coordinate of the diagnosis is its modulus")
        weights[mine] = 1.0 / len(mine)
        if not np.isclose(np.exp(weights @ fit.state.u), value, rtol=1e-6):
            raise ValueError(f"material {name}: its modulus is not that of the diagnosis' coordinates")
        sd = float(np.sqrt(weights @ covariance @ weights))
        found[name] = Modulus(value=float(value), relative_sd=sd, weights=weights)
    return found


def file_covariance(diagnosis: Diagnosis) -> tuple[Array, list[str]]:
    """Covariance of the named effects' amplitudes in file units, (c, c), and what each is."""
    fit = chosen_fit(diagnosis)
    units = np.array([diagnosis.effects[c.effect].per_unit for c in fit.candidates])
    n = len(fit.state.u)
    names = [f"{c.label}: {diagnosis.effects[c.effect].parameter}" for c in fit.candidates]
    return fit.covariance()[n:, n:] * np.outer(units, units), names


def correlations(index: int, modulus: Modulus, diagnosis: Diagnosis) -> dict[str, float]:
    """Of an effect's amplitude with the material's shear modulus and with the other named effects."""
    fit = chosen_fit(diagnosis)
    n = len(fit.state.u)
    row = fit.covariance()[n + index]
    sds = np.sqrt(np.diag(fit.covariance())[n:])
    found = {"shear_modulus": _part(row[:n] @ modulus.weights, sds[index] * modulus.relative_sd)}
    for k, name in enumerate(file_covariance(diagnosis)[1]):
        if k != index:
            found[name] = _part(row[n + k], sds[index] * sds[k])
    return found


def valid_range(candidate: Candidate, diagnosis: Diagnosis, experiment: Experiment) -> dict[str, list[float]]:
    """Between what the effect was measured: lengths and times of beams, stretches, depths."""
    values: dict[str, list[float]] = {}
    for t in _used(diagnosis, experiment):
        if not reaches(candidate, t):
            continue
        if isinstance(t, BeamTrial):
            values.setdefault("free_length_mm", []).append(1e3 * t.free_length)
            values.setdefault("time_s", []).extend(c.time for c in t.captures if c.outline is not None)
            values["time_s"].extend(float(m.time[-1]) for m in t.markers if _let_go(diagnosis))
        elif isinstance(t, CouponTrial):
            values.setdefault("stretch", []).extend(t.stretch)
        else:
            values.setdefault("depth_mm", []).extend(1e3 * t.record.depth)
    return {name: [rounded(min(v)), rounded(max(v))] for name, v in values.items()}


def gain(diagnosis: Diagnosis) -> dict[str, float | str | None] | None:
    """What the extension buys on held-out data, as `diagnosis.json` has it."""
    found = diagnosis.to_json()["gain"]
    if found is None:
        return None
    return {k: v if v is None or isinstance(v, str) else rounded(v) for k, v in found.items()}


def rounded(x: float) -> float:
    """To six digits, as cards hold numbers."""
    return float(f"{x:.6g}")


def _part(covariance: float, sds: float) -> float:
    return rounded(covariance / sds) if sds > 0.0 else 0.0


def _used(diagnosis: Diagnosis, experiment: Experiment) -> Sequence[Trial]:
    kind = _KINDS[diagnosis.unit[0]]
    trials = [t for t in experiment.trials if isinstance(t, kind)]
    if _let_go(diagnosis):
        return [t for t in trials if isinstance(t, BeamTrial) and t.markers]
    return [t for t in trials if not isinstance(t, BeamTrial) or any(c.outline for c in t.captures)]


def _let_go(diagnosis: Diagnosis) -> bool:
    """Whether bars with markers were diagnosed, and not traced beams."""
    return any(isinstance(e, BarEffect) for e in diagnosis.effects.values())


def reaches(candidate: Candidate, trial: Trial) -> bool:
    """Whether an effect is in a trial: in all, or where its material, specimen, block or id is named."""
    blocks = block_names(trial) if isinstance(trial, PokeTrial) else ()
    return candidate.at in ("all", trial.material, trial.specimen, trial.id, *blocks)
