"""Force of an indentation of a viscous material, from the elastic force against depth.

The contact is mapped to springs side by side, each of which the indenter meets at a depth of its own, e: with
the elastic force F(d) they are as stiff as F''(e) de (the method of dimensionality reduction; V. L. Popov,
M. Hess, E. Willert, Handbook of Contact Mechanics, 2019, chapter 8). Where the material is viscous each
spring has the material's memory,

    q = g_inf w + sum Q_i,    dQ_i/dt + Q_i/tau_i = g_i dw/dt,    w >= d - e,  q >= 0,  q (w - d + e) = 0,

and the force is sum F'' q de. While no spring lifts off this is the hereditary integral of F (E. H. Lee,
J. R. M. Radok, J. Appl. Mech. 27, 1960); in retraction springs lift off from the outside, which is Ting's
solution (J. Appl. Mech. 33, 1966), and recover freely until they are met again. Exact for linear viscoelastic
half-spaces without friction; what else it leaves out is measured in
`studies/indentation/over-time.md`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.measurements.homogeneous._memory_stress import ramp_weights
from calibration.parameters import Parametrisation
from tisim.parts import Spectrum, Viscosity

Array = NDArray[np.float64]

SPRINGS = 96
CLOSER = 1.5  # power by which the depths at which springs are met are closer near the surface


def thresholds(deepest: float) -> Array:
    """Depths at which springs are met [m], and the deepest after them, shape (SPRINGS + 1,)."""
    return np.asarray(deepest * (np.arange(SPRINGS + 1) / SPRINGS) ** CLOSER)


def stiffnesses(at: Array, force: Array) -> Array:
    """Of the springs that are met at depths (m + 1,), from the elastic force there, (m + 1,) or (m + 1, 2);
    shape (m,) or (m, 2)."""
    slope = np.diff(force, axis=0) / np.diff(at).reshape(-1, *([1] * (force.ndim - 1)))
    return np.asarray(np.diff(slope, axis=0, prepend=0.0))


def loads(spectrum: Spectrum, time: Array, depth: Array, met: Array) -> Array:
    """Load of each spring over its stiffness [m], shape (f, m).

    Parameters
    ----------
    time, depth : course of the indenter [s], [m], shape (f,); what it first reaches is reached at once.
    met : depth at which it meets each spring [m], shape (m,).
    """
    steps = np.diff(time, prepend=time[0])
    h = steps[:, None] / spectrum.times
    decays, gains = np.exp(-h), spectrum.strengths * ramp_weights(h)
    stiff = spectrum.equilibrium + gains.sum(axis=1)
    found = np.empty((time.size, met.size))
    w, Q = np.zeros(met.size), np.zeros((spectrum.times.size, met.size))
    driven = depth[:, None] - met
    for n in range(time.size):
        left = decays[n][:, None] * Q
        own = gains[n].sum() * w - left.sum(axis=0)
        new = np.maximum(own / stiff[n], driven[n])  # free of load, or where the indenter is
        Q = left + np.outer(gains[n], new - w)
        found[n] = stiff[n] * new - own
        w = new
    return np.maximum(found, 0.0)


def spectrum_of(law: Parametrisation, own: Array) -> Spectrum | None:
    """By which a law with parts relaxes at its coordinates (n,); None without viscosity. ValueError where its
    parts refuse them."""
    values = law.values(own)
    parts = [p.assembled(values) for p in law.parts]
    viscosities = [p for p in parts if isinstance(p, Viscosity)]
    return viscosities[0].spectrum() if viscosities else None
