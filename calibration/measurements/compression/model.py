"""Measurement model of compression tests: cylinders of all materials together, with effects.

The baseline is a neo-Hookean cylinder between free platens, which stays homogeneous. Forces with bonded
platens are interpolated between finite element solutions (`_bonded.py`); effects of the material, the rig and
the record act as in homogeneous tests. In a fit over time the cylinder follows the course of each record, and
recovers freely after loss of contact with its platens.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import CouponMode, Experiment
from calibration.measurements._baseline import Baseline
from calibration.measurements._state import State
from calibration.measurements.compression._bonded import USUAL, BondedRatio
from calibration.measurements.compression._coordinates import Coordinates
from calibration.measurements.compression._effect import CompressionEffect
from calibration.measurements.compression._record import LAST, compared, is_compressed, pushed, up_to
from calibration.measurements.compression._repeatability import FIRST, TERMS, repeatability_of
from calibration.measurements.compression.curves import Cylinder
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._forward import Acting, Loading
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import slab_factor
from calibration.measurements.homogeneous.model import HomogeneousModel

Array = NDArray[np.float64]

COLUMNS = 16  # columns of a tilted cylinder
# Quadrature over chords of a disc: position from the edge that touches first (0) to the last (1), and weight
_ANGLES = np.pi * np.arange(1, COLUMNS + 1) / (COLUMNS + 1)
_POSITIONS = 0.5 * (1.0 - np.cos(_ANGLES))
_WEIGHTS = np.sin(_ANGLES) ** 2 / np.sum(np.sin(_ANGLES) ** 2)


class CompressionModel(HomogeneousModel):
    """Measurement model of compression tests.

    There is one shear modulus per specimen; trials of a material that name no specimen share one. Coupons in
    other modes are included as in `HomogeneousModel`.

    Parameters
    ----------
    experiment : experiment with coupons; other trials are ignored.
    effects : effects by name; see `calibration.diagnosis.effects.compression`.
    cylinder : dimensions of all compressed specimens, which the file format lacks; only diameter over height
        matters.
    last : strain up to which records of compression are compared, at most LAST.
    baseline : baseline in place of the neo-Hookean one.

    Raises
    ------
    InputError
        If there is no compressed coupon, or the cylinder is flatter than in the stored simulations.
    ValueError
        If `last` is out of range.
    """

    kind = "compression"
    laws: ClassVar[Sequence[tuple[str, int]]] = ()  # the form of a law and bonded platens look alike

    def __init__(
        self,
        experiment: Experiment,
        *,
        effects: Mapping[str, HomogeneousEffect] | None = None,
        cylinder: Cylinder | None = None,
        last: float = LAST,
        baseline: Baseline | None = None,
    ) -> None:
        if not 2.0 * FIRST < last <= LAST:
            raise ValueError(f"last: expected a strain of up to {LAST:g}, got {last:g}")
        self.last = last
        super().__init__(experiment, effects=effects, baseline=baseline)
        if not any(is_compressed(r) for r in self.records):
            raise InputError("experiment.yaml: trials: expected a uniaxial coupon in compression")
        self.stated = cylinder
        self.bonded = BondedRatio(cylinder=cylinder or USUAL)
        self.whole_range = tuple(self.records)
        self._measured_in([pushed(compared(r, last)) for r in self.records])
        self.repeatability = repeatability_of(self.records, last)
        self.coordinates = Coordinates.of(self.records, self.baseline, self.repeatability)
        self.baseline = self._base.baseline = self.coordinates.baseline
        self._set_candidates()

    def _selects(self, mode: CouponMode, stretch: Array) -> NDArray[np.bool_]:
        return up_to(self.last, mode, stretch)

    def _stresses_of(self, some: Sequence[int], state: State) -> list[Array]:
        found = []
        for k, p in zip(some, super()._stresses_of(some, state), strict=True):
            read = p * np.exp(self.coordinates.deviation(self.records[k], state.u))
            for e, a in self._effects_in(state, k):
                if isinstance(e, CompressionEffect) and e.reads is not None:
                    read = e.reads(read, a)
            found.append(read)
        return found

    def _depends_on(self, record: Record) -> NDArray[np.bool_]:
        return self.coordinates.constrained_by(record)

    def _loading(self, record: Record, state: State, acting: Acting) -> Loading:
        """Loading without effects of the load cell, and with the mesh error if platens bond or rub."""
        acting = [(e, a) for e, a in acting if not (isinstance(e, CompressionEffect) and e.reads)]
        found = super()._loading(record, state, acting)
        held = _amount(found, "bonds") or _amount(found, "rubs")
        return replace(found, further=self.coordinates.mesh(state.u)) if held else found

    def _at_own_stretches(self, loadings: Sequence[Loading], stretches: Sequence[Array]) -> list[Array]:
        """Stress over the shear modulus at the specimens' own stretches, with effects of the platens.

        A tilted cylinder is compressed as parallel columns, shape (COLUMNS, k). Platens push but do not pull.
        """
        level = []
        for x, s in zip(loadings, stretches, strict=True):
            gap = _amount(x, "tilts")
            met = s + gap * _POSITIONS[:, None] if gap else s
            # a column before contact carries no force; with a course, `balanced` treats loss of contact
            remembers = x.record.course is not None
            level.append(np.minimum(met, 1.0) if is_compressed(x.record) and not remembers else met)
        free = super()._at_own_stretches(loadings, level)
        held = [_amount(x, "bonds") or _amount(x, "rubs") for x in loadings]
        log_ratios = self._log_ratios(
            {k: x for k, x in enumerate(loadings) if held[k]}, {k: s for k, s in enumerate(level) if held[k]}
        )
        found = []
        for k, (x, s, p) in enumerate(zip(loadings, level, free, strict=True)):
            if held[k]:
                rubbed = self._rubbed(s, _amount(x, "rubs"), log_ratios[k])
                p = p * np.exp(_amount(x, "bonds") * log_ratios[k] + rubbed)
            found.append(_WEIGHTS @ p if p.ndim == 2 else p)
        return found

    def _log_ratios(
        self, loadings: Mapping[int, Loading], stretches: Mapping[int, Array]
    ) -> dict[int, Array]:
        """ln(bonded / free force) with the mesh error, shape of each stretch.

        Records of one law are evaluated together, since a call costs more than its points.
        """
        alike: dict[Hashable, list[int]] = {}
        for k, x in loadings.items():
            law = tuple((e.name, a) for e, a in x.acting)
            alike.setdefault((law, x.further.tobytes()), []).append(k)
        found: dict[int, Array] = {}
        for some in alike.values():
            first = loadings[some[0]]
            flat = np.concatenate([stretches[k].ravel() for k in some])
            own = self.bonded.log_ratio(flat, {e.name: a for e, a in first.acting})
            own = own + self.coordinates.mesh_error(1.0 - flat, first.further)
            parts = np.split(own, np.cumsum([stretches[k].size for k in some])[:-1])
            found.update({k: p.reshape(stretches[k].shape) for k, p in zip(some, parts, strict=True)})
        return found

    def _rubbed(self, stretch: Array, friction: float, bonded: Array) -> Array:
        """ln(force with friction / free force) for a coefficient of friction, shape of the stretch.

        bonded : ln(bonded / free force), the limit for large friction.
        """
        if friction == 0.0:
            return np.zeros(stretch.shape)
        slipping = np.log(slab_factor(friction * self.bonded.slender * np.maximum(stretch, 1e-3) ** -1.5))
        stuck = np.maximum(bonded, 1e-9)
        return np.asarray(-stuck * np.expm1(-slipping / stuck))

    def repeated(self) -> tuple[str, ...]:
        return self.repeatability.repeats

    def _cut(self) -> dict[str, float]:
        """Largest strain of each record of which a part is not compared."""
        reach = {r.name: float(1.0 - r.stretch.min()) for r in self.whole_range if is_compressed(r)}
        return {name: strain for name, strain in reach.items() if strain > self.last}

    def left_out(self) -> list[str]:
        return [
            *super().left_out(),
            *(
                f"{name}: its part beyond a strain of {self.last:g}, of {strain:.2g} measured: beyond"
                f" {LAST:g}, the simulation of bonded cylinders is not good enough"
                for name, strain in self._cut().items()
            ),
        ]

    def shortcomings(self) -> list[str]:
        pressed = min(float(r.stretch.min()) for r in self.records if is_compressed(r))
        held = float(np.exp(self.bonded.log_ratio(np.array([pressed]), {})[0]))
        return [
            *super().shortcomings(),
            f"platens are taken as free of friction; where they hold the ends of a cylinder of {self._size},"
            f" its force is {held:.2f} times as large at a strain of {1.0 - pressed:.2g}, and the modulus of"
            " this fit too large by up to as much: calibration.diagnose tests it (platen-bonding)",
        ]

    @property
    def _size(self) -> str:
        c = self.bonded.cylinder
        return f"{2e3 * c.radius:g} x {1e3 * c.height:g} mm"

    def remarks(self) -> list[str]:
        unstated = "" if self.stated else ", since the format does not say"
        found = [
            *super().remarks(),
            f"cylinders taken as {self._size} (diameter x height){unstated};"
            " only the quotient counts, and only where platens are bonded",
            "platens that are bonded in part are interpolated between free (0) and bonded ones (1), which are"
            " simulated, and up to 1.1, since the simulation has an error; Coulomb friction itself is not"
            " simulated",
        ]
        cut = self._cut()
        if cut:
            furthest = max(cut.values())
            found.append(
                f"compared up to a strain of {self.last:g} only, of {furthest:.2g} measured: beyond {LAST:g},"
                " the simulation of bonded cylinders is not good enough"
            )
        scatter = self.repeatability
        if scatter.repeats:
            known = ", ".join(f"{name} {100 * s:.2g} %" for name, s in zip(TERMS, scatter.sds, strict=True))
            found.append(
                f"{len(scatter.repeats)} repeats differ from each other smoothly ({known}): each record may"
                " deviate so much"
            )
            found += [
                f"{d.material}: from each test to the next the stress at a strain of {d.strain:.2g} changes"
                f" by {100.0 * d.per_test:+.2g} % (correlation with its number {d.correlation:.2f}), which"
                " is not counted as scatter"
                for d in scatter.drifts
            ]
        else:
            found.append(
                "too few repeats to estimate how much one test differs from the next: no such scatter is"
                " allowed"
            )
        return found

    def noise_sentence(self) -> str:
        known = (
            "a smooth deviation of each record as large as the repeats of the experiment show"
            if self.repeatability.repeats
            else "no scatter from test to test, since there are too few repeats"
        )
        return f"{super().noise_sentence()[:-1]}; {known}; 0.3 % of mesh error in what bonded platens add."


def _amount(loading: Loading, what: Literal["bonds", "rubs", "tilts"]) -> float:
    """Sum of the amplitudes [SI] of a record's effects that bond, rub or tilt."""
    own = [(e, a) for e, a in loading.acting if isinstance(e, CompressionEffect)]
    return sum((a for e, a in own if getattr(e, what)), 0.0)
