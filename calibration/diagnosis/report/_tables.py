"""Tables of the page: formatted numbers together with their values in `diagnosis.json`."""

from __future__ import annotations

import math
from typing import Any

from calibration.diagnosis.engine.remainder import about_remainder
from calibration.diagnosis.engine.sentences import percent
from calibration.diagnosis.engine.verdict import Diagnosis
from calibration.diagnosis.report._units import quantity_and_unit
from calibration.diagnosis.report._words import SUSPECT, meaning, p_text, pattern, scope
from calibration.pages import NOTHING, Cell, listed, significant, with_sd

Rows = list[list[Cell]]

BUDGET = (
    "cause",
    "description",
    "scope",
    "amplitude ± sd",
    "explained fraction of the misfit",
    "belongs to",
    "evidence",
    "to confirm",
)
FOLDS = ("left out", "baseline", "extended", "noise alone", "skill")
UNCHANGED = 1e-3  # of the baseline's error: a part predicted so alike is not changed
ALTERNATIVES = ("set of causes", "description", "compared with the best", "belongs to")
FITS = ("", "baseline", "extended", "change")
TESTS = ("test of the residuals", "baseline", "best explanation")
INVISIBLE = ("effect", "description", "amplitude visible at 5 sd", "alternative experiment")


def budget_rows(diagnosis: Diagnosis, data: dict[str, Any]) -> Rows:
    """One row per cause (named or nearest), then one for the unexplained misfit; no rows if there is none."""
    causes = sorted(data["causes"], key=lambda c: -(c["share"] or {"value": 0.0})["value"])
    rows = [_cause_row(diagnosis, c, data, named=True) for c in causes]
    nearest = data["nearest"]
    if nearest is not None:
        rows += [_cause_row(diagnosis, c, nearest, named=False) for c in nearest["causes"]]
    left = diagnosis.remainder
    if left is None:
        return rows
    unit, per_si = diagnosis.unit
    share = data["share"]
    part = (
        _one_less(share) if share is not None else "all" if nearest is None else _one_less(nearest["share"])
    )
    where = "; ".join(x for x in (left.place, listed(list(left.records)) if left.records else "") if x)
    # what a whole explanation leaves passes for noise, though its rms may be a little above it by chance
    real = left.rms > 0.0 and diagnosis.model_error is not None
    place = (where or "all measurements") if real else NOTHING
    rows.append(
        [
            Cell(text="not modelled"),
            Cell(text="remaining misfit beyond noise" if rows else "misfit beyond noise"),
            Cell(text=place),
            Cell(text=f"{significant(per_si * left.rms, 2)} {unit} rms", value=per_si * left.rms),
            Cell(text=part),
            Cell(text="not known" if real else NOTHING),
            Cell(text=_REPEATS[left.repeats] if real else "within the assumed noise"),
            Cell(text=(about_remainder(left) if real else "") or NOTHING),
        ]
    )
    return rows


_REPEATS = {
    "everywhere": "repeats in all tests: the form of the model, or the rig",
    "within a material": "repeats within each material",
    "within a specimen": "repeats within a specimen only: a fault of the specimen",
    "nowhere": "differs from test to test",
    "not known": "not known whether it repeats: no test was repeated",
}


def _one_less(share: dict[str, float | None]) -> str:
    assert share["value"] is not None
    left = 100.0 * min(max(1.0 - share["value"], 0.0), 1.0)
    return f"{left:.0f} %" if left == 0.0 or left > 0.5 else f"{max(left, 0.1):.1f} %"


