"""Extras of compression tests: deviations between repeated tests, and mesh error of bonded cylinders."""

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

# sd of each term of the mesh error of ln(bonded / free): two meshes (refinement 1 and 1.5) differ by 0.003
# rms, in ripples with a length of a tenth of the height, since the side touches the platen node by node.
MESH = 0.003
MESH_BEND = 12
REMEMBERED = 512  # cached bases, which fits evaluate repeatedly for the same records


@dataclass(frozen=True, eq=False, kw_only=True)
class Coordinates:
    """Extras of a baseline: terms of each record's deviation (if repeats show their sd), then mesh error.

    Attributes
    ----------
    baseline : baseline with these extras.
    last : strain up to which deviations vary.
    scattered : names of the records that have a deviation.
    terms : indices of its terms in `TERMS`.
    bases : cached bases of the deviations, by record.
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
        """Coefficients of the mesh error, shape (MESH_BEND + 1,)."""
        return u[-(MESH_BEND + 1) :]

    def deviation(self, record: Record, u: Array) -> Array:
        """Deviation of the logarithm of a record's force, shape (k,)."""
        if record.name not in self.scattered or not self.terms:
            return np.zeros(record.points)
        first = self._of_record(record)
        (own,) = self.bases.fetch([record], lambda _: [basis(1.0 - record.stretch, self.last)[:, self.terms]])
        return np.asarray(own @ u[first : first + len(self.terms)])

    def mesh_error(self, strain: Array, mesh: Array) -> Array:
        """Mesh error of ln(bonded / free force), shape of the strain; mesh : its coefficients."""
        return bent(strain, LAST, mesh)

    def constrained_by(self, record: Record) -> NDArray[np.bool_]:
        """Mask (n,) of the coordinates that a record constrains."""
        found = self.baseline.informed_by(record, whole_material=False)
        if record.name in self.scattered:
            first = self._of_record(record)
            found[first : first + len(self.terms)] = True
        found[-(MESH_BEND + 1) :] = True
        return found

    def _of_record(self, record: Record) -> int:
        """Index in u of the first term of a record's deviation."""
        return self.baseline.first_extra + self.scattered.index(record.name) * len(self.terms)
