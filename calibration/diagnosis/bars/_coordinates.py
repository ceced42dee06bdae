"""The baseline's free coordinates u of bars: what each stands for, and what is known of it beforehand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._candidates import load_of
from calibration.diagnosis.bars._record import Record, groups_of
from calibration.diagnosis.specimens import scatter_rows

Array = NDArray[np.float64]

RELEASE = 0.01  # seconds, and
START = 0.1  # part of the settled pose, that one unit of a trial's own coordinates is
RELEASE_SD, START_SD = 0.03, 0.2  # what is known of them beforehand [s], [-]
VISCOUS, VISCOUS_SD = 2e-3, 3.0  # [s] and sd of its logarithm
SHARED, SHARED_SD = 0.5, 0.5  # of markers next to a clamp: part by which they go with it
# Of ln G from one load to another: by how much the reduced bar may err there (its frequency against FEM's:
# 0.1 to 0.3 %), and one unit of the coordinate. It moves the phase of the last swings by so much that it is
# no linear nuisance.
LOAD, LOAD_SD = 0.02, 0.003
Own = tuple[float, float, float]  # release [s], start, share


@dataclass(frozen=True, kw_only=True)
class Coordinates:
    """In this order: of each specimen, whose material owners names; of each material; two of each trial; of
    each load but the first; of each specimen with markers near its clamp. See `BarModel`."""

    specimens: tuple[str, ...]
    owners: tuple[str, ...]
    materials: tuple[str, ...]
    trials: tuple[str, ...]
    loads: tuple[str, ...]
    near: tuple[str, ...]

    @classmethod
    def of(cls, records: Sequence[Record]) -> Coordinates:
        owner = {r.specimen: r.trial.material for r in records}
        return cls(
            specimens=tuple(owner),
            owners=tuple(owner.values()),
            materials=tuple(dict.fromkeys(owner.values())),
            trials=tuple(r.name for r in records),
            loads=tuple(groups_of(records)),
            near=tuple(dict.fromkeys(r.specimen for r in records if (r.near & ~r.inside).any())),
        )

    @cached_property
    def names(self) -> tuple[str, ...]:
        return (
            self.specimens
            + tuple(f"{m} relaxation time" for m in self.materials)
            + tuple(f"{t} {what}" for t in self.trials for what in ("release", "start"))
            + tuple(f"error with {load}" for load in self.loads[1:])
            + tuple(f"{s} share of the clamp" for s in self.near)
        )

    def shear(self, record: Record, u: Array) -> float:
        """Modulus of a record's bar [Pa], in error as it may be with its load."""
        load = load_of(record)
        error = LOAD * float(u[self.of_load(load)]) if load != self.loads[0] else 0.0
        return float(np.exp(u[self.specimens.index(record.specimen)] + error))

    def viscous(self, record: Record, u: Array) -> float:
        """Relaxation time of a record's material [s]."""
        return float(np.exp(u[self.of_material(record.trial.material)]))

    def own(self, record: Record, u: Array) -> Own:
        """When and from where a record's bar was let go, and by how much its markers go with the clamp."""
        first = self.of_trial(record)
        share = 0.0
        if record.specimen in self.near:
            share = float(u[len(self.names) - len(self.near) + self.near.index(record.specimen)])
        return record.released + RELEASE * float(u[first]), START * float(u[first + 1]), share

    def of_material(self, material: str) -> int:
        """Where a material's relaxation time stands."""
        return len(self.specimens) + self.materials.index(material)

    def of_trial(self, record: Record) -> int:
        """Where a trial's own coordinates begin."""
        return len(self.specimens) + len(self.materials) + 2 * self.trials.index(record.name)

    def of_load(self, load: str) -> int:
        """Where the error at a load stands that is not the first."""
        return len(self.names) - len(self.near) - len(self.loads) + self.loads.index(load)

    @cached_property
    def centre(self) -> Array:
        """Where all is as expected, the moduli at 1 Pa: nothing is expected of these."""
        u = np.zeros(len(self.names))
        first = len(self.specimens)
        u[first : first + len(self.materials)] = np.log(VISCOUS)
        u[len(u) - len(self.near) :] = SHARED
        return u

    @cached_property
    def prior(self) -> Array:
        """(k, n): rows of what is known beforehand, in its sd; they are of u less `centre`."""
        n, first = len(self.names), len(self.specimens)
        scatter = scatter_rows(self.owners)
        sds = np.concatenate([
            np.full(len(self.materials), VISCOUS_SD),
            np.tile([RELEASE_SD / RELEASE, START_SD / START], len(self.trials)),
            np.full(len(self.loads) - 1, LOAD_SD / LOAD),
            np.full(len(self.near), SHARED_SD),
        ])  # fmt: skip
        own = np.zeros((len(sds), n))
        own[:, first:] = np.diag(1.0 / sds)
        return np.vstack([np.column_stack([scatter, np.zeros((len(scatter), n - first))]), own])

    def off(self, u: Array) -> Array:
        """(k,): u against what is known beforehand."""
        return np.asarray(self.prior @ u - self._expected)

    @cached_property
    def _expected(self) -> Array:
        return np.asarray(self.prior @ self.centre)
