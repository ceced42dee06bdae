"""Which effects may sit where in an experiment's pokes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.pokes._record import Record
from calibration.diagnosis.pokes.effects import PokeEffect
from calibration.diagnosis.records import scopes


@dataclass(frozen=True, kw_only=True)
class PokeCandidate(Candidate):
    """kind: which variant of the effect (see `PokeEffect.kinds`), said: in words."""

    kind: float | None = None
    said: str = ""

    @property
    def label(self) -> str:
        where = "" if self.at == "all" else f" of {self.at}"
        return self.effect + where + (f" ({self.said})" if self.said else "")


def candidates_of(records: Sequence[Record], effects: Mapping[str, PokeEffect]) -> tuple[PokeCandidate, ...]:
    """Each effect, in each of its kinds, in all records that it touches; what belongs to a material also in
    one material or one specimen, what belongs to a block also in blocks of one size, what belongs to a rig
    also in one rod's or one record, where these differ."""
    found: list[PokeCandidate] = []
    for effect in effects.values():
        touched = [r for r in records if effect.touches(r)]
        if not touched:
            continue
        kinds = effect.kinds(touched)
        for at, rivals in _scopes(touched, effect):
            for kind in kinds:
                found.append(
                    PokeCandidate(
                        effect=effect.name,
                        at=at,
                        rivals=rivals * len(kinds),
                        kind=kind,
                        said="" if kind is None else effect.kind_label(kind),
                    )
                )
    return tuple(found)


def _scopes(touched: Sequence[Record], effect: PokeEffect) -> list[tuple[str, int]]:
    kinds = len(_places(touched[0], effect))
    labels = [[_places(r, effect)[k] for r in touched] for k in range(kinds)]
    return scopes([r.name for r in touched], labels)


def _places(record: Record, effect: PokeEffect) -> tuple[str, ...]:
    """What holds a record and may carry an effect, the wider first."""
    if effect.reach == "rig":
        return (record.rod, record.name)
    blocks = record.blocks if effect.reach == "block" else ()
    return (record.material, *blocks, record.specimen)


def kind_of(candidate: Candidate) -> float | None:
    return candidate.kind if isinstance(candidate, PokeCandidate) else None


def reaches(candidate: Candidate, record: Record, effect: PokeEffect) -> bool:
    """Whether a candidate is in a record."""
    return candidate.at in ("all", *_places(record, effect)) and effect.touches(record)
