"""Stress of homogeneous tests: the material's law, scaled by the modulus of each specimen, with effects."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import CouponMode
from calibration.measurements._baseline import Baseline
from calibration.measurements._memory import Memory
from calibration.measurements.homogeneous._curve import Curve
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._memory_stress import stresses_along
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.stress import nominal_stresses
from tisim import Material

Array = NDArray[np.float64]
Acting = Sequence[tuple[HomogeneousEffect, float]]  # effects in a record, with their amplitudes [SI]

REMEMBERED = 2048  # cached curves
STEPS = 30
TOLERANCE = 1e-10  # of the stress, relative to the larger of shear modulus and largest stress


@dataclass(frozen=True, eq=False, kw_only=True)
class Loading:
    """A record at a state, with all that its stress depends on.

    Attributes
    ----------
    record : the record.
    shear_modulus : small-strain shear modulus of its specimen [Pa].
    law : coordinates of its material's law, shape (n,).
    acting : effects in the record, with their amplitudes.
    further : other coordinates that the stress over the modulus depends on, shape (k,).
    """

    record: Record
    shear_modulus: float
    law: Array
    acting: Acting
    further: Array

    @cached_property
    def compliance(self) -> float:
        """Strain of the rig per unit of stress over shear modulus."""
        return self.shear_modulus * sum(e.yields * a for e, a in self.acting)

    @property
    def shifted(self) -> Array:
        """Stretches of the record with the shifts by effects, shape (k,)."""
        stretch = self.record.stretch.copy()
        for e, a in self.acting:
            if e.shift is not None:
                stretch = stretch + e.shift(self.record.stretch, a, self.record)
        return stretch

    @property
    def richer_fraction(self) -> float:
        """Fraction of the richer law in the stress: sum of the amplitudes of effects that use that law."""
        return sum(a for e, a in self.acting if e.richer)

    @property
    def key(self) -> Hashable:
        """Cache key of the stress over the shear modulus."""
        effects = tuple((e.name, e.form, a) for e, a in self.acting)
        return self.record, self.law.tobytes(), effects, self.compliance, self.further.tobytes()


class BaseStress:
    """Nominal stress of the baseline over the shear modulus, with a cache of curves.

    Parameters
    ----------
    baseline : baseline of the model (per specimen, or of a law).
    bulk_ratio : K/G of the curves if K/G is fixed.
    """

    def __init__(self, baseline: Baseline, *, bulk_ratio: float) -> None:
        self.baseline = baseline
        self._bulk_ratio = bulk_ratio
        self._memory: Memory[Hashable, Array] = Memory(REMEMBERED)
        self._drawn_curves: dict[CouponMode, Curve] = {}

    def over_modulus(self, loadings: Sequence[Loading], stretches: Sequence[Array]) -> list[Array]:
        """Stress over the shear modulus at these stretches, shape of each; NaN where the law has none."""

        def missing(some: Sequence[int]) -> list[Array]:
            found: dict[int, Array] = {}
            for law in {loadings[k].law.tobytes(): loadings[k].law for k in some}.values():
                mine = [k for k in some if np.array_equal(loadings[k].law, law)]
                curves = [(loadings[k].record, stretches[k]) for k in mine]
                found.update(zip(mine, self._curves(law, curves), strict=True))
            return [found[k] for k in some]

        remembers = bool(self.baseline.law.parts)
        keys = [
            (x.law.tobytes(), x.record if remembers else x.record.mode, s.tobytes())
            for x, s in zip(loadings, stretches, strict=True)
        ]
        return self._memory.fetch(keys, missing)

    def _curves(self, own: Array, curves: Sequence[tuple[Record, Array]]) -> list[Array]:
        """Stress over the shear modulus for law coordinates `own` (n,), at the stretches of each record."""
        law, bounds = self.baseline.law, self.baseline.law.bounds
        sound = bool(((own >= bounds[:, 0]) & (own <= bounds[:, 1])).all())
        if not sound or any(not (s > 0.0).all() for r, s in curves if r.mode != "simple-shear"):
            return [np.full(s.shape, np.nan) for _, s in curves]
        stiff = own.copy()
        for k, c in enumerate(law.coordinates):
            if c.name == "bulk_ratio" and (c.held or not self.baseline.whole):
                stiff[k] = np.log(self._bulk_ratio)
        try:
            material, shear_modulus = law.material(stiff), law.moduli(stiff).shear_modulus
        except ValueError:  # outside the law's domain
            return [np.full(s.shape, np.nan) for _, s in curves]
        with np.errstate(all="ignore"):
            if not (self.baseline.free or material.has_parts):
                # only the stretch varies: one curve per mode, for any number of points
                return [self._drawn(material, r.mode).at(s) / shear_modulus for r, s in curves]
            return [p / shear_modulus for p in predicted(material, curves)]

    def _drawn(self, material: Material, mode: CouponMode) -> Curve:
        if mode not in self._drawn_curves:
            self._drawn_curves[mode] = Curve(material, mode)
        return self._drawn_curves[mode]


def predicted(material: Material, curves: Sequence[tuple[Record, Array]]) -> list[Array]:
    """Nominal stress of each record at these stretches [Pa], shape of each, (k,) or (m, k).

    If the material has parts, it is integrated along the record's own course at constant volume. NaN where
    there is no solution. ValueError for a record without a course if the material has parts.
    """
    if not material.has_parts:
        return nominal_stresses(material, [(r.mode, s) for r, s in curves])
    tests = []
    for r, s in curves:
        if r.course is None:
            raise ValueError(f"record {r.name}: expected its course, for a material that remembers")
        tests += [(r.mode, r.course, r.course.moved(own - r.stretch)) for own in np.atleast_2d(s)]
    stresses = stresses_along(material, tests)
    means = iter([course.means(p) for (_, course, _), p in zip(tests, stresses, strict=True)])
    return [np.reshape([next(means) for _ in np.atleast_2d(s)], s.shape) for _, s in curves]


def blended(
    loadings: Sequence[Loading],
    stretches: Sequence[Array],
    base: BaseStress,
    rich: BaseStress | None,
) -> list[Array]:
    """(1 - a) times the baseline's stress over the modulus plus a times the richer law's (`rich`).

    a is the `richer_fraction` of each loading, which is 0 if the model has no richer law.
    """
    found = base.over_modulus(loadings, stretches)
    fractions = [x.richer_fraction for x in loadings]
    some = [k for k, a in enumerate(fractions) if a]
    if rich is None or not some:
        return found
    theirs = [replace(loadings[k], law=loadings[k].further) for k in some]
    for k, p in zip(some, rich.over_modulus(theirs, [stretches[k] for k in some]), strict=True):
        found[k] = (1.0 - fractions[k]) * found[k] + fractions[k] * p
    return found


def with_effects(loading: Loading, stretch: Array, stress: Array) -> Array:
    """Nominal stress over the shear modulus with the added stresses of effects, then with their factors."""
    with np.errstate(all="ignore"):  # a stretch out of range is NaN in the baseline already
        for e, a in loading.acting:
            if e.extra is not None:
                stress = stress + e.extra(stretch, a, loading.record)
        for e, a in loading.acting:
            if e.factor is not None:
                stress = stress * e.factor(stretch, a, loading.record)
    return stress


def yielding(
    stresses: Callable[[Sequence[int], Sequence[Array]], list[Array]],
    stretches: Sequence[Array],
    compliances: Sequence[float],
) -> list[Array]:
    """Stress p of each record with machine compliance: p = stress(stretch - compliance p), secant method.

    NaN for records without convergence. Records do not depend on each other.

    Parameters
    ----------
    stresses : function from indices of records and their specimens' own stretches to stresses.
    stretches : stretches of each record, shape (k,).
    compliances : compliance of each record.
    """
    found = stresses(range(len(stretches)), stretches)
    open_ = [k for k, c in enumerate(compliances) if c]
    before = {k: (np.zeros(stretches[k].size), -found[k]) for k in open_}  # stresses and their residuals
    for _ in range(STEPS):
        if not open_:
            break
        answers = stresses(open_, [stretches[k] - compliances[k] * found[k] for k in open_])
        unsettled = []
        for k, answer in zip(open_, answers, strict=True):
            p, left = found[k], found[k] - answer
            if not np.isfinite(left).all():
                found[k] = np.full(p.size, np.nan)
                continue
            if np.max(np.abs(left), initial=0.0) <= TOLERANCE * np.max(np.abs(p), initial=1.0):
                continue
            p_before, left_before = before[k]
            change = left - left_before
            step = -left * np.divide(p - p_before, change, out=np.zeros_like(p), where=change != 0.0)
            before[k] = p, left
            found[k] = p + step
            unsettled.append(k)
        open_ = unsettled
    for k in open_:
        found[k] = np.full(stretches[k].size, np.nan)
    return found
