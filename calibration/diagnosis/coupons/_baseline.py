"""The baseline's stress: a law per material, scaled by the shear modulus of each specimen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.coupons import nominal_stresses
from calibration.diagnosis.coupons._kinematics import stress_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.specimens import scatter_rows
from calibration.experiment.model import CouponMode
from calibration.parameters import parametrisation
from tisim import Material

Array = NDArray[np.float64]

REFERENCE = 1e5  # of a law's first modulus, from which its stress is scaled [Pa]
# K/G of solid rubbers is above 1000 (K some GPa, G below 1 MPa). At 3000 a stress is the incompressible one
# to 0.1 %; it is not fitted, since a law that misfits would use it to mend its curve.
BULK_RATIO = 3000.0
REMEMBERED = 64


class Baseline:
    """Coordinates u: ln(G / 1 Pa) of each specimen (trials that name none share one a material), then
    the law's other coordinates of each material, as `calibration.parameters` has them, without bulk_ratio.

    names (n,), prior rows (k, n) and their centres (k,): specimens of one material lie together (the first
    `held` rows), and the law's coordinates have the priors that they have in a fit.
    """

    def __init__(self, records: Sequence[Record], law: str, terms: int = 1) -> None:
        self.law = parametrisation(law, terms=terms)
        first = self.law.coordinates[0]
        if not (first.log and first.start is None):
            raise ValueError(f"{law}: expected a law whose first coordinate is a modulus")
        self.specimens = tuple(dict.fromkeys(r.specimen for r in records))
        owner = {r.specimen: r.material for r in records}
        self.owners = tuple(owner[s] for s in self.specimens)
        self.materials = tuple(dict.fromkeys(self.owners))
        self.free = tuple(k for k, c in enumerate(self.law.coordinates) if k > 0 and c.name != "bulk_ratio")
        shape = [self.law.coordinates[k].name for k in self.free]
        self.names = self.specimens + tuple(f"{m} {name}" for m in self.materials for name in shape)
        self.prior, self.centre = self._priors()
        self._seen: dict[object, list[Array]] = {}

    def start(self, records: Sequence[Record]) -> Array:
        """Moduli of the incompressible Neo-Hookean curves nearest to the records; the law's other coordinates
        at their start. ValueError where a specimen pulls back against its stretch."""
        u = []
        for name in self.specimens:
            top = bottom = 0.0
            for r in records:
                if r.specimen == name:
                    unit = stress_of(r.mode, r.stretch, 0.5) / r.sd
                    top += float(unit @ (r.stress / r.sd))
                    bottom += float(unit @ unit)
            if top <= 0.0:
                raise ValueError(
                    f"specimen {name}: its stress falls with its stretch, no shear modulus gives that"
                )
            u.append(np.log(top / bottom))
        shape = self.law.start(shear=REFERENCE)[list(self.free)]
        return np.concatenate([u, *(shape for _ in self.materials)])

    def shear(self, record: Record, u: Array) -> float:
        """[Pa]."""
        return float(np.exp(u[self.specimens.index(record.specimen)]))

    def law_coordinates(self, material: str, u: Array) -> Array:
        """Coordinates of `law` of a material, its first modulus at REFERENCE."""
        found = self.law.start(shear=REFERENCE)
        found[0] = np.log(REFERENCE)
        begin = len(self.specimens) + len(self.free) * self.materials.index(material)
        found[list(self.free)] = u[begin : begin + len(self.free)]
        return found

    def stresses(self, records: Sequence[Record], stretches: Sequence[Array], u: Array) -> list[Array]:
        """Nominal stress [Pa] of each record at these stretches; NaN where the law has none."""
        found: list[Array] = [np.zeros(0)] * len(records)
        for material in self.materials:
            mine = [k for k, r in enumerate(records) if r.material == material]
            if not mine:
                continue
            own = self.law_coordinates(material, u)
            curves = [(records[k].mode, np.asarray(stretches[k])) for k in mine]
            key = (own.tobytes(), tuple((mode, s.tobytes()) for mode, s in curves))
            if key not in self._seen:
                if len(self._seen) >= REMEMBERED:
                    self._seen.pop(next(iter(self._seen)))
                self._seen[key] = self._unit(own, curves)
            for k, unit in zip(mine, self._seen[key], strict=True):
                found[k] = self.shear(records[k], u) * unit
        return found

    def material(self, name: str, u: Array, *, shear: float, density: float = 1000.0) -> Material:
        """The law with a small-strain shear modulus [Pa]; K/G is what a fit begins with."""
        own = self.law_coordinates(name, u)
        moduli = np.array([c.start is None for c in self.law.coordinates])
        scale = np.log(shear / self.law.moduli(own).shear)
        return self.law.material(own + np.where(moduli, scale, 0.0), density=density)

    def _unit(self, own: Array, curves: Sequence[tuple[CouponMode, Array]]) -> list[Array]:
        """Stresses over the small-strain shear modulus."""
        bounds = self.law.bounds
        sound = bool(((own >= bounds[:, 0]) & (own <= bounds[:, 1])).all())
        if not sound or any(not (s > 0.0).all() for m, s in curves if m != "simple-shear"):
            return [np.full(s.size, np.nan) for _, s in curves]
        stiff = own.copy()
        for k, c in enumerate(self.law.coordinates):
            if c.name == "bulk_ratio":
                stiff[k] = np.log(BULK_RATIO)
        shear = self.law.moduli(stiff).shear
        with np.errstate(all="ignore"):
            return [p / shear for p in nominal_stresses(self.law.material(stiff), curves)]

    def _priors(self) -> tuple[Array, Array]:
        held = scatter_rows(self.owners)
        self.held = len(held)
        rows = list(np.pad(held, ((0, 0), (0, len(self.names) - held.shape[1]))))
        centres = [0.0] * len(rows)
        for n in range(len(self.materials)):
            for j, k in enumerate(self.free):
                prior = self.law.coordinates[k].prior
                if prior is not None:
                    row = np.zeros(len(self.names))
                    row[len(self.specimens) + n * len(self.free) + j] = 1.0 / prior[1]
                    rows.append(row)
                    centres.append(prior[0] / prior[1])
        return np.array(rows).reshape(len(rows), len(self.names)), np.array(centres)
