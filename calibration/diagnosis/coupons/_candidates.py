"""Which effects may sit where in an experiment's coupons."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.coupons.effects import CouponEffect
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.records import scopes


def candidates_of(records: Sequence[Record], effects: Mapping[str, CouponEffect]) -> tuple[Candidate, ...]:
    """Each effect in all records that it touches; what belongs to a material also in one material or one
    specimen, what belongs to a rig also in one mode or one trial, where these differ."""
    found: list[Candidate] = []
    for effect in effects.values():
        touched = [r for r in records if effect.touches(r)]
        if not touched:
            continue
        labels = (
            ([r.material for r in touched], [r.specimen for r in touched])
            if effect.reach == "material"
            else ([str(r.mode) for r in touched], [r.name for r in touched])
        )
        # another direction of one piece: specimens without a name of their own are told apart by their trial
        own = ([r.name for r in touched],) if effect.name == "anisotropy" else ()
        for at, rivals in scopes([r.name for r in touched], (*labels, *own)):
            found.append(Candidate(effect=effect.name, at=at, rivals=rivals))
    return tuple(found)


def reaches(candidate: Candidate, record: Record, effect: CouponEffect) -> bool:
    """Whether a candidate is in a record."""
    places = (
        ("all", record.material, record.specimen, record.name)
        if effect.reach == "material"
        else ("all", record.mode, record.name)
    )
    return candidate.at in places and effect.touches(record)
