"""Nominal stress of homogeneous tests, by solving for the free lateral stretches, without a mesh.

Free sides are traction-free. With the principal stretches at a driven stretch s and volume ratio J = exp(v)

    uniaxial      (s, sqrt(J/s), sqrt(J/s))        equibiaxial   (s, s, J/s^2)        planar   (s, 1, J/s)

one unknown v per point remains, and the Kirchhoff stress of the free side, tau = l3 P33, must vanish. It is
nearly linear in v with slope K, so that Newton's method from v = 0 takes three or four steps. If a law has no
such state (St Venant-Kirchhoff in tension), the stress is NaN.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from calibration.experiment.model import CouponMode, CouponTrial
from tisim import Material, laws
from tisim.laws import evaluate

Array = NDArray[np.float64]

# ln of the three stretches = ln(driven stretch) * DRIVEN + v * _FREE; the third side is free in each mode.
DRIVEN = {"uniaxial": (1.0, -0.5, -0.5), "equibiaxial": (1.0, 1.0, -2.0), "planar": (1.0, 0.0, -1.0)}
_FREE = {"uniaxial": (0.0, 0.5, 0.5), "equibiaxial": (0.0, 0.0, 1.0), "planar": (0.0, 0.0, 1.0)}
MODES: tuple[CouponMode, ...] = ("uniaxial", "equibiaxial", "planar", "simple-shear")

# search interval of v: beyond it, sides of vanishing thickness seem traction-free
_LOW, _HIGH, _EDGE = -6.0, 5.0, 0.05
_LONGEST = 0.5  # largest step in v
_TOLERANCE = 1e-11  # of tau, relative to G plus the largest stress in the other directions
_ROUNDING = 5e-15  # of tau, relative to K: rounding error of ln J
_ITERATIONS = 60


def nominal_stress(material: Material, mode: CouponMode, stretch: ArrayLike) -> Array:
    """Force on the pulled (sheared) face over its rest area [Pa], shape of `stretch`.

    As `tisim.Coupon`, but each point is solved independently, from the rest volume.

    Parameters
    ----------
    material : material; its parts are ignored.
    mode : mode of loading.
    stretch : stretch in the driven direction, above 0; in simple-shear 1 + gamma, any finite value.

    Returns
    -------
    ndarray
        NaN where the law has no state with traction-free sides.

    Raises
    ------
    ValueError
        In one sentence: unknown mode, a stretch that is not finite and positive, or an invalid material.
    """
    (found,) = nominal_stresses(material, [(mode, stretch)])
    return found


def nominal_stresses(material: Material, curves: Sequence[tuple[CouponMode, ArrayLike]]) -> list[Array]:
    """`nominal_stress` of several curves (mode, stretch), at little more than the cost of one."""
    stretches = [np.asarray(stretch, dtype=np.float64) for _, stretch in curves]
    for (mode, _), stretch in zip(curves, stretches, strict=True):
        _check(mode, stretch)
    sizes = [stretch.size for stretch in stretches]
    flat = np.concatenate([s.ravel() for s in stretches]) if stretches else np.zeros(0)
    sheared = np.repeat([mode == "simple-shear" for mode, _ in curves], sizes)
    rest = (0.0, 0.0, 0.0)
    driven = np.repeat(np.reshape([DRIVEN.get(m, rest) for m, _ in curves], (-1, 3)), sizes, axis=0)
    free = np.repeat(np.reshape([_FREE.get(m, rest) for m, _ in curves], (-1, 3)), sizes, axis=0)
    stress = np.empty(flat.size)
    if sheared.any():
        stress[sheared] = _sheared(material, flat[sheared])
    if not sheared.all():
        pulled = ~sheared
        stress[pulled] = _pulled(material, np.log(flat[pulled])[:, None] * driven[pulled], free[pulled])
    parts = np.split(stress, np.cumsum(sizes)[:-1]) if sizes else []
    return [part.reshape(s.shape) for part, s in zip(parts, stretches, strict=True)]


def percent_error(trial: CouponTrial, material: Material) -> float:
    """Root mean square of (model - data) over the curve's points, in percent of its largest |stress|.

    NaN if the law has no solution at some point of the curve. ValueError if all stresses are 0.
    """
    largest = float(np.abs(trial.stress).max(initial=0.0))
    if largest == 0.0:
        raise ValueError(f"coupon {trial.id}: expected some stress that is not 0")
    left = nominal_stress(material, trial.mode, trial.stretch) - trial.stress
    return 100.0 * float(np.sqrt(np.mean(left**2))) / largest


def _check(mode: str, stretch: Array) -> None:
    if mode not in MODES:
        raise ValueError(f"mode: expected one of {', '.join(MODES)}, got {mode!r}")
    if not np.isfinite(stretch).all():
        raise ValueError(f"{mode}: expected finite stretches")
    if mode != "simple-shear" and not (stretch > 0.0).all():
        raise ValueError(f"{mode}: expected stretches above 0, got {stretch.min():.4g}")


def _sheared(material: Material, stretch: Array) -> Array:
    F = np.tile(np.eye(3), (stretch.size, 1, 1))
    F[:, 0, 2] = stretch - 1.0
    return evaluate(material.law, material.parameters, F)[1][:, 0, 2]


def _pulled(material: Material, driven: Array, free: Array) -> Array:
    """Nominal stress along axis 1 at log stretches driven + v free, solved for v; driven, free : (n, 3)."""
    n = len(driven)
    moduli = laws.get(material.law).moduli(material.parameters)
    v, low, high = np.zeros(n), np.full(n, _LOW), np.full(n, _HIGH)
    stress, open_ = np.full(n, np.nan), np.arange(n)
    for _ in range(_ITERATIONS):
        l, P, A = _state(material, driven[open_] + v[open_, None] * free[open_])
        tau = l[:, 2] * P[:, 2]
        size = moduli.shear_modulus + np.abs(l[:, :2] * P[:, :2]).max(axis=1)
        done = np.abs(tau) <= _TOLERANCE * size + _ROUNDING * moduli.bulk_modulus
        stress[open_[done]] = P[done, 0]
        # points whose stress overflowed are given up
        go_on = ~done & np.isfinite(tau)
        slope = l[:, 2] * (np.einsum("nk,nk,nk->n", A[:, 2], l, free[open_]) + P[:, 2] * free[open_, 2])
        open_, tau, slope = open_[go_on], tau[go_on], slope[go_on]
        high[open_] = np.where(tau > 0.0, v[open_], high[open_])
        low[open_] = np.where(tau > 0.0, low[open_], v[open_])
        v[open_] = _next(v[open_], tau, slope, low[open_], high[open_])
        # a bracket that has closed on a bound contains no root
        open_ = open_[(high[open_] > _LOW + _EDGE) & (low[open_] < _HIGH - _EDGE)]
        if not open_.size:
            break
    return stress


def _next(v: Array, tau: Array, slope: Array, low: Array, high: Array) -> Array:
    """Newton step limited to _LONGEST; bisection if it leaves the bracket or the slope is not positive."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        step = -tau / slope
    aim = v + np.clip(np.nan_to_num(step), -_LONGEST, _LONGEST)
    good = (slope > 0.0) & (aim > low) & (aim < high)
    middle = np.clip(0.5 * (low + high), v - _LONGEST, v + _LONGEST)
    return np.where(good, aim, middle)


def _state(material: Material, log_stretch: Array) -> tuple[Array, Array, Array]:
    """Principal stretches (n, 3), P_ii (n, 3) and dP_ii/dl_k (n, 3, 3)."""
    stretch = np.exp(log_stretch)
    F = np.zeros((len(stretch), 3, 3))
    axis = np.arange(3)
    F[:, axis, axis] = stretch
    _, P, A = evaluate(material.law, material.parameters, F)
    return stretch, P[:, axis, axis], A[:, axis, axis][:, :, axis, axis]
