"""Bonded-to-free force ratio of a compressed cylinder, interpolated between stored simulations."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BarycentricInterpolator, CubicSpline

from calibration.errors import InputError
from calibration.measurements._memory import Memory
from calibration.measurements.compression._bonded_table import LAWS, REFERENCE, SLENDER, STRAINS
from calibration.measurements.compression.curves import Cylinder

Array = NDArray[np.float64]

# Diameter 50 mm, height 30 mm: the reference of the stored simulations.
USUAL = Cylinder(radius=0.025, height=0.030)
REMEMBERED = 64  # cached curves, each for many records together


@dataclass(frozen=True, kw_only=True)
class BondedRatio:
    """Bonded-to-free force ratio of one cylinder; InputError if it is flatter than the stored simulations."""

    cylinder: Cylinder
    _memory: Memory[Hashable, Array] = field(
        default_factory=lambda: Memory(REMEMBERED), init=False, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        if not 0.0 < self.slender <= max(SLENDER):
            raise InputError(
                f"cylinder: expected a diameter of up to {max(SLENDER):g} heights, got {self.slender:.3g}"
            )

    @property
    def slender(self) -> float:
        """Diameter over height."""
        return 2.0 * self.cylinder.radius / self.cylinder.height

    def log_ratio(self, stretch: Array, law: Mapping[str, float]) -> Array:
        """ln(bonded / free force) at stretches, shape of these; NaN beyond the simulated strains.

        The law is neo-Hookean with effects, given by their amplitudes; effects without simulations are
        ignored. The changes by several effects add up; their relative change is taken as independent of
        diameter over height. Below the first simulated strain the ratio is constant.
        """
        own = {n: a for n, a in law.items() if n in LAWS and a != 0.0}
        key = stretch.shape, stretch.tobytes(), tuple(own.items())
        return self._memory.fetch([key], lambda _: [self._log_ratio(stretch, own)])[0]

    def _log_ratio(self, stretch: Array, law: Mapping[str, float]) -> Array:
        strain = np.maximum(1.0 - stretch, STRAINS[0])
        plain = _curve(("plain", REFERENCE), strain)
        change = np.zeros_like(plain)
        for name, amplitude in law.items():
            change += _between(name, amplitude, strain, plain) - plain
        return np.asarray(_by_slenderness(self.slender, strain) * (1.0 + change / plain))


def _by_slenderness(slender: float, strain: Array) -> Array:
    if slender in SLENDER:
        return _curve(("plain", slender), strain)
    # for slender cylinders the ratio is linear in diameter/height: end effects extend over about a diameter
    nodes = np.array([0.0, *SLENDER])
    values = np.array([np.zeros(strain.shape), *(_curve(("plain", s), strain) for s in SLENDER)])
    return np.asarray(BarycentricInterpolator(nodes, values)(slender))


def _between(name: str, amplitude: float, strain: Array, plain: Array) -> Array:
    """Linear interpolation between stored amplitudes; constant beyond the first and last."""
    nodes = sorted([0.0, *LAWS[name]])
    amplitude = min(max(amplitude, nodes[0]), nodes[-1])
    k = min(int(np.searchsorted(nodes, amplitude, side="right")), len(nodes) - 1)
    low, high = (plain if n == 0.0 else _curve((name, n), strain) for n in nodes[k - 1 : k + 1])
    part = (amplitude - nodes[k - 1]) / (nodes[k] - nodes[k - 1])
    return (1.0 - part) * low + part * high


def _curve(key: tuple[str, float], strain: Array) -> Array:
    spline, reached = _spline(key)
    return np.where(strain <= reached, spline(np.minimum(strain, reached)), np.nan)


@cache
def _spline(key: tuple[str, float]) -> tuple[CubicSpline, float]:
    name, at = key
    values = np.array(SLENDER[at] if name == "plain" else LAWS[name][at])
    sound = np.isfinite(values)
    strains = np.array(STRAINS)[sound]
    return CubicSpline(strains, values[sound]), float(strains[-1])
