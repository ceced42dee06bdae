"""Noise of the measurements, completed from the data before a search.

The lab states the noise of a record, or the record shows it: from point to point by its scatter about a
smooth curve, and between tests by repeats.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._forward_model import ForwardModel
from calibration.measurements._noise_known import (
    FEWEST,
    POINTS_PER_FREEDOM,
    NoiseKnown,
    PointNoise,
    Source,
    roughness,
)
from calibration.measurements._state import State
from calibration.measurements._variance_components import (
    Curve,
    VarianceComponents,
    deviations,
    variance_components,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Shown:
    """A record for display, point by point.

    Attributes
    ----------
    axis : label of x, with its unit.
    x : abscissa in that unit, shape (p,).
    quantity : name of the compared quantity.
    unit : unit of the quantity in files, and the number of these units per SI unit.
    measured : measured values [SI], shape (p,); 0 if distances between simulated and measured are compared.
    of_rows : matrix from the record's rows to the points, shape (p, rows); None for the identity.
    """

    axis: str
    x: Array
    quantity: str
    unit: tuple[str, float]
    measured: Array
    of_rows: Array | None = None

    def points(self, rows: Array) -> Array:
        """Map values of the record's rows, shape (rows,) or (rows, k), to the points."""
        return rows if self.of_rows is None else np.asarray(self.of_rows @ rows)


