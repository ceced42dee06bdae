"""Result of a calibration: a material's parameters in one law, with error bars, and its history."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

from calibration.inference import Estimate
from calibration.measurements.outlines.dice import SCALE
from calibration.parameters import (
    Parametrisation,
    ProtocolWindow,
    held_part,
    parametrisation,
    part_coordinates,
)
from calibration.study.assessment import misfit_lacking, nuisances_lacking, sentence
from tisim import Material
from tisim.parts import Part, decode

Status = Literal["converged", "lack of fit", "not converged", "no equilibrium", "stopped"]


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """One trial predicted from all others.

    Attributes
    ----------
    trial : str
    shear_modulus : float
        Shear modulus from the other trials [Pa].
    rms_raw, rms : float
        rms distance of its points before and after its photographs' registration is taken out [m].
    reduced_chi2 : float
        Chi-square over points, under the trial's whole covariance.
    """

    trial: str
    shear_modulus: float
    rms_raw: float
    rms: float
    reduced_chi2: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Calibration:
    """A law fitted to all measurements of one material. SI units.

    Attributes
    ----------
    material, law, label : str
        The label is what tables print ("ogden-2" for two terms).
    status : str
        "converged" (search and polish, and chance explains what is left); "lack of fit" (they converged, and
        the data ask for something that the law lacks: `lacking`, `message`); "not converged" (`message` says
        what); "no equilibrium" (the law has no answer for these trials anywhere); "stopped" (best so far).
    message : str
        One sentence on the status, empty where it is "converged".
    lacking : tuple of str
        Phrases of `calibration.study.assessment`, for people.
    unsettled : tuple of str
        Constants at a bound of the search, whose value is the bound's and not the data's.
    density : float, optional
        Density as the lab states it [kg/m3].
    u : tuple of float
        The law's search coordinates.
    held_coordinates : int
        Number of these that the fit held (K/G where the data do not show it).
    parameters : mapping
        Parameters as `tisim.Material` takes them.
    shear_modulus, shear_modulus_sd, bulk_modulus : float
        Small-strain moduli [Pa], and standard deviation of the first.
    estimates, blind : tuple
        See `calibration.inference.Identification`; empty where there was no polish.
    covariance : tuple of tuple of float
        Covariance of u: 1.96 standard deviations of it are the 95 % intervals of linear theory; empty where
        there was no polish.
    chi2 : float
        Chi-square of `points` measurements under the stated noise, without that of the prior. With the
        objective "dice" the sum of (1 - Dice) / SCALE^2 over `points` photographs, and no measure of
        likelihood.
    points : int
    reduced_chi2 : float
        Chi-square over `freedom`.
    noise_freedom : float, optional
        Degrees of freedom of a noise estimated from the scatter of the records; None if it is stated.
    rms : float, optional
        Root mean square of the outlines' distances, registered [m].
    nuisances : mapping
        Value of each nuisance in its standard deviations.
    held_out : tuple of HeldOut
    held_out_note, note : str
        Further remarks for the reader (a mesh error that could not be corrected).
    candidates, generations, without_answer : int
        Counts of CMA-ES; the last is that of candidates without equilibrium.
    search_reason : str
        Reason why the search ended.
    search_seconds, polish_seconds, wall_seconds : float
        Core time of search and polish, and elapsed time of both [s].
    objective : str
        "likelihood" or "dice".
    parts : tuple of str
        Parts of the material beside the law ("prony:2", "mullins"); moduli are then long-time ones, those
        of the first loading.
    asked : tuple of str
        These as they were requested, where the data chose among several ("prony"); else empty.
    held : mapping
        Parts of the material that the fit did not search, by the field of `tisim.Material`, as a card states
        them.
    protocol : mapping
        `calibration.parameters.ProtocolWindow` of the tests that the parts were fitted to.
    """

    material: str
    law: str
    label: str
    status: Status
    message: str
    density: float | None
    u: tuple[float, ...] = ()
    held_coordinates: int = 0
    parameters: Mapping[str, float | tuple[float, ...]] = field(default_factory=dict)
    shear_modulus: float = float("nan")
    shear_modulus_sd: float = float("nan")
    bulk_modulus: float = float("nan")
    estimates: tuple[Estimate, ...] = ()
    blind: tuple[dict[str, float], ...] = ()
    covariance: tuple[tuple[float, ...], ...] = ()
    chi2: float = float("nan")
    points: int = 0
    reduced_chi2: float = float("nan")
    noise_freedom: float | None = None
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
    lacking: tuple[str, ...] = ()
    unsettled: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    asked: tuple[str, ...] = ()
    protocol: Mapping[str, float] = field(default_factory=dict)
    held: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def reason(self) -> str:
        """The phrases of `lacking` for a lack of fit, else `message`."""
        return "; ".join(self.lacking) if self.status == "lack of fit" else self.message

    @property
    def mean_dice(self) -> float | None:
        """Mean Dice of the photographs where that was the objective."""
        return 1.0 - self.chi2 * SCALE**2 / self.points if self.objective == "dice" and self.points else None

    @property
    def terms(self) -> int:
        """Terms of a series law; 1 for any other."""
        own = self.label.partition("+")[0]
        return 1 if own == self.law else int(own.removeprefix(f"{self.law}-"))

    @property
    def parametrisation(self) -> Parametrisation:
        """The law in search coordinates, with its parts."""
        law = parametrisation(self.law, terms=self.terms)
        if not self.parts and not self.held:
            return law
        window = ProtocolWindow(
            first=self.protocol["first"], last=self.protocol["last"], peaks=int(self.protocol["peaks"])
        )
        held = [held_part(name, decode(name, entry), window) for name, entry in self.held.items()]
        return law.with_parts([*(part_coordinates(spec, window) for spec in self.parts), *held])

    @property
    def material_parts(self) -> dict[str, Part]:
        """Parts of the material beside its law, by the field of `tisim.Material`."""
        if not self.u or not (self.parts or self.held):
            return {}
        law = self.parametrisation
        values = law.values(self.u)
        return {p.field: p.assembled(values) for p in law.parts}

    def simulated(self, *, density: float = 1000.0) -> Material:
        """The material as `tisim` takes it; density [kg/m3] where the lab states none."""
        return Material(
            law=self.law,
            parameters=dict(self.parameters),
            density=self.density or density,
            **self.material_parts,  # type: ignore[arg-type]
        )

    @property
    def candidate_seconds(self) -> float:
        """Core time of one candidate of the search, all its trials [s]."""
        return self.search_seconds / max(1, self.candidates)

    @property
    def constants(self) -> int:
        """Number of constants that were fitted."""
        return len(self.u) - self.held_coordinates

    @property
    def freedom(self) -> int:
        """Degrees of freedom: points minus fitted constants, at least 1."""
        return max(1, self.points - self.constants)

    def to_json(self) -> dict[str, Any]:
        """Plain values, NaN as None."""
        plain: dict[str, Any] = _plain(asdict(self))
        return plain

    @staticmethod
    def from_json(data: Mapping[str, Any]) -> Calibration:
        """The inverse of `to_json`. A result of an earlier version is assessed now."""
        known = dict(data)
        for name in ("lacking", "unsettled", "parts", "asked"):
            known[name] = tuple(known.get(name, ()))
        known["estimates"] = tuple(Estimate(**_nan(e)) for e in known["estimates"])
        known["held_out"] = tuple(HeldOut(**_nan(h)) for h in known["held_out"])
        known["blind"] = tuple(dict(b) for b in known["blind"])
        known["u"] = tuple(known["u"])
        known["covariance"] = tuple(tuple(row) for row in known.get("covariance", ()))
        known["parameters"] = {
            k: tuple(v) if isinstance(v, list) else v for k, v in known["parameters"].items()
        }
        for name in ("shear_modulus", "shear_modulus_sd", "bulk_modulus", "chi2", "reduced_chi2"):
            known[name] = float("nan") if known[name] is None else known[name]
        found = Calibration(**known)
        return found if "lacking" in data else found.assessed()

    def assessed(self, lacking: Sequence[str] = ()) -> Calibration:
        """The same with its lack of fit stated: the phrases given, and those on its misfit and nuisances."""
        whole = tuple(lacking)
        if self.objective == "likelihood" and self.parameters:
            whole += misfit_lacking(self.reduced_chi2, self.freedom, self.noise_freedom)
            whole += tuple(nuisances_lacking(self.nuisances))
        if not whole:
            return self
        if self.status != "converged":
            return replace(self, lacking=whole)
        return replace(self, lacking=whole, status="lack of fit", message=sentence(self.label, whole))

    def __repr__(self) -> str:
        name = f"Calibration({self.material}, {self.label}: {self.status}"
        if not self.parameters:
            return f"{name}; {self.message})"
        sd = (
            f" +- {self.shear_modulus_sd / 1e3:.2g}" if self.shear_modulus_sd == self.shear_modulus_sd else ""
        )
        more = f"; {self.message}" if self.message else ""
        return f"{name}, G {self.shear_modulus / 1e3:.4g}{sd} kPa{more})"


def shared_notes(results: Iterable[Calibration]) -> dict[str, list[Calibration]]:
    """The fits of each note, since laws that are fitted to the same tests share most notes."""
    found: dict[str, list[Calibration]] = {}
    for r in results:
        if r.note:
            found.setdefault(r.note, []).append(r)
    return found


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
