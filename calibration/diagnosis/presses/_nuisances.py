"""Free coordinates besides the moduli: how repeats differ, and the mesh's error of bonded cylinders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from calibration.diagnosis.coupons._baseline import Baseline
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.presses._pressed import LAST, is_pressed
from calibration.diagnosis.presses._wobble import TERMS, Wobble, basis, bends

Array = NDArray[np.float64]

# Of each term of the logarithm of bonded over free: two meshes (refinement 1 and 1.5) differ by 0.003 rms, in
# ripples as long as a tenth of the height, since the side comes down node by node.
MESH = 0.003
MESH_BEND = 12


class PressBaseline(Baseline):
    """A Neo-Hookean `Baseline` whose coordinates u go on, after the moduli, with the terms of each pressed
    record's deviation (where repeats tell how large these are), and those of the mesh's error."""

    def __init__(self, records: Sequence[Record], wobble: Wobble) -> None:
        super().__init__(records, "neo-hookean")
        self.last = wobble.last
        self.moduli = len(self.names)
        self.wobbly = tuple(r.name for r in records if is_pressed(r))
        self.terms = tuple(int(k) for k in np.flatnonzero(wobble.sds))
        sds = [float(wobble.sds[k]) for _ in self.wobbly for k in self.terms] + [MESH] * (MESH_BEND + 1)
        self.names += tuple(f"{name} {TERMS[k]}" for name in self.wobbly for k in self.terms)
        self.names += tuple(f"mesh error {k}" for k in range(MESH_BEND + 1))
        self.prior = block_diag(self.prior, np.diag(1.0 / np.array(sds)))
        self.centre = np.concatenate([self.centre, np.zeros(len(sds))])

    def start(self, records: Sequence[Record]) -> Array:
        return np.concatenate([super().start(records), np.zeros(len(self.names) - self.moduli)])

    def inner(self, u: Array) -> Array:
        """The coordinates that are not a record's own deviation."""
        return np.concatenate([u[: self.moduli], u[-(MESH_BEND + 1) :]])

    def deviation(self, record: Record, u: Array) -> Array:
        """Of the logarithm of a record's force (k,)."""
        if record.name not in self.wobbly or not self.terms:
            return np.zeros(record.points)
        first = self.moduli + self.wobbly.index(record.name) * len(self.terms)
        return np.asarray(
            basis(1.0 - record.stretch, self.last)[:, self.terms] @ u[first : first + len(self.terms)]
        )

    def mesh_error(self, strain: Array, u: Array) -> Array:
        """Of the logarithm of bonded over free force."""
        return np.asarray(bends(strain, LAST, MESH_BEND) @ u[-(MESH_BEND + 1) :])

    def owned(self, records: Sequence[Record]) -> NDArray[np.bool_]:
        """Which coordinates some records tell of, (n,)."""
        specimens, names = {r.specimen for r in records}, {r.name for r in records}
        return np.array(
            [s in specimens for s in self.specimens]
            + [name in names for name in self.wobbly for _ in self.terms]
            + [True] * (MESH_BEND + 1)
        )
