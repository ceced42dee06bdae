"""Domain of validity: the ranges of the pokes that a model was trained on, and checks of pokes against them.

A surrogate predicts any poke without a warning; outside the trained ranges the prediction may be wrong by a
factor. The range of every quantity over the training part is therefore recorded with the checkpoint
(`domain_of`), each prediction is compared with it (`Domain.check`), and intervals widen with the distance
from it (`Domain.distance`). The ranges are those of the pokes themselves, not of the recipe that drew them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError

from learn._yaml import Finite, first_fault
from learn.data.store import Store
from learn.errors import InputError
from learn.quantities import (
    CLOCK_QUANTITIES,
    QUANTITIES,
    Interior,
    Quantity,
    interior_of,
    poke_values,
    shape_kind,
)
from learn.verdict import Check

Floats = NDArray[np.float64]


_ALL = {**QUANTITIES, **CLOCK_QUANTITIES}
RELATIVE_SLACK = 1e-3  # relative tolerance, added to the slack
NARROW = 0.01  # relative to the value: a narrower range counts as a single value
# Distance of another law: fitted laws of one silicone differ at strains beyond the measured ones
# (studies/learning/paper.md).
OTHER_LAW = 0.1
_LAW = "material law"


class Domain(BaseModel):
    """Ranges of the training part. Lengths in mm, angles in degrees, moduli in kPa.

    Attributes
    ----------
    ranges : least and largest value by key of `QUANTITIES`.
    kinds : kinds of inclusion ("cube", "cylinder", "sphere", "none"); None if they are not known.
    law : material law of the dataset.
    proportional : keys of quantities of which any value is inside, since the force is proportional to them
        and the displacement does not depend on them.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    ranges: dict[str, tuple[Finite, Finite]]
    kinds: tuple[str, ...] | None
    law: str
    proportional: tuple[str, ...] = ()

    def check(self, values: Mapping[str, float], kind: str | None, law: str | None = None) -> list[Check]:
        """Every quantity of a poke (`poke_values`) against its range.

        `kind` of the inclusion is None if unknown; `law` of the tissue is None if it was not given.
        """
        checks = []
        for key, value in values.items():
            quantity = _ALL[key]
            if key in self.proportional:
                checks.append(Check(key=key, name=quantity.name, value=value, trained="any", inside=True))
                continue
            if key not in self.ranges:
                checks.append(_unknown(key, value))
                continue
            low, high = self.ranges[key]
            beyond = max(_excess(quantity, low, high, value), 0.0) / unit_of(key, low, high)
            checks.append(
                Check(
                    key=key,
                    name=quantity.name,
                    value=value,
                    trained=_range(low, high, quantity),
                    inside=beyond == 0.0,
                    beyond=beyond,
                    unit=_unit_text(key, low, high),
                )
            )
        if kind is None or self.kinds is None:
            checks.append(_unknown("inclusion", kind or "unknown"))
        else:
            trained = ", ".join(self.kinds)
            inside = kind in self.kinds
            checks.append(
                Check(key="inclusion", name="inclusion", value=kind, trained=trained, inside=inside)
            )
        if law is not None:
            same = law == self.law
            checks.append(
                Check(
                    key="law",
                    name=_LAW,
                    value=law,
                    trained=self.law,
                    inside=same,
                    beyond=0.0 if same else OTHER_LAW,
                    unit="a range",
                )
            )
        return checks

    def knows(self, kind: str | None) -> bool:
        """True if a kind of inclusion was trained, or if that is not known."""
        return kind is None or self.kinds is None or kind in self.kinds

    def distance(self, values: Mapping[str, float], law: str | None = None) -> float:
        """Distance of a poke from the ranges, 0 inside: root of the sum of squares over its quantities.

        Each excess is relative to the width of its range, or to the value if the range is narrow; quantities
        without a known range count as 0, a law other than the dataset's as `OTHER_LAW`. The kind of inclusion
        does not count: an untrained kind has no larger errors within the ranges
        (studies/learning/part-of-paper.md), and is only flagged.
        """
        total = 0.0 if law is None or law == self.law else OTHER_LAW**2
        for key, value in values.items():
            if key in self.ranges:
                low, high = self.ranges[key]
                total += (max(_excess(_ALL[key], low, high, value), 0.0) / unit_of(key, low, high)) ** 2
        return math.sqrt(total)

    def rows(self) -> list[tuple[str, str]]:
        """The trained ranges as text: name, range."""
        rows = []
        for key, (low, high) in self.ranges.items():
            quantity = _ALL.get(key)
            if quantity is not None:
                rows.append((f"trained {quantity.name}", _range(low, high, quantity)))
        rows += [(f"trained {_ALL[key].name}", "any") for key in self.proportional if key in _ALL]
        return [*rows, ("trained inclusions", ", ".join(self.kinds or ["not known"]))]

    def texts(self, keys: Sequence[str]) -> list[str]:
        """Name and trained range of these quantities, where they have one: "depth 0.5 to 10 mm"."""
        known = [key for key in keys if key in self.ranges]
        return [f"{_ALL[key].name} {_range(*self.ranges[key], _ALL[key])}" for key in known]

    @classmethod
    def common(cls, domains: Sequence[Domain]) -> Domain:
        """Intersection of the domains, for an ensemble."""
        shared = set.intersection(*(set(domain.ranges) for domain in domains))
        ranges = {
            key: (max(d.ranges[key][0] for d in domains), min(d.ranges[key][1] for d in domains))
            for key in domains[0].ranges
            if key in shared
        }
        first = domains[0].kinds
        kinds = None
        if first is not None and all(domain.kinds is not None for domain in domains):
            kinds = tuple(kind for kind in first if all(kind in (d.kinds or ()) for d in domains))
        proportional = tuple(
            key for key in domains[0].proportional if all(key in d.proportional for d in domains)
        )
        return cls(ranges=ranges, kinds=kinds, law=domains[0].law, proportional=proportional)

    @classmethod
    def from_dict(cls, values: Any, where: str) -> Domain:
        """Read a domain from a checkpoint; InputError if it is damaged."""
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            raise InputError(f"{where}: domain: {first_fault(error)}") from None


