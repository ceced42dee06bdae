"""A simulated poke as a curve: force over shear modulus against depth, and its change with the shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from tisim import Poke, Result

Array = NDArray[np.float64]


def rod_force(result: Result) -> tuple[Array, Array]:
    """Depth [m] and force along the rod [N], pushing positive, of the good frames, each (f,)."""
    assert isinstance(result.scene, Poke)
    axis = np.asarray(result.scene.direction, dtype=float)
    force = -(result.rod_force @ (axis / np.linalg.norm(axis)))
    good = int(np.argmin(force > 0.0)) if not (force > 0.0).all() else len(force)
    return result.load[:good], force[:good]


def at_depths(depth: Array, force: Array, wanted: Array, *, round_tip: bool) -> tuple[Array, Array]:
    """Force [N] and its slope [N/m] at the wanted depths (k,), NaN beyond the deepest frame.

    Interpolated through no force at no depth; under a round tip force^(2/3), which Hertz has linear.
    """
    if not depth.size:
        return np.full(wanted.shape, np.nan), np.full(wanted.shape, np.nan)
    power = 1.5 if round_tip else 1.0
    curve = PchipInterpolator(np.r_[0.0, depth], np.r_[0.0, force ** (1.0 / power)])
    inside = np.where(wanted <= depth[-1] * (1.0 + 1e-9), np.minimum(wanted, depth[-1]), np.nan)
    root = curve(inside)
    return root**power, power * root ** (power - 1.0) * curve.derivative()(inside)


def log_change(base: tuple[Array, Array], other: tuple[Array, Array], wanted: Array) -> Array:
    """ln(other / base) of two curves (depth, force) at the wanted depths (k,), from their common frames:
    linear between them, constant before the first, NaN beyond the last."""
    common, a, b = np.intersect1d(np.round(base[0], 9), np.round(other[0], 9), return_indices=True)
    if not common.size:
        return np.full(wanted.shape, np.nan)
    change = np.interp(wanted, common, np.log(other[1][b] / base[1][a]))
    return np.where(wanted <= common[-1] * (1.0 + 1e-6), change, np.nan)
