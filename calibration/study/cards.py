"""Material cards: the form that `factory.build` reads (`datasets/materials/`), one a mixture, all laws.

A law that has no usable fit is filled in from the best law's moduli, and the card's provenance says so.
Parts that were fitted beside the best law (`tisim.parts`) stand under the keys `viscosity`, `softening` and
`fibres`; moduli are then long-time ones. Constants of a law that was fitted without them, or beside others,
are not taken: they are those of another material.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from calibration._files import write_whole
from calibration.errors import InputError
from calibration.experiment import Experiment
from calibration.inference import WIDTH
from calibration.measurements._kinds import compared
from calibration.parameters import parametrisation, part_entry
from calibration.study.calibration import Calibration
from tisim import laws

# How a mixture is given to a surrogate: 0.8 for no softener, 0.4 for half, 0 for all (the paper's labels).
_STIFFEST, _PER_RATIO = 0.8, 0.8


def usable(result: Calibration) -> bool:
    """True if a calibration's parameters may go into a card: converged, or polished to error bars."""
    if result.status == "not converged":
        return bool(result.estimates)
    return result.status in ("converged", "lack of fit")


def best(results: Sequence[Calibration]) -> Calibration | None:
    """The usable fit with the smallest chi-square over `misfit_scale`, twice its parameters added (Akaike).

    Fits with a constant at a bound of the search are chosen only where all are.
    """
    found = _chosen_among(results)
    scale = misfit_scale(results)
    return _least(found, scale) if found else None


def _least(found: Sequence[Calibration], scale: float) -> Calibration:
    """The fit with the lowest Akaike value."""
    return min(found, key=lambda r: r.chi2 / scale + 2.0 * r.constants)


def misfit_scale(results: Sequence[Calibration]) -> float:
    """Divisor of chi-square for the comparison of laws: the least reduced one, at least 1.

    So a law that misses the data by more than the noise does not beat others by parts of its own error (QAIC:
    K. P. Burnham and D. R. Anderson, Model Selection and Multimodel Inference, 2002, 2.5).
    """
    return max([1.0, *([min(r.reduced_chi2 for r in found)] if (found := _chosen_among(results)) else [])])


def _chosen_among(results: Sequence[Calibration]) -> list[Calibration]:
    found = [r for r in results if usable(r)]
    return [r for r in found if not r.unsettled] or found


def card(results: Sequence[Calibration], experiment: Experiment) -> dict[str, Any]:
    """The card of one material from its calibrations; InputError where none is usable."""
    chosen = best(results)
    if chosen is None:
        raise InputError(f"material {results[0].material}: expected a converged fit of at least one law")
    belief = experiment.materials[chosen.material]
    by_law = _taken(results, chosen)
    parameters: dict[str, dict[str, Any]] = {}
    filled = []
    for name in laws.names():
        if name in by_law:
            parameters[name] = _plain(by_law[name].parameters)
        else:
            filled.append(name)
            parameters[name] = _plain(laws.get(name).from_moduli(chosen.shear_modulus, chosen.bulk_modulus))
    low, high = shear_interval(chosen)
    ratio = belief.softener_ratio
    return {
        "material": chosen.material,
        "mixture": f"softener ratio {ratio:g}" if ratio is not None else chosen.material,
        "derived": False,
        "provenance": _provenance(results, chosen, by_law, filled, experiment),
        "fitted_to": {
            **fitted_to(experiment, chosen.material, objective=chosen.objective),
            **({} if chosen.status == "converged" else {"status": chosen.status, "why": chosen.reason}),
        },
        "uncertainty": {
            "shear_modulus_low": low,
            "shear_modulus_high": high,
            "text": _certainty(chosen),
            **_covariance(chosen),
        },
        "density": float(belief.density if belief.density is not None else 1000.0),
        "law": chosen.law,
        "stiffness": float(max(0.0, _STIFFEST - _PER_RATIO * ratio)) if ratio is not None else 0.0,
        "laws": parameters,
        **_parts(chosen),
    }