def _cause_row(
    diagnosis: Diagnosis, cause: dict[str, Any], data: dict[str, Any], *, named: bool
) -> list[Cell]:
    """Row of one cause; several parameters of it are joined in one cell by semicolons."""
    effect = diagnosis.effects[cause["effect"]]
    told_apart = not named or cause["effect"] in diagnosis.finding.certain
    values = [(_amplitude(n, p["value"], p["sd"]), p["value"]) for n, p in cause["parameters"].items()]
    if effect.switch:  # it is there or not, and has no size
        values = [(cause.get("kind") or "there", values[0][1])]
    share, alone = cause.get("share") or data["share"], cause.get("share") or len(data["causes"]) == 1
    whole = named and len(diagnosis.finding.equivalent) > 1 and told_apart
    evidence = _evidence(cause, data["gain"], in_all_sets=whole)
    return [
        Cell(
            text=cause["effect"]
            + ("" if told_apart else " (or another)")
            + ("" if named else " (not named)"),
            mark="chosen" if named and told_apart else "",
        ),
        Cell(text=effect.sentence),
        Cell(text=scope(cause["scope"])),
        Cell(text="; ".join(t for t, _ in values), value=values[0][1], mark="chosen" if named else ""),
        Cell(
            text=NOTHING if share is None else _share(share) + ("" if alone else " together"),
            value=None if share is None else share["value"],
        ),
        Cell(text=meaning(effect)),
        Cell(text=evidence, value=cause.get("confidence")),
        Cell(text=effect.remedy),
    ]


def _share(share: dict[str, float | None]) -> str:
    def part(x: float) -> str:
        return f"{100.0 * min(max(x, 0.0), 1.0):.0f}"

    value, low, high = share["value"], share["low"], share["high"]
    assert value is not None
    return f"{part(value)} %" + ("" if low is None or high is None else f" [{part(low)}, {part(high)}]")


def _evidence(cause: dict[str, Any], gain: dict[str, Any] | None, *, in_all_sets: bool) -> str:
    """Clauses on confidence and held-out skill. in_all_sets : the cause is in all equivalent sets."""
    parts = []
    if in_all_sets:
        parts.append("in every set of causes that fits as well")
    elif "confidence" in cause:
        parts.append(f"first again in {_confidence(cause['confidence'])} of replicates")
    if gain is not None and gain["skill"] is not None:
        parts.append(f"held-out skill {gain['skill']:.2f} ({gain['held_out']})")
    elif gain is not None:
        nothing = gain["held_out"] == "none"
        parts.append("nothing held out" if nothing else "held out, the baseline leaves no more than noise")
    return "; ".join(parts)


def fold_rows(data: dict[str, Any], unit: str) -> Rows:
    """One row per held-out fold; folds that the causes do not change are counted in a last row."""
    gain = data["gain"] or (data["nearest"] or {}).get("gain")
    rows: Rows = []
    same = 0
    for part in gain["folds"] if gain is not None else []:
        figures = [part[f"rms_{unit}_{x}"] for x in ("before", "after", "noise")]
        if abs(figures[1] - figures[0]) <= UNCHANGED * figures[0]:
            same += 1
            continue
        skill = part["skill"]
        rows.append(
            [
                Cell(text=part["left_out"]),
                *(Cell(text=f"{significant(x)} {unit}", value=x) for x in figures),
                Cell(text=NOTHING if skill is None else f"{skill:.2f}", value=skill),
            ]
        )
    if same:
        others = f"{same} other{'s' * (same > 1)}" if rows else f"all {same}"
        rows.append([Cell(text=others), Cell(text="as without it"), *(Cell(text=NOTHING) for _ in range(3))])
    return rows


def _confidence(part: float) -> str:
    """In percent, at most "> 99.9 %", the resolution of a thousand replicates."""
    return "> 99.9 %" if part > 0.999 else f"{100.0 * part:.3g} %"


def alternative_rows(diagnosis: Diagnosis) -> Rows:
    """Equivalent sets of effects, the chosen one first."""
    finding = diagnosis.finding
    best = finding.explanations[0].score if finding.explanations else 0.0
    rows = []
    for k, names in enumerate(finding.equivalent):
        score = min(e.score for e in finding.explanations if e.names == names)
        parts = [diagnosis.effects[n] for n in names]
        if names in diagnosis.equally_large:
            share = diagnosis.equally_large[names]
            worse = Cell(text=f"takes {percent(share)}", value=share.value)
        elif diagnosis.equally_large and diagnosis.share is not None:
            worse = Cell(text=f"takes {percent(diagnosis.share)}", value=diagnosis.share.value)
        else:
            text = "the best" if k == 0 else f"{significant(score - best, 2)} of χ²"
            worse = Cell(text=text, value=score - best)
        rows.append(
            [
                Cell(text=" + ".join(names), mark="chosen" if k == 0 else ""),
                Cell(text="; and ".join(p.sentence for p in parts)),
                worse,
                Cell(text=", ".join(dict.fromkeys(p.belongs_to for p in parts))),
            ]
        )
    return rows


