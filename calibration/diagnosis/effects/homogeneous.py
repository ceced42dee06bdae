"""How each effect acts on homogeneous material tests: on the stretch, or on the stress."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import (
    eight_chain,
    fibres_along_the_load,
    mooney_rivlin,
    one_time,
    softening_of,
    stiffening,
    viscosity_of,
)
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import first_excess, slab_factor, stress_of

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


# -- anisotropy --
# The material is stiffer along the direction that is pulled: W gets a term G k/8 (I4 - 1)^2, I4 the squared
# stretch of that direction. The amplitude k is the excess of stress there, in shear moduli a unit of
# strain.


def _extra_anisotropy(s: Array, amplitude: float, record: Record) -> Array:
    if record.mode == "simple-shear":
        return np.zeros(s.size)
    # equibiaxial: the stress is the mean over two directions, of which one has it
    axes = 2.0 if record.mode == "equibiaxial" else 1.0
    return np.asarray(0.5 * amplitude * s * (s**2 - 1.0) / axes)


def _identifiable_anisotropy(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Two modes of a material, or a specimen of the same mode to compare with that was not cut alike. Fibres
    in the one specimen of a mode, and none in those of other modes, are no anisotropy of the material."""
    for material in {r.material for r in reached}:
        mine = [r for r in reached if r.material == material]
        others = [r for r in everything if r.material == material and r not in mine]
        modes = {r.mode for r in mine}
        if len(modes) > 1 or any(r.mode in modes for r in others):
            return True
    return False


