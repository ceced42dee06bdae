"""Which effects may sit where in an experiment's bars."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from calibration.diagnosis.bars._record import Record, groups_of
from calibration.diagnosis.bars.effects import BarEffect
from calibration.diagnosis.effect import Candidate


@dataclass(frozen=True, kw_only=True)
class BarCandidate(Candidate):
    """kind: which variant of the effect (see `BarEffect.kinds`), said: in words."""

    kind: float | None = None
    said: str = ""

    @property
    def label(self) -> str:
        where = "" if self.at == "all" else f" of {self.at}"
        return self.effect + where + (f" ({self.said})" if self.said else "")


def candidates_of(records: Sequence[Record], effects: Mapping[str, BarEffect]) -> tuple[BarCandidate, ...]:
    """Each effect, in each of its kinds, in all records that it touches; what belongs to a material also in
    one material or specimen, what belongs to a rig also in the trials of one load or in one, where these
    differ."""
    found: list[BarCandidate] = []
    for effect in effects.values():
        touched = [r for r in records if effect.touches(r)]
        if not touched:
            continue
        for at, rivals in _scopes(touched, effect):
            for kind in effect.kinds:
                found.append(
                    BarCandidate(
                        effect=effect.name,
                        at=at,
                        rivals=rivals * len(effect.kinds),
                        kind=kind,
                        said="" if kind is None else effect.kind_label(kind),
                    )
                )
    return tuple(found)


def _scopes(touched: Sequence[Record], effect: BarEffect) -> list[tuple[str, int]]:
    found, groups = [("all", 1)], [tuple(r.name for r in touched)]
    for names in _labels(touched, effect):
        distinct = list(dict.fromkeys(names))
        for name in distinct:
            members = tuple(r.name for r, n in zip(touched, names, strict=True) if n == name)
            if members not in groups:
                groups.append(members)
                found.append((name, len(distinct)))
    return found


def _labels(touched: Sequence[Record], effect: BarEffect) -> list[list[str]]:
    if effect.reach == "material":
        return [[r.trial.material for r in touched], [r.specimen for r in touched]]
    return [[load_of(r) for r in touched], [r.name for r in touched]]


def load_of(record: Record) -> str:
    """What hangs on a record's bar, in words."""
    return next(iter(groups_of([record])))


def kind_of(candidate: Candidate) -> float | None:
    return candidate.kind if isinstance(candidate, BarCandidate) else None


def reaches(candidate: Candidate, record: Record, effect: BarEffect) -> bool:
    """Whether a candidate is in a record."""
    places = (
        ("all", record.trial.material, record.specimen)
        if effect.reach == "material"
        else ("all", load_of(record), record.name)
    )
    return candidate.at in places and effect.touches(record)