def fit_rows(data: dict[str, Any], draws: int) -> Rows:
    """Numbers of the baseline and the extended fit, then held-out scores."""
    before, after = data["baseline"], data["extended"]
    rows = []
    for key, value in before.items():
        other = None if after is None else after[key]
        if isinstance(value, dict):
            for name, v in value.items():
                rows.append(_fit_row(key, v, None if other is None else other.get(name), draws, of=name))
        else:
            rows.append(_fit_row(key, value, other, draws))
    return rows + _held_out_rows(data["gain"], draws)


def _held_out_rows(gain: dict[str, Any] | None, draws: int) -> Rows:
    if gain is None:
        return []
    rows = []
    for key, before in gain.items():
        if key == "folds":
            continue
        if key.endswith("_before") and before is not None:
            stem = key.removesuffix("_before")
            rows.append(_fit_row(stem, before, gain[f"{stem}_after"], draws, of="the held-out data"))
        if key.endswith("_noise") and before is not None:
            row = _fit_row(
                key.removesuffix("_noise"), before, None, draws, of="the noise in the held-out data"
            )
            rows.append([row[0], Cell(text=""), row[1], Cell(text="")])
    if gain["log_likelihood"] is not None:
        better = Cell(text=f"{gain['log_likelihood']:+.1f}", value=gain["log_likelihood"])
        rows.append([Cell(text="log-likelihood of the held-out data"), Cell(text=""), Cell(text=""), better])
    return rows


def _fit_row(key: str, before: float, after: float | None, draws: int, *, of: str = "") -> list[Cell]:
    spoken = {"reduced_chi2": "reduced χ²", "p_value": "p-value of the lack of fit"}
    name, unit = quantity_and_unit(key)
    part, unit = (1e-3, "kPa") if unit == "Pa" else (1.0, unit)
    head = spoken.get(key, name) + (f" of {of}" if of else "") + (f" / {unit}" if unit else "")

    def cell(value: float | None) -> Cell:
        if value is None:
            return Cell(text=NOTHING)
        text = p_text(value, draws) if key == "p_value" else significant(part * value)
        low = key == "p_value" and value < SUSPECT
        return Cell(text=text, value=value, mark="bad" if low else "")

    change = Cell(text="")
    if after is not None and before and key != "p_value":
        change = Cell(text=f"{100.0 * (after / before - 1.0):+.1f} %")
    return [Cell(text=head), cell(before), cell(after), change]


def gain_sentence(data: dict[str, Any]) -> str:
    """Sentences on the held-out folds; "" if there are no held-out scores of a named explanation."""
    gain = data["gain"]
    if gain is None:
        return ""
    kept = f"{100 * gain['information_kept']:.0f} %"
    if gain["log_likelihood"] is None:
        why = gain["note"] or "no fold leaves enough of the effect in training"
        return f"Nothing was held out: {why} (at best {kept} of the information on it)."
    return (
        f"Held out: {gain['held_out']}. Each of these groups was predicted by a fit to all others, which have"
        f" at least {kept} of the information on the effect. {gain['note']}".strip()
    )


def test_rows(diagnosis: Diagnosis) -> Rows:
    """p-value of each test of the residuals, for the baseline and for the best explanation."""
    finding = diagnosis.finding
    draws = len(finding.null.noise)
    best = finding.explanations[0].lack_of_fit if finding.explanations else None
    both = [finding.lack_of_fit, best]

    def cell(p: float | None) -> Cell:
        if p is None:
            return Cell(text=NOTHING)
        return Cell(text=p_text(p, draws), value=p, mark="bad" if p < SUSPECT else "")

    rows = [
        [
            Cell(text=pattern(n, diagnosis.subject.kind)),
            *(cell(None if d is None else d.each[n]) for d in both),
        ]
        for n in finding.lack_of_fit.each
    ]
    whole = [cell(None if d is None else d.p_value) for d in both]
    return [*rows, [Cell(text="all tests together, corrected for their number", mark="chosen"), *whole]]


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