def _unit_text(key: str, low: float, high: float) -> str:
    """The unit of an excess (`unit_of`) in words."""
    size = max(abs(low), abs(high))
    if high - low > NARROW * size:
        return "the range"
    return "the trained value" if size else f"{unit_of(key, low, high):.4g} {_ALL[key].units}".rstrip()


def unit_of(key: str, low: float, high: float) -> float:
    """What an excess over a range is measured in: its width, or the value of a narrow one.

    Of a range that is 0 alone it is the quantity's tolerance over NARROW, 10 degrees for an angle.
    """
    size = max(abs(low), abs(high))
    return (high - low if high - low > NARROW * size else size) or _ALL[key].slack / NARROW


def _excess(quantity: Quantity, low: float, high: float, value: float) -> float:
    """Excess of a value over the checked sides of its range; 0 or less inside."""
    slack = quantity.slack + RELATIVE_SLACK * max(abs(low), abs(high))
    under = -math.inf if quantity.sides == "high" else low - value
    over = -math.inf if quantity.sides == "low" else value - high
    return max(under, over) - slack


def _range(low: float, high: float, quantity: Quantity) -> str:
    units = f" {quantity.units}" if quantity.units else ""
    if quantity.sides == "low":
        return f"{low:.4g}{units} or more"
    if quantity.sides == "high":
        return f"{high:.4g}{units} or less"
    alike = math.isclose(low, high, rel_tol=1e-3)
    return f"{low:.4g}{units}" if alike else f"{low:.4g} to {high:.4g}{units}"


def unknown_checks(values: Mapping[str, float], kind: str | None, law: str | None = None) -> list[Check]:
    """Checks for a run whose trained ranges are not known."""
    checks = [_unknown(key, value) for key, value in values.items()]
    checks.append(_unknown("inclusion", kind or "unknown"))
    return checks if law is None else [*checks, _unknown("law", law)]


def _unknown(key: str, value: float | str) -> Check:
    name = _ALL[key].name if key in _ALL else _LAW if key == "law" else key
    return Check(key=key, name=name, value=value, trained="", inside=None)


def domain_of(store: Store, rows: NDArray[np.int64]) -> Domain:
    """Domain of a training part, given by its frames `rows`."""
    frames = store.frame_poke[rows]
    values: dict[str, list[float]] = {}
    kinds: set[str | None] = set()
    interiors: dict[int, Interior] = {}
    for poke in np.unique(frames):
        mine = rows[frames == poke]
        depths, clocks = store.depth[mine], store.clocks(mine)
        geometry, setup = int(store.geometry[poke]), store.setup_of(poke)
        if geometry not in interiors:
            interiors[geometry] = interior_of(setup, store.profile[geometry])
        ends = ((depths.min(), clocks.min(axis=0)), (depths.max(), clocks.max(axis=0)))
        for depth, clock in ends:
            found = poke_values(
                setup,
                interiors[geometry],
                start=store.path_start[poke],
                direction=store.direction[poke],
                depth=float(depth),
                modulus=float(store.modulus[poke]),
                clock=clock,
            )
            for key, value in found.items():
                values.setdefault(key, []).append(value)
        kinds.add(shape_kind(store, store.shapes[store.shape[poke]]))
    known = None if None in kinds else tuple(sorted(str(kind) for kind in kinds))
    proportional = ("shear_modulus_kPa",) if store.scales_with_modulus else ()
    ranges = {key: (min(column), max(column)) for key, column in values.items() if key not in proportional}
    return Domain(ranges=ranges, kinds=known, law=store.law, proportional=proportional)


def frame_distances(
    domain: Domain, store: Store, poke: NDArray[np.int64], depth: Floats, clock: Floats | None = None
) -> Floats:
    """Distance of frames of a store from a domain (`Domain.distance`), (f,).

    `poke` and `depth` [m] are those of the frames, (f,), and `clock` their times and speeds (`Store.clocks`),
    (f, 3). A law other than the domain's counts as in `Domain.distance`.
    """
    found = np.empty(len(poke))
    for index in np.unique(poke):
        setup = store.setup_of(index)
        interior = interior_of(setup, store.profile[int(store.geometry[index])])
        for frame in np.flatnonzero(poke == index):
            values = poke_values(
                setup,
                interior,
                start=store.path_start[index],
                direction=store.direction[index],
                depth=float(depth[frame]),
                modulus=float(store.modulus[index]),
                clock=None if clock is None else clock[frame],
            )
            found[frame] = domain.distance(values, store.law)
    return found