def _taken(results: Sequence[Calibration], chosen: Calibration) -> dict[str, Calibration]:
    """The fit of each law that a card can have beside the chosen one: the chosen one of its own law, of
    another law the best with the same parts."""
    by_law: dict[str, list[Calibration]] = {chosen.law: [chosen]}
    for r in results:
        if r.law != chosen.law and _settled(r, chosen) and _same_parts(r, chosen):
            by_law.setdefault(r.law, []).append(r)
    scale = misfit_scale(results)
    return {law: _least(found, scale) for law, found in by_law.items()}


def _settled(r: Calibration, chosen: Calibration) -> bool:
    return usable(r) and (not r.unsettled or r is chosen)


def _same_parts(r: Calibration, chosen: Calibration) -> bool:
    return (r.parts, r.held) == (chosen.parts, chosen.held)


def fitted_to(experiment: Experiment, material: str, *, objective: str = "likelihood") -> dict[str, Any]:
    """Data that a card was fitted to: name and sha256 of the experiment, and the kinds of measurement."""
    own = replace(experiment, trials=tuple(t for t in experiment.trials if t.material == material))
    kinds = [kind.name for kind, _ in compared(own) if objective in ("likelihood", *kind.objectives)]
    return {"experiment": experiment.name, "sha256": experiment.digest, "kinds": kinds}


def write_card(folder: Path, results: Sequence[Calibration], experiment: Experiment) -> Path:
    """Write MATERIAL.yaml into the folder, in one piece."""
    content = card(results, experiment)
    heading = "Moduli in Pa, density in kg/m3. Calibrated: see provenance."
    return save(folder / f"{content['material']}.yaml", content, heading)


def save(path: Path, content: Mapping[str, Any], heading: str) -> Path:
    """Write a YAML file under a line of comment, in one piece; its folder is made."""
    text = yaml.safe_dump(dict(content), sort_keys=False, allow_unicode=True, width=110)
    return write_whole(path, f"# {heading}\n{text}")


def _plain(parameters: Mapping[str, float | tuple[float, ...]]) -> dict[str, Any]:
    def rounded(x: float) -> float:
        return float(f"{x:.6g}")

    return {
        k: [rounded(x) for x in v] if isinstance(v, tuple) else rounded(float(v))
        for k, v in parameters.items()
    }


def _parts(chosen: Calibration) -> dict[str, dict[str, Any]]:
    """Parts of the material beside its law, by the card's keys: kinds of `tisim.parts`, parameters."""
    return {name: part_entry(part) for name, part in chosen.material_parts.items()}


def _covariance(chosen: Calibration) -> dict[str, Any]:
    """The fit's point and covariance in its search coordinates, under a key; empty without error bars."""
    if not chosen.covariance:
        return {}
    law = chosen.parametrisation
    window = law.parts[0].window if law.parts else None
    return {
        "fit": {
            "terms": chosen.terms,
            **({} if window is None else {"protocol": [window.first, window.last, window.peaks]}),
            "parts": list(chosen.parts),
            "coordinates": list(law.names),
            "values": [float(f"{x:.9g}") for x in chosen.u],
            "covariance": [[float(f"{c:.6g}") for c in row] for row in chosen.covariance],
        }
    }


def _provenance(
    results: Sequence[Calibration],
    chosen: Calibration,
    by_law: Mapping[str, Calibration],
    filled: Sequence[str],
    experiment: Experiment,
) -> str:
    lines = [
        f"Calibrated on experiment {experiment.name!r} (sha256 {experiment.digest[:16]}) by calibration.fit:"
        f" best law {chosen.label}, shear modulus {chosen.shear_modulus:.5g} Pa, {_agreement(chosen)}."
    ]
    states = [f"{r.label}: {r.status}{f' ({r.reason})' if r.reason else ''}" for r in results]
    lines.append("Fits: " + "; ".join(states) + ".")
    if chosen.lacking:
        lines.append(
            "Lack of fit: these parameters make up for something that the law lacks; python -m"
            " calibration.diagnose looks for it."
        )
    if chosen.parts:
        lines.append(
            f"Parts ({', '.join(chosen.parts)}) were fitted beside {chosen.law}; moduli are long-time ones."
        )
    if chosen.held:
        lines.append(f"Held beside {chosen.law}, as another card states them: {', '.join(chosen.held)}.")
    if chosen.note:
        lines.append(f"Note: {chosen.note}.")
    not_taken: dict[str, list[str]] = {}
    for r in results:
        if r.parameters and r is not by_law.get(r.law):
            not_taken.setdefault(_why_not(r, chosen), []).append(r.label)
    lines += [f"Fitted but not taken ({why}): {', '.join(names)}." for why, names in not_taken.items()]
    fitted = {r.law for r in results if r.parameters}
    for why, names in (
        ("Not fitted", [n for n in filled if n not in fitted]),
        ("No fit taken", [n for n in filled if n in fitted]),
    ):
        if names:
            lines.append(f"{why}, moduli taken from {chosen.label}: {', '.join(names)}.")
    if experiment.materials[chosen.material].density is None:
        lines.append("Density not stated by the lab: 1000 kg/m3 assumed.")
    return "\n".join(lines)


