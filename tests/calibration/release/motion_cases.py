"""Release of a cantilever in Euler-Bernoulli modes: synthetic data that share no code with the simulator."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from calibration.experiment import BeamTrial, Marker, MaterialBelief
from tisim import Rectangle

LENGTH, SIDE, DENSITY, G = 0.12, 0.012, 1000.0, 2.0
YOUNG, STIFFNESS_DAMPING, RELEASE = 900e3, 3e-3, 0.0273
WHERE = {"end": (LENGTH, 0.0, 0.0), "top": (0.07, 0.0, 0.5 * SIDE), "stalk": (LENGTH, 0.0, 0.02)}
SILICONE = MaterialBelief(name="silicone", density=DENSITY)


def deflection(x, t, modes=4):
    """Deflection w [m] and its slope at x [m], t [s] after release from uniform load.

    The first `modes` modes are superposed; each decays at the rate c_K w^2 / 2.
    """
    w, slope = np.zeros_like(t), np.zeros_like(t)
    for n in range(modes):
        middle = (n + 0.5) * np.pi
        b = brentq(lambda b: np.cos(b) + 1.0 / np.cosh(b), middle - 0.4, middle + 0.4)
        s = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))

        def shape(y, b=b, s=s):
            return np.cosh(b * y) - np.cos(b * y) - s * (np.sinh(b * y) - np.sin(b * y))

        y = np.linspace(0.0, 1.0, 4001)
        share = np.trapezoid(shape(y), y) / np.trapezoid(shape(y) ** 2, y)
        omega = b**2 * np.sqrt(YOUNG * SIDE**2 / (12.0 * DENSITY * LENGTH**4))
        rate = 0.5 * STIFFNESS_DAMPING * omega**2
        root = np.emath.sqrt(rate**2 - omega**2)  # real if overdamped
        up, down = -rate + root, -rate - root
        after = np.maximum(t, 0.0)
        swing = (up * np.exp(down * after) - down * np.exp(up * after)) / (up - down)
        q = -G * share / omega**2 * (1.0 - swing.real)
        at, h = x / LENGTH, 1e-5
        w += q * shape(at)
        slope += q * (shape(at + h) - shape(at - h)) / (2.0 * h * LENGTH)
    return w, slope


def first_mode():
    """Angular frequency [rad/s] and damping ratio of the first mode."""
    omega = 1.8751041**2 * np.sqrt(YOUNG * SIDE**2 / (12.0 * DENSITY * LENGTH**4))
    return omega, 0.5 * STIFFNESS_DAMPING * omega


def trial(noise=0.0, shift=(0.0, 0.0, 0.0), seconds=3.0, **changes):
    """Synthetic trial; `shift` [m] is the true minus the stated position of the stalk's marker."""
    rng = np.random.default_rng(7)
    time = np.arange(0.0, seconds, 0.01)
    found = []
    for name, stated in WHERE.items():
        place = np.array(stated) + (np.array(shift) if name == "stalk" else 0.0)
        w, slope = deflection(np.full_like(time, stated[0]), time - RELEASE)
        foot = np.array([stated[0], 0.0, 0.0])
        a = np.arctan(slope)
        d = place - foot  # the stalk rotates with the section
        u = np.column_stack([
            np.cos(a) * d[0] - np.sin(a) * d[2] - d[0],
            np.zeros_like(a),
            w + np.sin(a) * d[0] + np.cos(a) * d[2] - d[2],
        ])  # fmt: skip
        moved = u + rng.normal(0.0, noise, u.shape)
        found.append(Marker(name=name, position=stated, time=time, displacement=moved))
    options = {
        "id": "made", "material": "silicone", "section": Rectangle(width=SIDE, height=SIDE),
        "free_length": LENGTH, "grip_length": 0.02, "supports": "clamped-free", "gravity": (0.0, 0.0, -G),
        "markers": tuple(found), "marker_sd": 2e-5, **changes,
    }  # fmt: skip
    return BeamTrial(**options)
