"""Comparison of the laws of one material (Akaike), and the nuisances that the chosen fit moved far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees

from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements.outlines._admitted import admitted
from calibration.measurements.outlines._nuisances import CORNER_SD, SHARED
from calibration.measurements.outlines._photographs import names_of
from calibration.study.assessment import largest_by_chance
from calibration.study.calibration import Calibration
from calibration.study.cards import best, misfit_scale, usable

# Burnham and Anderson, Model Selection and Multimodel Inference (2002), 2.6: a difference below 2 leaves a
# model substantial support, one above 10 essentially none.
ALIKE, REFUTED = 2.0, 10.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """The laws of one material.

    chosen: the law with the smallest chi-square / scale + 2 n among finished fits, else the best so far of
    stopped ones. differences: by label, (chi2 - chi2 of the chosen) / scale + 2 (n - n of the chosen), of
    finished fits only. scale: `calibration.study.cards.misfit_scale`. passed_over: labels of laws with a
    constant at a bound of the search, where the chosen one has none.
    """

    chosen: Calibration
    differences: Mapping[str, float]
    scale: float
    passed_over: tuple[str, ...] = ()

    @property
    def compared(self) -> Mapping[str, float]:
        """Differences of the laws that the chosen one was chosen among."""
        return {n: d for n, d in self.differences.items() if n not in self.passed_over}

    @property
    def alike(self) -> tuple[str, ...]:
        """Labels that cannot be told from the chosen law, which is one of them."""
        return tuple(n for n, d in self.compared.items() if d < ALIKE)

    @property
    def refuted(self) -> tuple[str, ...]:
        return tuple(n for n, d in self.compared.items() if d > REFUTED)

    @property
    def better(self) -> Mapping[str, float]:
        """Differences of laws that were passed over although they fit better."""
        return {n: d for n, d in self.differences.items() if n in self.passed_over and d < -ALIKE}

    @property
    def misses(self) -> bool:
        """True if the chosen law's chi-square is above what noise makes of it; an overlap has no noise."""
        fit = self.chosen
        largest = largest_by_chance(fit.freedom, fit.noise_freedom)
        return fit.mean_dice is None and fit.reduced_chi2 > largest


def compare(results: Sequence[Calibration]) -> Comparison | None:
    """Compare the laws of one material; None where no fit has parameters."""
    chosen = best(results)
    if chosen is None:
        stopped = [r for r in results if r.parameters]
        if not stopped:
            return None
        chosen = min(stopped, key=_akaike)
    scale = misfit_scale(results)
    differences = {
        r.label: (r.chi2 - chosen.chi2) / scale + 2.0 * (r.constants - chosen.constants)
        for r in results
        if usable(r) and r.mean_dice is None  # an overlap is no likelihood
    }
    passed = tuple(r.label for r in results if usable(r) and r.unsettled and not chosen.unsettled)
    return Comparison(chosen=chosen, differences=differences, scale=scale, passed_over=passed)


def _akaike(result: Calibration) -> float:
    return result.chi2 + 2.0 * result.constants


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
    """One sd of each nuisance that `calibration.measurements.outlines` names, in units for people."""
    beams = [t for t in experiment.trials if isinstance(t, BeamTrial) and t.material == material]
    sizes = {
        n.name: (n.sd, "kg/m³") if n.quantity == "density" else (n.sd * 1e3, "mm")
        for n in admitted(beams, experiment.materials[material])
    }
    for trial in beams:
        for k in range(1, 9):
            sizes[f"clamp corner {k} of {trial.id}"] = (CORNER_SD * 1e3, "mm")
        outlines = [c.outline for c in trial.captures if c.outline is not None]
        for name, outline in zip(names_of(trial), outlines, strict=True):
            for own, error in ((f"of {name}", outline.registration), (SHARED, outline.shared)):
                sizes[f"shift x {own}"] = sizes[f"shift z {own}"] = (error.shift * 1e3, "mm")
                sizes[f"roll {own}"] = (degrees(error.roll), "deg")
                sizes[f"scale {own}"] = (error.scale * 100.0, "%")
    return sizes