def _why_not(r: Calibration, chosen: Calibration) -> str:
    """Why a fit's constants are not on the card."""
    if not _settled(r, chosen):
        return "not converged, or a constant at a bound"
    if not _same_parts(r, chosen):
        return f"beside other parts than those of {chosen.label}"
    return "another fit of its law is better"


def _prior_interval(law: str) -> tuple[float, float]:
    """95 % interval of the prior on K/G."""
    bulk = next(c for c in parametrisation(law).coordinates if c.name == "bulk_ratio")
    if bulk.prior is None:
        return bulk.low, bulk.high
    centre, sd = bulk.prior
    return bulk.value(centre - WIDTH * sd), bulk.value(centre + WIDTH * sd)


def _agreement(chosen: Calibration) -> str:
    if chosen.mean_dice is not None:
        return f"fitted to overlaps, mean Dice {chosen.mean_dice:.4f} of {chosen.points} photographs"
    return f"reduced chi-square {chosen.reduced_chi2:.2f} over {chosen.points} points"


def shear_interval(chosen: Calibration) -> tuple[float | None, float | None]:
    """95 % interval of the shear modulus, relative to it; None if there is none or it is not identified."""
    found = next((e for e in chosen.estimates if e.name == "shear_modulus"), None)
    if found is None:  # of a law of several terms, or of a diagnosis, which has the sd alone
        half = _width(chosen) * chosen.shear_modulus_sd / chosen.shear_modulus
        return (-round(half, 5), round(half, 5)) if math.isfinite(half) else (None, None)
    if found.seen in ("not identified", "at a bound"):
        return None, None
    return round(found.low / found.value - 1.0, 5), round(found.high / found.value - 1.0, 5)


def _width(chosen: Calibration) -> float:
    """Half width of a 95 % interval in standard deviations, as the moduli have it.

    It is Student's where the scatter of a few specimens is in it.
    """
    widths = [
        0.5 * abs(math.log(e.high / e.low) if e.relative else e.high - e.low) / e.sd
        for e in chosen.estimates
        if e.unit == "Pa" and e.seen == "identified" and e.sd > 0.0
    ]
    return max([WIDTH, *widths])


def _certainty(chosen: Calibration) -> str:
    unseen = [e.name for e in chosen.estimates if e.seen not in ("identified", "held")]
    text = f"95 % interval of the shear modulus in {chosen.label}, nuisances and other constants free."
    if not chosen.estimates:
        return "No Gauss-Newton polish was made: the interval is not known."
    if unseen:
        text += f" Not identified by this data (prior, bound or weak): {', '.join(unseen)}."
    bulk = next((e for e in chosen.estimates if e.name == "bulk_ratio"), None)
    low, high = _prior_interval(chosen.law)
    if bulk is not None and bulk.seen == "held":
        text += (
            f" K/G was held at {bulk.value:.0f}, not measured: its prior's 95 % interval is {low:.0f} to"
            f" {high:.0f}."
        )
    if bulk is not None and bulk.seen == "not identified":
        text += f" K/G {bulk.value:.0f} is the prior's, 95 % interval {low:.0f} to {high:.0f}."
    return text
