"""How effects act on homogeneous material tests: what depends on time, or on what was before."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from calibration.diagnosis import catalogue
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
# The material is stiffer when it is strained faster: its stress is a power of the rate, which grows by this
# part a decade at 0.01 per second.


REFERENCE_RATE = 0.01  # [1/s]: the shear modulus is that of this rate

DISTINCT_RATES = 1.5  # quotient of two rates from which they differ


def _factor_rate_dependence(s: Array, amplitude: float, record: Record) -> Array:
    del s
    decades = np.log10(record.rate / REFERENCE_RATE)
    return np.exp(amplitude * np.where(np.isfinite(decades), decades, 0.0))


def _identifiable_rate_dependence(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Two rates in one material."""
    del everything
    for material in {r.material for r in reached}:
        rates = np.concatenate([r.rate for r in reached if r.material == material])
        rates = rates[np.isfinite(rates)]
        if rates.size and rates.max() > DISTINCT_RATES * rates.min():
            return True
    return False


SHOWN = 0.1  # of a ramp's time: what relaxes faster has relaxed all along it


def _viscosity_rate_dependence(found: Occurrence) -> HandedOn:
    """A relaxation function that falls evenly in the logarithm of time, at the height and with the slope at
    which the records, each along its own course, come nearest to the stress that the effect gives them: a
    ramp remembers its beginning, so that the slope is not quite the amplitude."""
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
# On the way back the stress lies below that of the way out: by this part once all energy is given back.


def _factor_hysteresis(s: Array, amplitude: float, record: Record) -> Array:
    del s
    back = np.clip(1.0 - first_excess(record.mode, record.stretch) / record.turn, 0.0, 1.0)
    return 1.0 - amplitude * np.where(np.isfinite(back), back, 0.0)


def _identifiable_hysteresis(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some unloading."""
    del everything
    return any(r.unloads for r in reached)


def _largest_energy(found: Occurrence) -> float:
    """Of a neo-Hookean solid in the records [J/m3]."""
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
    physical_limits=(1.0,),  # nothing is given back
    prior_scale=0.5,
    factor=_factor_hysteresis,
    identifiable=_identifiable_hysteresis,
    hands_on=_softening_hysteresis,
)


# -- mullins --
# Once strained, the material is softer below the largest strain that it has seen: by this part at rest, by
# nothing at that strain. The pseudo-elastic softening of Ogden and Roxburgh, Proc. R. Soc. Lond. A 455
# (1999): 1 - erf((W_m - W) / m) / r with W_m the largest energy so far, here of a Neo-Hookean solid, and
# with m = W_m, so that the amplitude is erf(1) / r. One record seldom tells m, by which the amplitude
# changes a little.


def _factor_mullins(s: Array, amplitude: float, record: Record) -> Array:
    del s
    if not record.reloaded:
        return np.ones(record.points)
    with np.errstate(invalid="ignore", divide="ignore"):
        below = 1.0 - first_excess(record.mode, record.stretch) / record.peak
    left = np.where(np.isfinite(below), np.clip(below, 0.0, 1.0), 0.0)
    return 1.0 - amplitude * erf(left) / erf(1.0)


def _identifiable_mullins(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some second loading."""
    del everything
    return any(r.reloaded for r in reached)


def _softening_mullins(found: Occurrence) -> HandedOn:
    return softening_of(
        lambda ratio: found.amplitude * erf(1.0 - ratio) / erf(1.0), energy=_largest_energy(found)
    )


MULLINS = HomogeneousEffect(
    effect=catalogue.MULLINS,
    step=1e-3,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),  # softened to nothing at rest
    prior_scale=0.5,
    factor=_factor_mullins,
    identifiable=_identifiable_mullins,
    hands_on=_softening_mullins,
)


# -- permanent-set --
# Having been strained, the material keeps this part of its largest strain: unloaded it comes to rest there.


def _shift_permanent_set(s: Array, amplitude: float, record: Record) -> Array:
    del s
    gone = first_excess(record.mode, record.stretch)
    new = np.where(gone >= np.maximum.accumulate(gone), np.arange(gone.size), 0)
    furthest = record.stretch[np.maximum.accumulate(new)]
    turned = np.maximum.accumulate(np.isfinite(record.turn))
    return np.asarray(np.where(turned, amplitude * (record.stretch - furthest), 0.0))


PERMANENT_SET = HomogeneousEffect(
    effect=catalogue.PERMANENT_SET,
    step=1e-4,
    bounds=(0.0, 0.5),
    prior_scale=0.05,
    shift=_shift_permanent_set,
    identifiable=_identifiable_hysteresis,
    further=True,
)


# -- relaxation --
# The stress relaxes with one time: of the modulus before it does, this fraction goes with it. Over the course
# of the record, as a linear solid remembers the stress of the neo-Hookean one (Boltzmann's superposition);
# the shear modulus of the baseline is that of a quick strain.


def _extra_relaxation(s: Array, amplitude: float, record: Record, time: float) -> Array:
    elastic = stress_of(record.mode, s, 0.5)
    steps = np.diff(record.time, prepend=record.time[0])
    kept = np.exp(-steps / time)
    # over a step the elastic stress is a straight line in time
    gained = np.where(steps > 0.0, -np.expm1(-steps / time) * time / np.where(steps > 0.0, steps, 1.0), 1.0)
    remembered = elastic.copy()
    for k in range(1, elastic.shape[-1]):
        rise = elastic[..., k] - elastic[..., k - 1]
        remembered[..., k] = kept[k] * remembered[..., k - 1] + gained[k] * rise
    return np.asarray(-amplitude * (elastic - remembered))


def _times_of(records: Sequence[Record]) -> tuple[float | None, ...]:
    """One a decade, from a hundredth of the longest record to its length."""
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