def _compared(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some other record of the same material."""
    return any(r.material == q.material and r not in reached for q in reached for r in everything)


def _fibres_anisotropy(found: Occurrence) -> HandedOn:
    return fibres_along_the_load(0.25 * found.shear_modulus * found.amplitude)


ANISOTROPY = HomogeneousEffect(
    effect=catalogue.ANISOTROPY,
    step=1e-3,
    bounds=(-1.5, 6.0),
    prior_scale=0.6,
    extra=_extra_anisotropy,
    identifiable=_identifiable_anisotropy,
    hands_on=_fibres_anisotropy,
    scopes=("material", "specimen", "trial"),
)


# -- strain-offset --
# The zero of the strain is off: the specimen was slack, or preloaded, when its stretch was called 1.


def _shift_strain_offset(s: Array, amplitude: float, record: Record) -> Array:
    del record
    return np.full(s.size, amplitude)


STRAIN_OFFSET = HomogeneousEffect(
    effect=catalogue.STRAIN_OFFSET,
    step=1e-4,
    bounds=(-0.1, 0.1),
    prior_scale=0.03,
    shift=_shift_strain_offset,
    scopes=("mode", "trial"),
)


# -- machine-compliance --
# The rig gives way: part of the stretch that is written down is its own, in proportion to the stress. A stiff
# frame gives way by 0.001 to 0.02 strains/MPa; one that takes MOST_OF_RIG of the specimen's length at the
# largest stress would be seen to.


MOST_OF_RIG = 0.25


def _bounds_machine_compliance(records: Sequence[Record]) -> tuple[float, float]:
    largest = min(float(np.abs(r.stress).max()) for r in records)
    return 0.0, MOST_OF_RIG / largest


MACHINE_COMPLIANCE = HomogeneousEffect(
    effect=catalogue.MACHINE_COMPLIANCE,
    step=1e-9,
    bounds=(0.0, 1e-5),
    prior_scale=2e-8,
    bounds_in=_bounds_machine_compliance,
    yields=1.0,
    scopes=("mode", "trial"),
)


# -- platen-friction --
# Platens hold a compressed cylinder by friction (slab method: the pressure grows exponentially inwards):
# its stress is 2 (e^x - 1 - x) / x^2 times higher with x = 3 a s^(-3/2), where a is the coefficient of
# friction times diameter over three times the height at rest, and s the stretch. For small a that is 1 + a
# s^(-3/2).


PRESSED = 0.97  # stretch below which platens press


def _factor_platen_friction(s: Array, amplitude: float, record: Record) -> Array:
    del record
    whole = slab_factor(3.0 * amplitude * np.maximum(s, 1e-3) ** -1.5)
    return np.where(s < 1.0, whole, 1.0)


PLATEN_FRICTION = HomogeneousEffect(
    effect=catalogue.PLATEN_FRICTION,
    step=1e-3,
    bounds=(0.0, 1.0),
    prior_scale=0.2,
    factor=_factor_platen_friction,
    applies_to=lambda record: record.mode == "uniaxial" and bool(record.stretch.min() < PRESSED),
    scopes=("mode", "trial"),
)


# -- strain-stiffening --
# The material stiffens with strain: W gets a term G/2 a (I1 - 3)^2 beside the baseline's (Yeoh's law in
# `tisim`, which refuses a < 0: its energy would have no least value).


def _extra_strain_stiffening(s: Array, amplitude: float, record: Record) -> Array:
    return stress_of(record.mode, s, amplitude * first_excess(record.mode, s))


STRAIN_STIFFENING = HomogeneousEffect(
    effect=catalogue.STRAIN_STIFFENING,
    step=1e-3,
    bounds=(0.0, 4.0),
    prior_scale=0.5,
    extra=_extra_strain_stiffening,
    action="pull to larger strain",
    hands_on=stiffening,
)


# -- second-invariant --
# The energy depends on the second invariant too (Mooney-Rivlin): the share C01 / (C10 + C01).


def _extra_second_invariant(s: Array, amplitude: float, record: Record) -> Array:
    return stress_of(record.mode, s, -0.5 * amplitude, 0.5 * amplitude)


SECOND_INVARIANT = HomogeneousEffect(
    effect=catalogue.SECOND_INVARIANT,
    step=1e-3,
    bounds=(-0.5, 1.5),
    prior_scale=0.3,
    extra=_extra_second_invariant,
    hands_on=mooney_rivlin,
)


# -- limited-extensibility --
# Chains run out of length (eight Langevin chains: Arruda and Boyce, J. Mech. Phys. Solids 41, 1993;
# `tisim`'s law `eight-chain`): the amplitude is one over the squared locking stretch; the small-strain
# modulus stays.
#
# Past ENDS of the chains' length the force goes on in a straight line, as in that law: a search may step
# there.


LONGEST_CHAIN = 0.995

_NEWTON_STEPS = 5  # of Newton's method, from a Pade form that is right to 5 %

_SHORT_CHAIN = 1e-4  # part of its length up to which a chain is Gaussian to rounding errors


def _stiffening(x: Array) -> Array:
    """Force of a chain at the part x of its length, over that of a Gaussian one (1 for short ones): the
    inverse Langevin function over 3 x."""
    inside = np.clip(x, _SHORT_CHAIN, LONGEST_CHAIN)
    b = inside * (3.0 - inside**2) / (1.0 - inside**2)
    for _ in range(_NEWTON_STEPS):
        value, slope = _langevin(b)
        b = b - (value - inside) / slope
    past = np.maximum(x - LONGEST_CHAIN, 0.0) / _langevin(b)[1]
    return np.asarray((b + past) / (3.0 * np.maximum(x, _SHORT_CHAIN)))


def _langevin(b: Array) -> tuple[Array, Array]:
    """coth b - 1/b, and its slope."""
    e = np.exp(-2.0 * b)
    return (1.0 + e) / (1.0 - e) - 1.0 / b, 1.0 / b**2 - 4.0 * e / (1.0 - e) ** 2


def _extra_limited_extensibility(s: Array, amplitude: float, record: Record) -> Array:
    i1 = first_excess(record.mode, s) + 3.0
    part = _stiffening(np.sqrt(amplitude * i1 / 3.0)) / _stiffening(np.sqrt(np.array([amplitude])))
    return stress_of(record.mode, s, 0.5 * (part - 1.0))


LIMITED_EXTENSIBILITY = HomogeneousEffect(
    effect=catalogue.LIMITED_EXTENSIBILITY,
    step=1e-3,
    bounds=(0.0, 1.0),
    prior_scale=0.5,
    extra=_extra_limited_extensibility,
    hands_on=eight_chain,
)


# -- law-form --
# Another law than the baseline's describes the material: the energy is (1 - a) W + a W', of one small-strain
# modulus, and W' alone where it is named. Constants of W' are coordinates of the fit beside it. W' is the law
# that predicts best what its fit has not seen (`calibration.diagnosis.laws`).


def _several_modes(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Each material in two modes of loading, of which pulling and pressing are two."""
    del everything
    for material in {r.material for r in reached}:
        mine = [r for r in reached if r.material == material]
        if len({(r.mode, bool(r.stretch.min() < PRESSED)) for r in mine}) < 2:
            return False
    return True


LAW_FORM = HomogeneousEffect(
    effect=catalogue.LAW_FORM,
    step=1e-3,
    bounds=(0.0, 1.0),
    physical_limits=(1.0,),
    start_fraction=1.0,
    prior_scale=1.0,
    conclusive=_several_modes,
    switch=True,
    richer=True,
    further=True,
    scopes=("material",),
)


# -- set-between-tests --
# What is loaded again and again keeps part of its strain: it starts each test shorter (longer, where it was
# pulled) by this part than the test before, while its strain is still counted from the first length. Its own
# strain is the larger (smaller) one.


REPEATS = 3  # tests alike: with two, one that is odd would look like what goes on from test to test


def _shift_set_between_tests(s: Array, amplitude: float, record: Record) -> Array:
    sign = np.where(record.stretch < 1.0, -1.0, 1.0)
    return np.asarray((s - 1.0) * (1.0 / (1.0 + sign * amplitude * record.earlier) - 1.0))


def _repeated(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Some test that was repeated often enough."""
    del everything
    return any(r.alike >= REPEATS and r.earlier > 0 for r in reached)


SET_BETWEEN_TESTS = HomogeneousEffect(
    effect=catalogue.SET_BETWEEN_TESTS,
    step=1e-5,
    bounds=(0.0, 0.05),
    prior_scale=5e-3,
    shift=_shift_set_between_tests,
    identifiable=_repeated,
    further=True,
)


# -- test-order --
# The stress grows, or falls, by the same part from each test to the next at all strains: what heals, dries or
# wears between them, or a load cell that wanders.


def _factor_test_order(s: Array, amplitude: float, record: Record) -> Array:
    return np.full(s.shape, 1.0 + amplitude * record.earlier)


TEST_ORDER = HomogeneousEffect(
    effect=catalogue.TEST_ORDER,
    step=1e-4,
    bounds=(-0.15, 0.3),
    prior_scale=0.01,
    factor=_factor_test_order,
    identifiable=_repeated,
    further=True,
)


# -- tension-compression-asymmetry --
# In compression the material is stiffer (softer, where negative) than in tension: its stress there is this
# part higher, as of one of two moduli.


def _factor_asymmetry(s: Array, amplitude: float, record: Record) -> Array:
    pressed = (s < 1.0) & (record.mode == "uniaxial")
    return np.where(pressed, 1.0 + amplitude, 1.0)


def _both_signs(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """Compression, and something else of the same material."""
    for r in reached:
        others = [q for q in everything if q.material == r.material]
        pressed = [q.mode == "uniaxial" and float(q.stretch.min()) < PRESSED for q in others]
        if any(pressed) and not all(pressed):
            return True
    return False


TENSION_COMPRESSION_ASYMMETRY = HomogeneousEffect(
    effect=catalogue.TENSION_COMPRESSION_ASYMMETRY,
    step=1e-3,
    bounds=(-0.9, 10.0),
    prior_scale=0.5,
    factor=_factor_asymmetry,
    identifiable=_both_signs,
    further=True,
    scopes=("material",),
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


# -- gauge-length --
# The strain of a pulled strip is taken from its grips: ends that are wider, or that slip, stretch less
# (more), and its middle stretches by this part more (less) than the record says.


def _shift_gauge_length(s: Array, amplitude: float, record: Record) -> Array:
    del s
    return np.asarray(np.where(record.stretch > 1.0, amplitude * (record.stretch - 1.0), 0.0))


GAUGE_LENGTH = HomogeneousEffect(
    effect=catalogue.GAUGE_LENGTH,
    step=1e-3,
    bounds=(-0.3, 0.5),
    prior_scale=0.1,
    shift=_shift_gauge_length,
    applies_to=lambda record: record.mode == "uniaxial" and bool(record.stretch.max() > 2.0 - PRESSED),
    identifiable=_compared,
    further=True,
    scopes=("material", "trial"),
)

EFFECTS: dict[str, HomogeneousEffect] = {
    e.name: e
    for e in (
        RATE_DEPENDENCE,
        HYSTERESIS,
        MULLINS,
        ANISOTROPY,
        STRAIN_OFFSET,
        MACHINE_COMPLIANCE,
        PLATEN_FRICTION,
        STRAIN_STIFFENING,
        SECOND_INVARIANT,
        LIMITED_EXTENSIBILITY,
        LAW_FORM,
        SET_BETWEEN_TESTS,
        TEST_ORDER,
        TENSION_COMPRESSION_ASYMMETRY,
        PERMANENT_SET,
        RELAXATION,
        GAUGE_LENGTH,
    )
}
