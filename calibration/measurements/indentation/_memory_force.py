"""Force of an indentation of a viscoelastic material, from the elastic force against depth.

The contact is mapped to parallel springs, which the indenter meets at depths e; for an elastic force F(d)
their stiffness is F''(e) de (method of dimensionality reduction; V. L. Popov, M. Hess, E. Willert, Handbook
of Contact Mechanics, 2019, chapter 8). In a viscoelastic material each spring relaxes as the material does,

    q = g_inf w + sum Q_i,    dQ_i/dt + Q_i/tau_i = g_i dw/dt,    w >= d - e,  q >= 0,  q (w - d + e) = 0,

and the force is sum F'' q de. While no spring lifts off this is the hereditary integral of F (E. H. Lee,
J. R. M. Radok, J. Appl. Mech. 27, 1960). In retraction springs lift off from the outside, which is Ting's
solution (J. Appl. Mech. 33, 1966), and recover freely until the indenter meets them again. The method is
exact for linear viscoelastic half-spaces without friction; `studies/indentation/over-time.md` quantifies its
error otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.parameters import Parametrisation
from tisim.parts import Spectrum, Viscosity, ramp_weight

Array = NDArray[np.float64]

SPRINGS = 96
CLOSER = 1.5  # exponent of the grading of the springs' depths, which are denser near the surface


def thresholds(deepest: float) -> Array:
    """Depths at which the indenter meets the springs, followed by the largest depth [m], (SPRINGS + 1,)."""
    return np.asarray(deepest * (np.arange(SPRINGS + 1) / SPRINGS) ** CLOSER)


def stiffnesses(at: Array, force: Array) -> Array:
    """Stiffnesses of the springs, shape (m,) or (m, 2).

    at : depths (m + 1,) of `thresholds`. force : elastic force there, shape (m + 1,) or (m + 1, 2).
    """
    slope = np.diff(force, axis=0) / np.diff(at).reshape(-1, *([1] * (force.ndim - 1)))
    return np.asarray(np.diff(slope, axis=0, prepend=0.0))


def loads(spectrum: Spectrum, time: Array, depth: Array, met: Array) -> Array:
    """Load of each spring over its stiffness [m], shape (f, m).

    Parameters
    ----------
    spectrum : relaxation spectrum.
    time, depth : course of the indenter [s], [m], shape (f,); its first depth is applied as a jump.
    met : depth at which the indenter meets each spring [m], shape (m,).
    """
    steps = np.diff(time, prepend=time[0])
    h = steps[:, None] / spectrum.times
    decays, gains = np.exp(-h), spectrum.strengths * ramp_weight(h)
    stiff = spectrum.equilibrium + gains.sum(axis=1)
    found = np.empty((time.size, met.size))
    w, Q = np.zeros(met.size), np.zeros((spectrum.times.size, met.size))
    driven = depth[:, None] - met
    for n in range(time.size):
        left = decays[n][:, None] * Q
        own = gains[n].sum() * w - left.sum(axis=0)
        new = np.maximum(own / stiff[n], driven[n])  # free of load, or in contact
        Q = left + np.outer(gains[n], new - w)
        found[n] = stiff[n] * new - own
        w = new
    return np.maximum(found, 0.0)


def spectrum_of(law: Parametrisation, own: Array) -> Spectrum | None:
    """Relaxation spectrum of a law with parts at its coordinates (n,); None without viscosity.

    ValueError if the coordinates are invalid for its parts.
    """
    values = law.values(own)
    parts = [p.assembled(values) for p in law.parts]
    viscosities = [p for p in parts if isinstance(p, Viscosity)]
    return viscosities[0].spectrum() if viscosities else None
