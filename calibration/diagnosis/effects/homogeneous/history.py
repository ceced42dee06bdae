"""Effects in homogeneous material tests: dependence on time and loading history."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._identifiable import different_rates, loads_again, unloads
from calibration.diagnosis.effects._material_parts import (
    one_time,
    softening_of,
    viscosity_of,
)
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import first_excess, stress_of

Array = NDArray[np.float64]

# -- rate-dependence --
# Rate stiffening: the stress is a power of the strain rate that increases by a factor of e^amplitude per
# decade, relative to that at 0.01 1/s.


REFERENCE_RATE = 0.01  # strain rate at which the shear modulus holds [1/s]


def _factor_rate_dependence(s: Array, amplitude: float, record: Record) -> Array:
    del s
    decades = np.log10(record.rate / REFERENCE_RATE)
    return np.exp(amplitude * np.where(np.isfinite(decades), decades, 0.0))


def _identifiable_rate_dependence(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if a material is tested at two different rates."""
    del everything
    return different_rates(reached, lambda r: r.rate)


SHOWN = 0.1  # shortest resolved relaxation time, relative to the duration of a ramp


def _viscosity_rate_dependence(found: Occurrence) -> HandedOn:
    """Prony series of a relaxation function that is linear in the logarithm of time.

    Its height and slope are fitted (least squares) such that hereditary integrals over the records' strain
    histories reproduce the stress of the effect. The slope differs from the amplitude, since the stress in a
    ramp depends on the whole ramp.
    """
    records: list[Record] = [r for r in found.records if np.isfinite(r.rate).any()]
    last = max(float(np.ptp(r.time)) for r in records)
    first = min(SHOWN * min(float(np.ptp(r.stretch) / np.nanmax(r.rate)) for r in records), 0.5 * last)

    def decades(t: Array) -> Array:
        return np.asarray(np.log10(np.clip(t, first, last) / first))

    columns, wanted = [], []
    for r in records:
        elastic = stress_of(r.mode, r.stretch, 0.5)
        begun = np.r_[2.0 * r.time[0] - r.time[1], r.time[:-1]]
        since = r.time[:, None] - 0.5 * (r.time + begun)[None, :]
        remembered = np.where(since > 0.0, decades(since), 0.0) @ np.diff(elastic, prepend=0.0)
        used = np.isfinite(r.rate)
        weight = (1.0 / r.sd)[used]
        columns.append(weight[:, None] * np.column_stack([elastic, remembered])[used])
        wanted.append(weight * (elastic * _factor_rate_dependence(r.stretch, found.amplitude, r))[used])
    height, slope = np.linalg.lstsq(np.concatenate(columns), np.concatenate(wanted), rcond=None)[0]
    return viscosity_of(lambda t: height + slope * decades(t), first=first, last=last)


RATE_DEPENDENCE = HomogeneousEffect(
    effect=catalogue.RATE_DEPENDENCE,
    step=1e-3,
    bounds=(0.0, 3.0),
    start_fraction=0.1,
    prior_scale=0.15,
    factor=_factor_rate_dependence,
    identifiable=_identifiable_rate_dependence,
    hands_on=_viscosity_rate_dependence,
)


# -- hysteresis --
# Hysteresis: in unloading the stress is lower than in loading, by this fraction when the specimen is fully
# unloaded.


def _factor_hysteresis(s: Array, amplitude: float, record: Record) -> Array:
    del s
    back = np.clip(1.0 - first_excess(record.mode, record.stretch) / record.turn, 0.0, 1.0)
    return 1.0 - amplitude * np.where(np.isfinite(back), back, 0.0)


def _largest_energy(found: Occurrence) -> float:
    """Largest energy density in the records for a neo-Hookean solid [J/m3]."""
    return 0.5 * found.shear_modulus * max(float(r.peak.max()) for r in found.records)


def _softening_hysteresis(found: Occurrence) -> HandedOn:
    return softening_of(
        lambda ratio: found.amplitude * (1.0 - ratio),
        energy=_largest_energy(found),
        remarks=(
            "hysteresis is handed on as softening: a loading after the unloading goes back the unloading's"
            " way",
        ),
    )


HYSTERESIS = HomogeneousEffect(
    effect=catalogue.HYSTERESIS,
    step=1e-3,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),  # the stress vanishes at full unloading
    prior_scale=0.5,
    factor=_factor_hysteresis,
    identifiable=unloads,
    hands_on=_softening_hysteresis,
)


