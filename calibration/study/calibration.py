"""What a calibration returns: a material's parameters in one law, with error bars, and how it got there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from calibration.outlines.dice import SCALE
from calibration.search import Estimate

Status = Literal["converged", "not converged", "no equilibrium", "stopped"]


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """One trial predicted from all others: rms distance of its points [m] before and after its photographs'
    registration is taken out, and chi-square over points under the trial's whole covariance."""

    trial: str
    shear_modulus: float
    rms_raw: float
    rms: float
    reduced_chi2: float


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """A law fitted to all measurements of one material. SI units.

    status: "converged" (search and polish), "not converged" (message says what), "no equilibrium" (the law
        has no answer for these trials anywhere that was looked), "stopped" (by the user: the best so far).
    u: the law's search coordinates; parameters: as `tisim.Material` takes them.
    chi2: of `points` measurements under the stated noise, without the prior's share;
    reduced_chi2: over points minus coordinates. rms: of the outlines' distances, registered [m], or None.
    note: what else the reader must know (a mesh error that could not be corrected).
    estimates, blind: see `calibration.search.identify`; empty where there was no polish.
    objective: what was minimised, "likelihood" or "dice"; with "dice" chi2 is the sum of (1 - Dice) / SCALE^2
        over `points` photographs, and no measure of likelihood.
    candidates, without_answer: that CMA-ES asked for, and how many of them had no equilibrium.
    search_seconds, polish_seconds: core time; candidate_seconds: of one candidate, all its trials.
    """

    material: str
    law: str
    label: str
    status: Status
    message: str
    density: float | None
    u: tuple[float, ...] = ()
    parameters: Mapping[str, float | tuple[float, ...]] = field(default_factory=dict)
    shear_modulus: float = float("nan")
    shear_modulus_sd: float = float("nan")
    bulk_modulus: float = float("nan")
    estimates: tuple[Estimate, ...] = ()
    blind: tuple[dict[str, float], ...] = ()
    chi2: float = float("nan")
    points: int = 0
    reduced_chi2: float = float("nan")
    rms: float | None = None
    nuisances: Mapping[str, float] = field(default_factory=dict)
    held_out: tuple[HeldOut, ...] = ()
    held_out_note: str = ""
    note: str = ""
    candidates: int = 0
    generations: int = 0
    without_answer: int = 0
    search_reason: str = ""
    search_seconds: float = 0.0
    polish_seconds: float = 0.0
    wall_seconds: float = 0.0
    objective: str = "likelihood"

    @property
    def mean_dice(self) -> float | None:
        """Mean Dice of the photographs where that was the objective."""
        return 1.0 - self.chi2 * SCALE**2 / self.points if self.objective == "dice" and self.points else None

    @property
    def candidate_seconds(self) -> float:
        """Core time of one candidate of the search, all its trials [s]."""
        return self.search_seconds / max(1, self.candidates)

    def to_json(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        plain: dict[str, Any] = _plain(asdict(self))
        return plain

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> Calibration:
        """The inverse of `to_json`."""
        known = dict(data)
        known["estimates"] = tuple(Estimate(**_nan(e)) for e in known["estimates"])
        known["held_out"] = tuple(HeldOut(**_nan(h)) for h in known["held_out"])
        known["blind"] = tuple(dict(b) for b in known["blind"])
        known["u"] = tuple(known["u"])
        known["parameters"] = {
            k: tuple(v) if isinstance(v, list) else v for k, v in known["parameters"].items()
        }
        for name in ("shear_modulus", "shear_modulus_sd", "bulk_modulus", "chi2", "reduced_chi2"):
            known[name] = float("nan") if known[name] is None else known[name]
        return Calibration(**known)


def _nan(values: Mapping[str, Any]) -> dict[str, Any]:
    return {k: float("nan") if v is None else v for k, v in values.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, int):
        return value
    number = float(value)
    return number if abs(number) < float("inf") else None
