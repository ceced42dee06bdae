"""Tables of the page: each figure as people read it, with the value that `diagnosis.json` has beside it."""

from __future__ import annotations

import math
from typing import Any

from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.report._units import quantity_and_unit
from calibration.diagnosis.report._words import SUSPECT, chance, meaning, pattern, scope
from calibration.report import NOTHING, Cell, significant, with_sd

Rows = list[list[Cell]]

CAUSES = ("cause", "what it is", "where", "amplitude ± sd", "confidence", "belongs to", "which means")
ALTERNATIVES = ("set of causes", "what it is", "worse than the best by", "belongs to")
FITS = ("", "baseline", "extended", "change")
TESTS = ("test of what is left", "baseline", "best explanation")
INVISIBLE = ("effect", "what it is", "amplitude needed for 5 sd", "what to do instead")


def cause_rows(diagnosis: Diagnosis, told: dict[str, Any]) -> Rows:
    """One row a cause; several parameters of one stand in one cell each under the other."""
    rows = []
    for cause in told["causes"]:
        effect = diagnosis.effects[cause["effect"]]
        values = [(_amplitude(n, p["value"], p["sd"]), p["value"]) for n, p in cause["parameters"].items()]
        rows.append(
            [
                Cell(text=cause["effect"], mark="chosen"),
                Cell(text=effect.sentence),
                Cell(text=scope(cause["scope"])),
                Cell(text="; ".join(text for text, _ in values), value=values[0][1], mark="chosen"),
                Cell(text=_confidence(cause["confidence"]), value=cause["confidence"]),
                Cell(text=effect.belongs_to),
                Cell(text=meaning(effect)),
            ]
        )
    return rows


def _confidence(part: float) -> str:
    """In percent; a thousand replicates cannot say that it is certain."""
    return "> 99.9 %" if part > 0.999 else f"{100.0 * part:.3g} %"


def alternative_rows(diagnosis: Diagnosis) -> Rows:
    """The sets of effects that cannot be told apart, the chosen one first."""
    finding = diagnosis.finding
    best = finding.explanations[0].score if finding.explanations else 0.0
    rows = []
    for k, names in enumerate(finding.equivalent):
        score = min(e.score for e in finding.explanations if e.names == names)
        parts = [diagnosis.effects[n] for n in names]
        rows.append(
            [
                Cell(text=" + ".join(names), mark="chosen" if k == 0 else ""),
                Cell(text="; and ".join(p.sentence for p in parts)),
                Cell(
                    text="the best" if k == 0 else f"{significant(score - best, 2)} of χ²", value=score - best
                ),
                Cell(text=", ".join(dict.fromkeys(p.belongs_to for p in parts))),
            ]
        )
    return rows


def fit_rows(told: dict[str, Any], draws: int) -> Rows:
    """Baseline beside extended, whatever numbers the two have; below, what was held out."""
    before, after = told["baseline"], told["extended"]
    rows = []
    for key, value in before.items():
        other = None if after is None else after[key]
        if isinstance(value, dict):
            for name, v in value.items():
                rows.append(_fit_row(key, v, None if other is None else other.get(name), draws, of=name))
        else:
            rows.append(_fit_row(key, value, other, draws))
    return rows + _held_out_rows(told["gain"], draws)


def _held_out_rows(gain: dict[str, Any] | None, draws: int) -> Rows:
    if gain is None:
        return []
    rows = []
    for key, before in gain.items():
        if key.endswith("_before") and before is not None:
            stem = key.removesuffix("_before")
            rows.append(_fit_row(stem, before, gain[f"{stem}_after"], draws, of="what was held out"))
        if key.endswith("_noise") and before is not None:
            row = _fit_row(key.removesuffix("_noise"), before, None, draws, of="the noise alone in it")
            rows.append([row[0], Cell(text=""), row[1], Cell(text="")])
    if gain["log_likelihood"] is not None:
        better = Cell(text=f"{gain['log_likelihood']:+.1f}", value=gain["log_likelihood"])
        rows.append([Cell(text="log-likelihood of what was held out"), Cell(text=""), Cell(text=""), better])
    return rows


def _fit_row(key: str, before: float, after: float | None, draws: int, *, of: str = "") -> list[Cell]:
    spoken = {"reduced_chi2": "reduced χ²", "p_value": "chance that noise alone departs as much"}
    name, unit = quantity_and_unit(key)
    part, unit = (1e-3, "kPa") if unit == "Pa" else (1.0, unit)
    head = spoken.get(key, name) + (f" of {of}" if of else "") + (f" / {unit}" if unit else "")

    def cell(value: float | None) -> Cell:
        if value is None:
            return Cell(text=NOTHING)
        text = chance(value, draws) if key == "p_value" else significant(part * value)
        low = key == "p_value" and value < SUSPECT
        return Cell(text=text, value=value, mark="bad" if low else "")

    change = Cell(text="")
    if after is not None and before and key != "p_value":
        change = Cell(text=f"{100.0 * (after / before - 1.0):+.1f} %")
    return [Cell(text=head), cell(before), cell(after), change]


def gain_sentence(told: dict[str, Any]) -> str:
    """How the extension was tried on measurements that its fit has not seen."""
    gain = told["gain"]
    if gain is None:
        return ""
    kept = f"{100 * gain['information_kept']:.0f} %"
    if gain["log_likelihood"] is None:
        why = gain["note"] or "no fold leaves enough of the effect in training"
        return f"Nothing was held out: {why} (at best {kept} of what is known of it)."
    return (
        f"Held out: {gain['held_out']}. Each time the fit saw all but one of these groups and predicted that"
        f" one; it kept at least {kept} of what is known of the effect. {gain['note']}".strip()
    )


def test_rows(diagnosis: Diagnosis) -> Rows:
    """Chance of each test of the residuals, at the baseline and with the best explanation."""
    finding = diagnosis.finding
    draws = len(finding.null.noise)
    best = finding.explanations[0].lack_of_fit if finding.explanations else None
    both = [finding.lack_of_fit, best]

    def cell(p: float | None) -> Cell:
        if p is None:
            return Cell(text=NOTHING)
        return Cell(text=chance(p, draws), value=p, mark="bad" if p < SUSPECT else "")

    rows = [
        [Cell(text=pattern(n)), *(cell(None if d is None else d.each[n]) for d in both)]
        for n in finding.lack_of_fit.each
    ]
    whole = [cell(None if d is None else d.p_value) for d in both]
    return [*rows, [Cell(text="all tests together, their number accounted for", mark="chosen"), *whole]]


def invisible_rows(diagnosis: Diagnosis) -> Rows:
    rows = []
    for i in diagnosis.undetectable:
        seen = math.isfinite(i.threshold)
        amount = _amplitude(i.parameter, i.threshold, 0.0) if seen else "no amplitude shows"
        effect = diagnosis.effects[i.effect]
        rows.append(
            [
                Cell(text=i.effect, mark="chosen"),
                Cell(text=effect.sentence),
                Cell(text=amount, value=i.threshold if seen else None),
                Cell(text=i.remedy),
            ]
        )
    return rows


def _amplitude(parameter: str, value: float, sd: float) -> str:
    name, unit = quantity_and_unit(parameter)
    number = with_sd(value, sd) if sd else significant(value, 2)
    joined = f"{number} {unit}".strip()
    return f"{name} {joined}" if name else joined
