"""Conversion of material effects to the simulator's constitutive models: viscosity, softening, fibres, laws.

An effect describes a phenomenon in one kind of measurement (a stress that grows by a fraction per decade of
the strain rate); the simulator has constitutive models (`tisim.parts`: a relaxation spectrum). The model is
fitted to the effect over the range of times, or energies, of the measurement; the card states that range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls
from scipy.special import erf

from calibration.measurements._effect import HandedOn, Occurrence
from tisim import laws
from tisim.parts import HolzapfelGasserOgden, OgdenRoxburgh, Prony

Array = NDArray[np.float64]
Curve = Callable[[Array], Array]

A_DECADE = 2  # relaxation times per decade: closer ones cannot be separated
GRID = 60  # number of times, or energies, at which the model is compared with the effect
NEGLIGIBLE = 1e-9  # terms with fractions below this are dropped
ALIKE = 0.02  # relative difference of model and effect above which a remark is made
SMALL_ENERGY = 1e-3  # m over the largest energy, for a softening that depends on the largest energy alone
LONG_TIME = "the long-time modulus"


def viscosity_of(relaxed: Curve, *, first: float, last: float) -> HandedOn:
    """Fit a Prony series of two terms per decade to a relaxation function (non-negative least squares).

    Parameters
    ----------
    relaxed : relaxation function at times (n,) [s] after a step, relative to the modulus of the fit.
    first, last : range of times that the measurement covers [s].
    """
    decades = max(np.log10(last / first), 1.0 / A_DECADE)
    times = first * 10.0 ** (np.arange(round(A_DECADE * decades) + 1) / A_DECADE)
    at = np.geomspace(first, last, GRID)
    wanted = relaxed(at)
    basis = np.column_stack([np.ones(GRID), np.exp(-at[:, None] / times)])
    found, _ = nnls(basis, wanted)
    return _prony(found[0], found[1:], times, first=first, last=last, off=_off(basis @ found, wanted))


def one_time(fraction: float, time: float, *, first: float, last: float) -> HandedOn:
    """A Prony series of one term: a fraction of the instantaneous modulus, with its relaxation time [s].

    first, last : range of times that the measurement covers [s].
    """
    return _prony(1.0 - fraction, np.array([fraction]), np.array([time]), first=first, last=last, off=0.0)


def branches(fractions: Array, times: Array, *, reference: float, first: float, last: float) -> HandedOn:
    """A Prony series whose fractions are relative to the storage modulus at 1 / `reference` [rad/s]."""
    slow = (times / reference) ** 2
    left = 1.0 - float(np.sum(fractions * slow / (1.0 + slow)))
    found = _prony(left, fractions, times, first=first, last=last, off=0.0)
    own = "the vibration's own damping, which was fitted beside it, is not in the viscosity"
    return replace(found, remarks=(*found.remarks, own))


def _prony(left: float, strengths: Array, times: Array, *, first: float, last: float, off: float) -> HandedOn:
    """Build the Prony series, with remarks.

    left, strengths : long-time modulus and terms relative to the modulus of the fit. off : largest difference
    from the effect, relative to that modulus.
    """
    if not left > 0.0:
        return HandedOn(
            field="viscosity",
            part=None,
            remarks=("no relaxation spectrum: the modulus relaxes to nothing within the record",),
        )
    some = strengths > NEGLIGIBLE
    if not some.any():
        return HandedOn(field="viscosity", part=None, remarks=("no relaxation spectrum: nothing relaxes",))
    remarks = [
        f"relaxation was seen between {first:.3g} and {last:.3g} s: faster and slower relaxation is not in"
        " the viscosity"
    ]
    outside = [t for t in times[some] if not 0.99 * first <= t <= 1.01 * last]
    if outside:
        remarks.append(
            f"relaxation times outside of that: {', '.join(f'{t:.3g}' for t in outside)} s, as the effect has"
            " them"
        )
    if off > ALIKE:
        remarks.append(f"the Prony series departs from the effect by up to {off:.0%} of the modulus")
    part = Prony(
        fractions=tuple(float(g) for g in strengths[some] / left), times=tuple(float(t) for t in times[some])
    )
    return HandedOn(
        field="viscosity", part=part, modulus_ratio=float(left), states=LONG_TIME, remarks=tuple(remarks)
    )


def softening_of(lost: Curve, *, energy: float, remarks: tuple[str, ...] = ()) -> HandedOn:
    """Fit the Ogden-Roxburgh softening to the fraction of stress lost below the largest energy so far.

    Parameters
    ----------
    lost : fraction of the stress that is lost, at energies (n,) relative to the largest energy so far.
    energy : largest energy density of the measurement [J/m3].
    remarks : sentences to put before those made here.
    """
    ratio = np.linspace(0.0, 1.0, GRID)
    wanted = lost(ratio)

    def of(x: Array) -> Array:
        return np.asarray(erf((1.0 - ratio) / np.exp(x[1])) / np.exp(x[0]))

    def left(x: Array) -> Array:
        return np.asarray(of(x) - wanted)

    # ln r >= 0 (r >= 1); ln beta from an immediate softening (-3) to one that is linear in the energy (3)
    start = np.array([np.log(1.0 / max(float(wanted.max()), 1e-3)), 0.0])
    found = least_squares(
        left,
        np.clip(start, [1e-6, -3.0], [20.0, 3.0]),
        bounds=([0.0, -3.0], [20.0, 3.0]),
        xtol=1e-12,
    )
    part = OgdenRoxburgh(
        r=float(max(np.exp(found.x[0]), 1.0)), m=SMALL_ENERGY * energy, beta=float(np.exp(found.x[1]))
    )
    said = list(remarks)
    off = _off(of(found.x), wanted)
    if off > ALIKE:
        said.append(f"the softening departs from the effect by up to {off:.0%} of the stress")
    said.append(
        f"softening was seen up to an energy of {energy:.3g} J/m3; residual set, recovery and the further"
        " loss of later cycles are not in it"
    )
    states = "the modulus of the first loading"
    return HandedOn(field="softening", part=part, states=states, remarks=tuple(said))


def fibres_along_the_load(k1: float) -> HandedOn:
    """One family of fibres along axis 1, the loading direction of homogeneous tests; k1 [Pa].

    No fibres if k1 is negative.
    """
    if k1 < 0.0:
        return HandedOn(
            field="fibres",
            part=None,
            remarks=("no fibres: the material is softer along the load, which fibres along it cannot be",),
        )
    return HandedOn(
        field="fibres",
        part=HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=k1),
        states="the modulus across the fibres",
        remarks=(
            "fibres lie along axis 1, in which the coupons were loaded: turn them to where that axis lies in"
            " another body; they carry no compression",
        ),
    )


def stiffening(found: Occurrence) -> HandedOn:
    """Yeoh law whose second constant, relative to the first, is the amplitude; none if it is negative."""
    if found.amplitude < 0.0:
        text = "no law: one that softens with strain has no least energy"
        return HandedOn(field="law", remarks=(text,))
    return _law("yeoh", found.amplitude)


def mooney_rivlin(found: Occurrence) -> HandedOn:
    """Mooney-Rivlin law: the amplitude is the fraction C01 / (C10 + C01) of the second invariant."""
    return _law("mooney-rivlin", found.amplitude)


def eight_chain(found: Occurrence) -> HandedOn:
    """Eight-chain law with the locking stretch amplitude^(-1/2); none unless 0 < amplitude < 1."""
    if not 0.0 < found.amplitude < 1.0:
        text = "no law: the chains would lock at rest"
        return HandedOn(field="law", remarks=(text,))
    return _law("eight-chain", found.amplitude)


def _law(name: laws.Extension, amplitude: float) -> HandedOn:
    def law(shear: float, bulk: float) -> tuple[str, dict[str, float]]:
        return name, laws.extension(name, amplitude, shear_modulus=shear, bulk_modulus=bulk)

    return HandedOn(field="law", law=law, states="the small-strain modulus")


def seen(times: list[Array]) -> tuple[float, float]:
    """Shortest and longest time [s] that records with these sampling times (k,) resolve.

    They are the smallest sampling interval, at least 1e-6 of the longest record, and the longest record.
    """
    first = min(float(np.diff(t).min()) for t in times)
    last = max(float(np.ptp(t)) for t in times)
    return max(first, 1e-6 * last), last


def _off(a: Array, b: Array) -> float:
    return float(np.abs(a - b).max())
