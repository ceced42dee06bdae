"""Tables of the page: cells as people read them, each figure with its value in SI beside it."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from calibration.experiment.model import BeamTrial, Experiment
from calibration.pages import NOTHING, Cell, millimetres, seconds, significant
from calibration.parameters import parametrisation
from calibration.report._compare import Comparison
from calibration.report._words import interval, shear
from calibration.study.assessment import display_name
from calibration.study.calibration import Calibration

HEADINGS = (
    "law",
    "status",
    "G / kPa",
    "K/G",
    "shape constants",
    "reduced χ²",
    "Akaike difference",
    "rms / mm",
    "held out / mm",
    "candidates",
    "without answer",
    "core s / candidate",
    "core s / calibration",
)
HELD_OUT_HEADINGS = (
    "beam",
    "free length / mm",
    "law",
    "G from the others / kPa",
    "as traced / mm",
    "registered / mm",
    "χ² / points",
)


def law_rows(
    results: Sequence[Calibration], found: Comparison | None, experiment: Experiment
) -> list[list[Cell]]:
    """One row a law, in the order of HEADINGS."""
    return [_law_row(r, found, experiment) for r in results]


def _agreement(r: Calibration) -> Cell:
    if r.mean_dice is not None:
        return _figure(f"Dice {r.mean_dice:.4f}", r.mean_dice)
    return _figure(significant(r.reduced_chi2), r.reduced_chi2)


def _law_row(r: Calibration, found: Comparison | None, experiment: Experiment) -> list[Cell]:
    chosen = found is not None and r is found.chosen
    head = [
        Cell(text=r.label, mark="chosen" if chosen else ""),
        Cell(text=r.status, mark="good" if r.status == "converged" else "bad"),
    ]
    if r.parameters:
        difference = found.differences.get(r.label) if found else None
        middle = [
            Cell(text=shear(r), value=r.shear_modulus),
            _bulk(r),
            Cell(text=_shape(r)),
            _agreement(r),
            Cell(text=NOTHING) if difference is None else _figure(f"{difference:.1f}", difference),
            Cell(text=NOTHING) if r.rms is None else _figure(millimetres(r.rms), r.rms),
            Cell(text=_held_out(r, experiment)),
        ]
    else:
        middle = [Cell(text=NOTHING)] * 7
    return [
        *head,
        *middle,
        _figure(str(r.candidates), r.candidates),
        _figure(str(r.without_answer), r.without_answer),
        # a stopped search leaves its candidates, not its time
        *(
            [
                _figure(seconds(r.candidate_seconds), r.candidate_seconds),
                _figure(seconds(r.search_seconds + r.polish_seconds), r.search_seconds + r.polish_seconds),
            ]
            if r.candidates and r.search_seconds
            else [Cell(text=NOTHING)] * 2
        ),
    ]


def held_out_rows(results: Sequence[Calibration], experiment: Experiment) -> list[list[Cell]]:
    """One row a beam and law, in the order of HELD_OUT_HEADINGS."""
    lengths = beam_lengths(experiment)
    trials = dict.fromkeys(h.trial for r in results for h in r.held_out)
    return [
        [
            Cell(text=trial),
            _figure(f"{lengths[trial] * 1e3:g}", lengths[trial]),
            Cell(text=r.label),
            _figure(significant(h.shear_modulus / 1e3, 4), h.shear_modulus),
            _figure(millimetres(h.rms_raw), h.rms_raw),
            _figure(millimetres(h.rms), h.rms),
            _figure(significant(h.reduced_chi2), h.reduced_chi2),
        ]
        for trial in trials
        for r in results
        for h in r.held_out
        if h.trial == trial
    ]


def beam_lengths(experiment: Experiment) -> dict[str, float]:
    """Free length of each beam [m], by trial."""
    return {t.id: t.free_length for t in experiment.trials if isinstance(t, BeamTrial)}


def _figure(text: str, value: float) -> Cell:
    return Cell(text=text, value=value if isfinite(value) else None)


def _bulk(r: Calibration) -> Cell:
    ratio = r.bulk_modulus / r.shear_modulus
    seen = next((e.seen for e in r.estimates if e.name == "bulk_ratio"), None)
    if seen is None:
        return _figure(f"{ratio:.0f}, no error bar", ratio)
    if seen not in ("not identified", "held"):
        flag = "" if seen == "identified" else f", {seen}"
        return _figure(significant(ratio) + flag, ratio)
    # fits of earlier versions do not say "held"; without beams the search held it then too
    held = seen == "held" or r.rms is None
    text = (
        f"held at its prior, {_prior(r):.0f}, not measured"
        if held
        else f"not identified; prior {_prior(r):.0f}"
    )
    return Cell(text=text, mark="unseen")


def _prior(r: Calibration) -> float:
    """Centre of the prior on K/G."""
    known = next(c for c in parametrisation(r.law).coordinates if c.name == "bulk_ratio")
    return known.value(known.prior[0]) if known.prior else float("nan")


def _shape(r: Calibration) -> str:
    shape = [e for e in r.estimates if e.name not in ("shear_modulus", "bulk_ratio")]
    if shape:
        return "; ".join(f"{display_name(e.name)} {interval(e)}" for e in shape)
    return "none" if r.estimates or len(r.u) < 3 else "no error bars"


def _held_out(r: Calibration, experiment: Experiment) -> str:
    lengths = beam_lengths(experiment)
    parts = [f"{lengths[h.trial] * 1e3:g} mm: {millimetres(h.rms)}" for h in r.held_out]
    return "; ".join(parts) or NOTHING
