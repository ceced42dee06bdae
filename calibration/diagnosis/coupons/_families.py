"""Which points may be left out together, to be predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.records import distinct, fifths


def families_of(records: Sequence[Record]) -> Mapping[str, Sequence[tuple[str, object]]]:
    """Points (by index) by mode, by material, by trial, by loading and unloading, and in fifths of each
    record. A family of one group, or the same as another, is left out."""
    by: dict[str, dict[str, list[int]]] = {}
    first = 0
    for r in records:
        labels = {
            "leave-one-mode-out": [str(r.mode)] * r.points,
            "leave-one-material-out": [r.material] * r.points,
            "leave-one-trial-out": [r.name] * r.points,
            "leave-one-branch-out": [f"{r.name} branch {b + 1:.0f}" for b in r.branch],
            "leave-one-fifth-out": fifths(r.points),
        }
        for family, names in labels.items():
            groups = by.setdefault(family, {})
            for k, name in enumerate(names):
                groups.setdefault(name, []).append(first + k)
        first += r.points
    return distinct(by)
