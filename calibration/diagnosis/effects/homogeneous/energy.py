"""Effects in homogeneous material tests: strain energy of the material."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis import catalogue
from calibration.diagnosis.effects._material_parts import (
    eight_chain,
    fibres_along_the_load,
    mooney_rivlin,
    stiffening,
)
from calibration.measurements._effect import HandedOn, Occurrence
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.homogeneous.kinematics import (
    COMPRESSED,
    first_excess,
    goes_into_compression,
    stress_of,
)

Array = NDArray[np.float64]

# -- anisotropy --
# The material is stiffer in the loading direction: W has an additional term G k/8 (I4 - 1)^2, where I4 is the
# squared stretch of that direction. The amplitude k is the additional stress at small strain, divided by G
# and the strain.


def _extra_anisotropy(s: Array, amplitude: float, record: Record) -> Array:
    if record.mode == "simple-shear":
        return np.zeros(s.size)
    # equibiaxial: the stress is the mean over two directions, one of which is stiffer
    axes = 2.0 if record.mode == "equibiaxial" else 1.0
    return np.asarray(0.5 * amplitude * s * (s**2 - 1.0) / axes)


def _identifiable_anisotropy(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if the candidate reaches several modes of a material, or if another record has a mode in common.

    Anisotropy in the only record of a mode, and in no other, is not a property of the material.
    """
    for material in {r.material for r in reached}:
        mine = [r for r in reached if r.material == material]
        others = [r for r in everything if r.material == material and r not in mine]
        modes = {r.mode for r in mine}
        if len(modes) > 1 or any(r.mode in modes for r in others):
            return True
    return False


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


# -- strain-stiffening --
# Strain stiffening: W has an additional term G/2 a (I1 - 3)^2 (Yeoh law in `tisim`, which rejects a < 0
# because the energy would be unbounded below).


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
# The energy depends on the second invariant (Mooney-Rivlin): amplitude C01 / (C10 + C01).


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
# Limited chain extensibility (eight Langevin chains: Arruda and Boyce, J. Mech. Phys. Solids 41, 1993; law
# `eight-chain` of `tisim`): the amplitude is one over the squared locking stretch; the small-strain modulus
# is kept.
#
# Beyond LONGEST_CHAIN of the chains' length the force is continued linearly, as in that law, since a search
# may step there.


LONGEST_CHAIN = 0.995

_NEWTON_STEPS = 5  # Newton iterations, starting from a Pade approximation with an error of up to 5 %

_SHORT_CHAIN = 1e-4  # relative length below which a chain is Gaussian to rounding errors


def _stiffening(x: Array) -> Array:
    """Force of a chain at the fraction x of its length, relative to a Gaussian chain: L^-1(x) / (3 x).

    L is the Langevin function; the ratio is 1 for short chains.
    """
    inside = np.clip(x, _SHORT_CHAIN, LONGEST_CHAIN)
    b = inside * (3.0 - inside**2) / (1.0 - inside**2)
    for _ in range(_NEWTON_STEPS):
        value, slope = _langevin(b)
        b = b - (value - inside) / slope
    past = np.maximum(x - LONGEST_CHAIN, 0.0) / _langevin(b)[1]
    return np.asarray((b + past) / (3.0 * np.maximum(x, _SHORT_CHAIN)))


def _langevin(b: Array) -> tuple[Array, Array]:
    """Langevin function coth b - 1/b and its derivative."""
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
# A law other than the baseline's describes the material: the energy is (1 - a) W + a W', with one
# small-strain modulus, and W' alone if the effect is named. The constants of W' are further coordinates of
# the fit. W' is the law with the best held-out predictions (`calibration.diagnosis.laws`).


def _several_modes(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if each material is reached in two loading modes; tension and compression count as two."""
    del everything
    for material in {r.material for r in reached}:
        mine = [r for r in reached if r.material == material]
        if len({(r.mode, bool(r.stretch.min() < COMPRESSED)) for r in mine}) < 2:
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


# -- tension-compression-asymmetry --
# The material is stiffer (softer if negative) in compression than in tension: its stress in compression is
# higher by this fraction (bimodular material).


def _factor_asymmetry(s: Array, amplitude: float, record: Record) -> Array:
    pressed = (s < 1.0) & (record.mode == "uniaxial")
    return np.where(pressed, 1.0 + amplitude, 1.0)


def _both_signs(reached: Sequence[Record], everything: Sequence[Record]) -> bool:
    """True if the same material has compression tests and others."""
    for r in reached:
        others = [q for q in everything if q.material == r.material]
        pressed = [goes_into_compression(q.mode, q.stretch) for q in others]
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