# -- mullins --
# Mullins effect: in reloading the material is softer below the largest strain so far, by this fraction at
# zero strain and not at all at the largest strain. Pseudo-elastic softening of Ogden and Roxburgh, Proc. R.
# Soc. Lond. A 455 (1999): 1 - erf((W_m - W) / m) / r, where W_m is the largest energy so far, here of a
# neo-Hookean solid, and m = W_m, so that the amplitude is erf(1) / r. A single record rarely determines m, on
# which the amplitude depends weakly.


def _factor_mullins(s: Array, amplitude: float, record: Record) -> Array:
    del s
    if not record.reloaded:
        return np.ones(record.points)
    with np.errstate(invalid="ignore", divide="ignore"):
        below = 1.0 - first_excess(record.mode, record.stretch) / record.peak
    left = np.where(np.isfinite(below), np.clip(below, 0.0, 1.0), 0.0)
    return 1.0 - amplitude * erf(left) / erf(1.0)


def _softening_mullins(found: Occurrence) -> HandedOn:
    return softening_of(
        lambda ratio: found.amplitude * erf(1.0 - ratio) / erf(1.0), energy=_largest_energy(found)
    )


MULLINS = HomogeneousEffect(
    effect=catalogue.MULLINS,
    step=1e-3,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),  # the stiffness vanishes at zero strain
    prior_scale=0.5,
    factor=_factor_mullins,
    identifiable=loads_again,
    hands_on=_softening_mullins,
)


# -- permanent-set --
# Permanent set: after the first reversal the elastic stretch is s + a / (1 - a) (s - s_max), so that the
# specimen keeps the part a of its largest strain when it is unloaded.


def _shift_permanent_set(s: Array, amplitude: float, record: Record) -> Array:
    del s
    gone = first_excess(record.mode, record.stretch)
    new = np.where(gone >= np.maximum.accumulate(gone), np.arange(gone.size), 0)
    furthest = record.stretch[np.maximum.accumulate(new)]
    turned = np.maximum.accumulate(np.isfinite(record.turn))
    return np.asarray(np.where(turned, amplitude / (1.0 - amplitude) * (record.stretch - furthest), 0.0))


PERMANENT_SET = HomogeneousEffect(
    effect=catalogue.PERMANENT_SET,
    step=1e-4,
    bounds=(0.0, 0.5),
    prior_scale=0.05,
    shift=_shift_permanent_set,
    identifiable=unloads,
    further=True,
)


# -- relaxation --
# Relaxation with one time constant: this fraction of the instantaneous modulus relaxes. Linear
# viscoelasticity (Boltzmann superposition) is applied to the neo-Hookean stress over the record's history;
# the baseline's shear modulus is the instantaneous one.


def _extra_relaxation(s: Array, amplitude: float, record: Record, time: float) -> Array:
    elastic = stress_of(record.mode, s, 0.5)
    steps = np.diff(record.time, prepend=record.time[0])
    kept = np.exp(-steps / time)
    # the elastic stress is linear in time within a step
    gained = np.where(steps > 0.0, -np.expm1(-steps / time) * time / np.where(steps > 0.0, steps, 1.0), 1.0)
    remembered = elastic.copy()
    for k in range(1, elastic.shape[-1]):
        rise = elastic[..., k] - elastic[..., k - 1]
        remembered[..., k] = kept[k] * remembered[..., k - 1] + gained[k] * rise
    return np.asarray(-amplitude * (elastic - remembered))


def _times_of(records: Sequence[Record]) -> tuple[float | None, ...]:
    """Relaxation times, one per decade, from about a hundredth of the longest record to its duration."""
    longest = max((float(np.ptp(r.time)) for r in records if np.isfinite(r.time).all()), default=0.0)
    if longest <= 0.0:
        return (1.0,)
    top = int(np.round(np.log10(longest)))
    return tuple(10.0**k for k in range(top - 2, top + 1))


def _viscosity_relaxation(found: Occurrence) -> HandedOn:
    assert found.variant is not None
    first = min(float(np.ptp(r.time)) / r.points for r in found.records)
    last = max(float(np.ptp(r.time)) for r in found.records)
    return one_time(found.amplitude, found.variant, first=first, last=last)


RELAXATION = HomogeneousEffect(
    effect=catalogue.RELAXATION,
    step=1e-3,
    bounds=(0.0, 1.0),
    prior_scale=0.3,
    extra_of=lambda time: lambda s, amplitude, record: _extra_relaxation(s, amplitude, record, time),
    applies_to=lambda record: bool(np.isfinite(record.time).all()),
    identifiable=_identifiable_rate_dependence,
    variants=_times_of,
    variant_label=lambda time: f"relaxation time {time:g} s",
    hands_on=_viscosity_relaxation,
    further=True,
)
