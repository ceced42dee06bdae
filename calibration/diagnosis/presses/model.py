"""Pressed cylinders of all materials together, with the catalogue's effects nested in their forces.

The baseline is a Neo-Hookean cylinder between free platens, which stays homogeneous; what the platens hold
comes from finite elements (`_held.py`), what the material, the rig and the record do as in coupons.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.coupons import CouponEffect, CouponModel
from calibration.diagnosis.coupons._candidates import candidates_of
from calibration.diagnosis.coupons._record import Record
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.nested import State
from calibration.diagnosis.presses._held import USUAL, Held
from calibration.diagnosis.presses._nuisances import PressBaseline
from calibration.diagnosis.presses._pressed import LAST, compared, holds_pressed, is_pressed
from calibration.diagnosis.presses._remarks import remarks_on
from calibration.diagnosis.presses._wobble import FIRST, wobble_of
from calibration.diagnosis.presses.effects import EFFECTS, PressEffect
from calibration.errors import InputError
from calibration.experiment.model import Experiment
from calibration.press import Cylinder

Array = NDArray[np.float64]

COLUMNS = 16  # of a tilted cylinder
REMEMBERED = 32
# Chords of a disc: where they lie, from the edge that touches first (0) to the last (1), and their share
_ANGLES = np.pi * np.arange(1, COLUMNS + 1) / (COLUMNS + 1)
_PLACES = 0.5 * (1.0 - np.cos(_ANGLES))
_SHARES = np.sin(_ANGLES) ** 2 / np.sum(np.sin(_ANGLES) ** 2)


class PressModel(CouponModel):
    """One shear modulus a specimen (trials that name none share one a material). Coupons of the experiment
    that are not pressed are seen beside those that are. See `calibration.diagnosis.nested.Nested`.

    cylinder: of all pressed trials, since the format does not hold it; only diameter over height counts.
    last: strain up to which pressed records are compared, at most LAST. without: effects left out of the
    catalogue. InputError where nothing is pressed, or the cylinder is
    flatter than what was simulated.
    """

    baseline: PressBaseline

    def __init__(
        self,
        experiment: Experiment,
        *,
        cylinder: Cylinder | None = None,
        last: float = LAST,
        without: Sequence[str] = (),
    ) -> None:
        if not 2.0 * FIRST < last <= LAST:
            raise ValueError(f"last: expected a strain of up to {LAST:g}, got {last:g}")
        if not holds_pressed(experiment):
            raise InputError("experiment.yaml: trials: expected a uniaxial coupon in compression")
        super().__init__(experiment, without=without)
        self.stated = cylinder
        self.last = last
        self.held = Held(cylinder=cylinder or USUAL)
        self.effects: Mapping[str, CouponEffect] = {n: e for n, e in EFFECTS.items() if n not in without}
        self.whole_range = tuple(self.records)
        self.records = [compared(r, last) for r in self.records]
        self.wobble = wobble_of(self.records, last)
        self.baseline = PressBaseline(self.records, self.wobble)
        self.names = self.baseline.names
        self.candidates = tuple(c for c in candidates_of(self.records, self.effects) if self._makes_sense(c))
        self._visible = {c: self._shown(c, self.records) for c in self.candidates}
        self._remembered: tuple[Sequence[Record], dict[object, list[Array]]] = (self.records, {})

    def _makes_sense(self, c: Candidate) -> bool:
        """One load cell reads all records; and repeats of one sample are pressed along one axis."""
        wherever = c.at == "all" or c.at in self.baseline.owners or c.at in self.baseline.specimens
        return {"force-gain": c.at == "all", "anisotropy": wherever}.get(c.effect, True)

    def stresses(self, state: State) -> list[Array]:
        found = []
        for r, p in zip(self.records, self._pressed_by(state), strict=True):
            read = p * np.exp(self.baseline.deviation(r, state.u))
            for e, a in self._own(state, r):
                if e.reads is not None:
                    read = e.reads(read, a)
            found.append(read)
        return found

    def unseen(self, group: object) -> NDArray[np.bool_]:
        return ~self.baseline.owned(self.part(group, others=True).records)

    def remarks(self) -> list[str]:
        return [
            *super().remarks(),
            *remarks_on(self.whole_range, self.last, self.stated, self.held, self.wobble),
        ]

    def _pressed_by(self, state: State) -> list[Array]:
        """Before repeats differ and load cells err; remembered, since most coordinates are of these."""
        if self._remembered[0] is not self.records:
            self._remembered = (self.records, {})
        known = self._remembered[1]
        key = (self.baseline.inner(state.u).tobytes(), tuple(state.amplitudes.items()))
        if key not in known:
            if len(known) >= REMEMBERED:
                known.pop(next(iter(known)))
            known[key] = super().stresses(state)
        return known[key]

    def _stresses_at(self, state: State, stretches: Sequence[Array]) -> list[Array]:
        gaps = [sum(a for e, a in self._own(state, r) if e.tilts) for r in self.records]
        if not any(gaps):
            return self._level(state, stretches)
        found = [np.zeros(s.size) for s in stretches]
        for place, share in zip(_PLACES, _SHARES, strict=True):
            # a column that the platen has not met yet carries nothing
            met = [s + g * place for s, g in zip(stretches, gaps, strict=True)]
            for whole, p in zip(found, self._level(state, met), strict=True):
                whole += share * p
        return found

    def _level(self, state: State, stretches: Sequence[Array]) -> list[Array]:
        """Between platens that are parallel. They push and do not pull."""
        found = []
        stretches = [
            np.minimum(s, 1.0) if is_pressed(r) else s for r, s in zip(self.records, stretches, strict=True)
        ]
        free = super()._stresses_at(state, stretches)
        for r, s, p in zip(self.records, stretches, free, strict=True):
            part = sum(a for e, a in self._own(state, r) if e.holds)
            if part:
                law = {e.name: a for e, a in self._acting(state, r)}
                log_ratio = self.held.log_ratio(s, law) + self.baseline.mesh_error(1.0 - s, state.u)
                p = p * np.exp(part * log_ratio)
            found.append(p)
        return found

    def _own(self, state: State, record: Record) -> list[tuple[PressEffect, float]]:
        """Effects in a record that coupons do not have."""
        return [(e, a) for e, a in self._acting(state, record) if isinstance(e, PressEffect)]
