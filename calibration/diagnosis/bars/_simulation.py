"""What markers show of bars that are as a state says: settings, swings, displacements in a record's rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._bar import carried, clamp_motion, swing
from calibration.diagnosis.bars._candidates import kind_of, reaches
from calibration.diagnosis.bars._coordinates import Coordinates, Own
from calibration.diagnosis.bars._fem import Correction
from calibration.diagnosis.bars._record import LAST, Record
from calibration.diagnosis.bars._setting import Setting
from calibration.diagnosis.bars.effects import BarEffect
from calibration.diagnosis.bars.experiments import as_it_is
from calibration.diagnosis.nested import State

Array = NDArray[np.float64]

SLIPPED = 0.4  # periods by which a swing may get out of step until its end; further out, the way back is lost
REMEMBERED = 400


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulation:
    """fixes: of each record, by FEM. reference [s]: of all settings. pose: what is done to each setting,
    effects in it; with another than the records' own a swing may be out of step with them."""

    records: Sequence[Record]
    coordinates: Coordinates
    effects: Mapping[str, BarEffect]
    fixes: Sequence[Correction]
    reference: float
    pose: Callable[[Setting], Setting] = as_it_is
    _seen: dict[object, Array] = field(default_factory=dict, init=False, repr=False)

    def predicted(self, state: State) -> list[Array]:
        """Rows of each record [m], without nuisances. ValueError where a bar has no equilibrium."""
        return [self.rows(k, self.setting(k, state), self.own(k, state)) for k in range(len(self.records))]

    def setting(self, k: int, state: State) -> Setting:
        """Of a record's bar, with the state's effects in it."""
        r = self.records[k]
        found = replace(
            r.setting,
            shear=self.coordinates.shear(r, state.u),
            viscous=self.coordinates.viscous(r, state.u),
            stiff_root=self.fixes[k].stiff_root,
            reference=self.reference,
            inertia=self.fixes[k].inertia,
        )
        for c, a in state.amplitudes.items():
            effect = self.effects[c.effect]
            if a != 0.0 and reaches(c, r, effect):
                found = effect.alter(found, a, kind_of(c))
        return self.pose(found)

    def own(self, k: int, state: State) -> Own:
        return self.coordinates.own(self.records[k], state.u)

    def rows(self, k: int, setting: Setting, own: Own) -> Array:
        """Of a record [m]; remembered, since most coordinates are of other records."""
        key = (k, setting, own)
        if key not in self._seen:
            if len(self._seen) >= REMEMBERED:
                self._seen.pop(next(iter(self._seen)))
            r = self.records[k]
            moved = self._moved(k, setting, own, r.time - own[0])
            self._seen[key] = r.flat(lambda i: moved[i], np.zeros((len(r.places), 2)))
        return self._seen[key]

    def tip_height(self, k: int, state: State, time: Array) -> Array:
        """Mean height (t,) [m] of a record's outer markers, `time` after the first guess of its release."""
        r = self.records[k]
        since = time + r.released - self.own(k, state)[0]
        moved = self._moved(k, self.setting(k, state), self.own(k, state), since)
        return np.asarray(moved[r.tips, :, 1].mean(axis=0))

    def _moved(self, k: int, setting: Setting, own: Own, since: Array) -> Array:
        """Displacement of a record's markers (m, t, 2) [m], at times since the release by the lab's clock."""
        r, fix = self.records[k], self.fixes[k]
        _, start, share = own
        time = since * (1.0 + setting.clock)
        solved = swing(setting, start=start)
        q = solved.coordinates(time)
        moved = carried(setting, q, r.places).displacement
        drop = -moved[r.tips, :, 1].mean(axis=0)
        moved = moved + fix.left[:, None, :] * (drop / fix.drop)[None, :, None]
        if r.near.any():
            clamped = clamp_motion(setting, q, r.places).displacement
            part = np.where(r.inside, 1.0, share)[:, None, None]
            moved[r.near] += (part * (clamped - moved))[r.near]
        moved = moved * (time > 0.0)[None, :, None]
        slip = abs(solved.frequencies[0] * (1.0 + setting.clock) * r.period - 1.0) * LAST
        if self.pose is as_it_is and slip > SLIPPED:
            raise ValueError("the swing loses step with the measured one")
        c, s = (1.0 + setting.scale) * np.array([np.cos(setting.roll), np.sin(setting.roll)])
        return np.stack([c * moved[..., 0] - s * moved[..., 1], s * moved[..., 0] + c * moved[..., 1]], -1)