class NoisyModel(ForwardModel):
    """A forward model that completes its noise; attributes in addition to those of `ForwardModel`.

    Attributes
    ----------
    unit : unit of `distance_rms` in files, and the number of these units per SI unit.
    from_data : number of points from whose scatter the noise was taken in place of what the lab states, by
        the record's name.
    """

    unit: ClassVar[tuple[str, float]]
    from_data: Mapping[str, int] = MappingProxyType({})

    @abstractmethod
    def start(self) -> Array:
        """Start coordinates of the baseline's fit, shape (n,); ValueError if there are none."""

    # -- noise --

    def point_noise(self) -> list[PointNoise]:
        """Noise of each record from point to point: scatter of the misfit at `start` about a smooth curve.

        Empty if the rows are correlated. Records with fewer than FEWEST third differences, without scatter,
        or without a solution at the start are left out. ValueError if there is no start.
        """
        if self.noise.covariance is not None:
            return []
        misfit = self._misfit([State(u=self.start())])[0]
        found = []
        for k, r in enumerate(self.records):
            rows = (self.row_record == k) & self.noise.used & np.isfinite(misfit)
            sd = self.noise.sd[rows]
            factor, points = roughness(misfit[rows] / sd)
            if points >= FEWEST and factor > 0.0:
                assumed = float(np.median(sd))
                found.append(
                    PointNoise(
                        record=str(r.name),
                        stated=self.states_noise(k),
                        assumed=assumed,
                        shown=factor * assumed,
                        points=points,
                    )
                )
        return found

    def states_noise(self, k: int) -> bool:
        """True if the lab states the noise of record `k`."""
        return not getattr(self.records[k], "estimated", False)

    def repeated(self) -> tuple[str, ...]:
        """Names of the tests from whose repeats this kind's own noise model has the scatter between tests.

        () if there are none.
        """
        return ()

    def repeat_of(self, k: int) -> Hashable | None:
        """Key (mode, range, rate, ...) that record `k` shares with its repeats, beside material and specimen.

        None if no record of this kind is a repeat of another.
        """
        del k
        return None

    def settle_noise(self, source: Source) -> NoiseKnown:
        """Complete `noise` before the search, and return its summary; to be called once.

        The scatter between repeats (`variance_components`) is estimated and added as nuisances, if the kind
        has no repeats of its own, no nuisances and no correlated rows. With repeats, records whose noise is
        not stated get the standard deviation that they show together (`_shown_together`). With source "data",
        records whose scatter contradicts the stated noise get the one that each shows.
        """
        stated = all(self.states_noise(k) for k in range(len(self.records)))
        repeats, components = self.repeated(), VarianceComponents()
        points = tuple(self.point_noise())
        if not repeats and not self.noise.columns.shape[1] and self.noise.covariance is None:
            shown = self._shown_together(points)
            components = variance_components(self._curves(shown))
            repeats = components.repeats
            if repeats:
                self._rescale(shown)
                points = tuple(replace(p, assumed=p.assumed * shown.get(p.record, 1.0)) for p in points)
            self._take_scatter(components)
        known = NoiseKnown(
            known=stated or bool(repeats),
            points=points,
            repeats=repeats,
            components=components,
            unit=self.unit,
        )
        if source == "stated":
            return known
        factors = {p.record: p.factor for p in points if p.contradicts}
        self._rescale(factors)
        self.from_data = {p.record: p.points for p in points if p.contradicts}
        dof = float(np.median([p.points for p in points])) / POINTS_PER_FREEDOM if factors else known.dof
        return replace(known, source="data", dof=dof)

    def take_noise(self, known: NoiseKnown, *, predicted: bool = False) -> None:
        """Take the noise of repeats that `settle_noise` has found in a model of some of these records.

        What they show together is the noise of all records of their tests. Their own deviation is estimated
        with the fit of a record; a predicted record is off by it.
        """
        if known.components.repeats:
            self._rescale(self._shown_together(known.points))
        self._take_scatter(known.components, predicted=predicted)

    def _shown_together(self, points: Sequence[PointNoise]) -> dict[str, float]:
        """Factors on the standard deviation of records whose noise is not stated, by name: one noise a test.

        `points` may be of some records of a test only, and hold for all of them.

        An assumed noise exceeds what scatters from point to point, for errors that all points of a record
        share: with repeats, these are the scatter between them. One in proportion to the largest value of its
        record would give records that read too high a smaller weight.
        """
        by_name = {p.record: p for p in points if not p.stated}
        tests: dict[Hashable, list[int]] = {}
        for k, r in enumerate(self.records):
            test = self.repeat_of(k)
            if test is not None and not self.states_noise(k):
                tests.setdefault((r.material, test), []).append(k)
        factors: dict[str, float] = {}
        for own in tests.values():
            group = [by_name[name] for k in own if (name := str(self.records[k].name)) in by_name]
            if not group:
                continue
            shown = np.sqrt(np.average([p.shown**2 for p in group], weights=[p.points for p in group]))
            sd = min(float(shown), float(np.median([p.assumed for p in group])))
            for k in own:
                mine = self.noise.sd[(self.row_record == k) & np.isfinite(self.noise.sd)]
                if mine.size:
                    factors[str(self.records[k].name)] = sd / float(np.median(mine))
        return factors

    def _rescale(self, factors: Mapping[str, float]) -> None:
        """Multiply the standard deviation of records by a factor, by name."""
        by_record = np.array([factors.get(str(r.name), 1.0) for r in self.records])
        self.noise = replace(self.noise, sd=self.noise.sd * by_record[self.row_record])

    def _take_scatter(self, components: VarianceComponents, *, predicted: bool = False) -> None:
        """Add the scatter between repeats to `noise`: as nuisances, or to the standard deviation."""
        if not components.repeat:
            return
        columns = []
        for k, own in enumerate(deviations(self._curves({}), components.expected)):
            for deviation in own:
                columns.append(np.zeros(len(self.row_record)))
                columns[-1][self.row_record == k] = deviation
        if predicted:
            sd = np.sqrt(self.noise.sd**2 + np.sum(np.square(columns), axis=0))
            self.noise = replace(self.noise, sd=sd)
        else:
            self.noise = replace(self.noise, symmetric=True).with_nuisances(columns)

    def _curves(self, shown: Mapping[str, float]) -> list[Curve]:
        """Misfit of each record at `start`; empty if a record has no full scale or no driven quantity.

        shown : factor on the standard deviation of records whose noise is not stated.
        """
        scale = self.full_scale()
        along = [self.along(k) for k in range(len(self.records))]
        if scale is None or any(a is None for a in along):
            return []
        misfit = self._misfit([State(u=self.start())])[0]
        return [
            Curve(
                name=str(r.name),
                material=r.material,
                specimen=r.specimen,
                test=self.repeat_of(k),
                x=a[1],
                branch=self.branch(k),
                misfit=misfit[self.row_record == k],
                sd=self.noise.sd[self.row_record == k] * shown.get(str(r.name), 1.0),
                scale=float(scale[k]),
            )
            for k, (r, a) in enumerate(zip(self.records, along, strict=True))
            if a is not None
        ]

    def full_scale(self) -> Array | None:
        """Largest |measured value| of each record [SI], shape (records,).

        None if that of any record is 0 (distances between simulated and measured are compared).
        """
        found = np.array([float(np.abs(self.shown(k).measured).max()) for k in range(len(self.records))])
        return found if (found > 0.0).all() else None

    def along(self, k: int) -> tuple[str, Array] | None:
        """Driven quantity of record `k`: its name, and its values at the rows; None if it has none."""
        del k
        return None

    def branch(self, k: int) -> NDArray[np.int64]:
        """Number of the stroke of each row of record `k`; 0 throughout where rows are not in strokes."""
        return np.zeros(int(np.count_nonzero(self.row_record == k)), dtype=np.int64)

    def shown(self, k: int) -> Shown:
        """Record `k` for display."""
        rows = int(np.count_nonzero(self.row_record == k))
        return Shown(
            axis="row of the record",
            x=np.arange(float(rows)),
            quantity="simulated less measured",
            unit=self.unit,
            measured=np.zeros(rows),
        )
