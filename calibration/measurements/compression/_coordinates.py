"""Coordinates of compression besides the moduli: how repeated tests differ, and the mesh's error of bonded
cylinders."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._baseline import Baseline, Extra
from calibration.measurements._memory import Memory
from calibration.measurements.compression._record import LAST, is_compressed
from calibration.measurements.compression._repeatability import TERMS, Repeatability, basis, bent
from calibration.measurements.homogeneous._record import Record

Array = NDArray[np.float64]

# sd of each term of the logarithm of bonded over free: two meshes (refinement 1 and 1.5) differ by 0.003 rms,
# in ripples as long as a tenth of the height, since the side comes down node by node.
MESH = 0.003
MESH_BEND = 12
REMEMBERED = 512  # bases: fits ask for those of the same records again and again


@dataclass(frozen=True, eq=False, kw_only=True)
class Coordinates:
    """Extras of a baseline, in this order: the terms of each record's deviation (where repeats show how large
    these are), and those of the mesh's error.

    Attributes
    ----------
    baseline : with these extras.
    last : strain up to which records are compared.
    scattered : records that have a deviation. terms : of `TERMS`, by index.
    bases : of deviations, by record.
    """

    baseline: Baseline
    last: float
    scattered: tuple[str, ...]
    terms: tuple[int, ...]
    bases: Memory[Hashable, Array] = field(default_factory=lambda: Memory(REMEMBERED))

    @classmethod
    def of(cls, records: Sequence[Record], plain: Baseline, repeatability: Repeatability) -> Coordinates:
        scattered = tuple(r.name for r in records if is_compressed(r))
        terms = tuple(int(k) for k in np.flatnonzero(repeatability.sds))
        extras = [
            Extra(name=f"{name} {TERMS[k]}", sd=float(repeatability.sds[k]))
            for name in scattered
            for k in terms
        ]
        extras += [Extra(name=f"mesh error {k}", sd=MESH) for k in range(MESH_BEND + 1)]
        return cls(
            baseline=plain.with_extras(extras), last=repeatability.last, scattered=scattered, terms=terms
        )

    def mesh(self, u: Array) -> Array:
        """Terms of the mesh's error, shape (MESH_BEND + 1,)."""
        return u[-(MESH_BEND + 1) :]

    def deviation(self, record: Record, u: Array) -> Array:
        """Of the logarithm of a record's force (k,)."""
        if record.name not in self.scattered or not self.terms:
            return np.zeros(record.points)
        first = self._of_record(record)
        (own,) = self.bases.fetch([record], lambda _: [basis(1.0 - record.stretch, self.last)[:, self.terms]])
        return np.asarray(own @ u[first : first + len(self.terms)])

    def mesh_error(self, strain: Array, mesh: Array) -> Array:
        """Of the logarithm of bonded over free force, shape of the strain; mesh : its terms."""
        return bent(strain, LAST, mesh)

    def constrained_by(self, record: Record) -> NDArray[np.bool_]:
        """Coordinates (n,) that a record constrains."""
        found = self.baseline.informed_by(record, whole_material=False)
        if record.name in self.scattered:
            first = self._of_record(record)
            found[first : first + len(self.terms)] = True
        found[-(MESH_BEND + 1) :] = True
        return found

    def _of_record(self, record: Record) -> int:
        """Where a record's deviation begins."""
        return self.baseline.first_extra + self.scattered.index(record.name) * len(self.terms)
