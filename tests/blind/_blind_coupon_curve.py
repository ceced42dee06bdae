"""What the load cell of a made coupon shows, with the causes that are hidden in it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from _blind_coupon_case import Hidden, Protocol, first_invariant
from _blind_coupon_law import Solid, inverse_of
from numpy.typing import NDArray

Array = NDArray[np.float64]

CHAINS = 0.56  # largest squared length of chains, over their contour length: 3/4 of it
REFERENCE_RATE = 0.01  # [1/s]


def curve(p: Protocol, hidden: tuple[Hidden, ...]) -> Array:
    """Nominal stress [Pa] at the recorded stretches, without noise."""
    mine = [h for h in hidden if h.hits(p)]
    a = {h.name: h.amplitude for h in mine}
    shape = {h.name: h.shape for h in mine}
    solid = Solid(
        G=p.G,
        stiffening=a.get("strain-stiffening", 0.0),
        second=a.get("second-invariant", 0.0),
        locking=a.get("limited-extensibility", 0.0),
        fibre=a.get("anisotropy", 0.0),
    )
    recorded, time, ramp = p.path()
    top_energy, worn_energy = solid.energy(p.mode, np.array([p.top, p.before]))
    # a piece remembers the trials before: its first ramp here is virgin only beyond them
    peak = np.where(ramp >= 1, max(top_energy, worn_energy), worn_energy)
    virgin = peak <= 1e-9 * top_energy

    def stress(true: Array) -> Array:
        found = solid.stress(p.mode, true)
        energy = solid.energy(p.mode, true)
        left = np.clip(1.0 - energy / top_energy, 0.0, 1.0)
        if "hysteresis" in a:
            lost = 1.0 - (1.0 - left) ** shape["hysteresis"]
            found = found * np.where(ramp % 2 == 1, 1.0 - a["hysteresis"] * lost, 1.0)
        if "mullins" in a:
            unused = np.clip(1.0 - energy / np.where(virgin, top_energy, peak), 0.0, 1.0)
            worn = [math.erf(x / shape["mullins"]) / math.erf(1.0 / shape["mullins"]) for x in unused]
            found = found * np.where(virgin, 1.0, 1.0 - a["mullins"] * np.array(worn))
        if "rate-dependence" in a:
            # a power of the rate, whose slope a decade at the reference is the amplitude
            found = found * (p.rate / REFERENCE_RATE) ** (a["rate-dependence"] / math.log(10.0))
        if "platen-friction" in a and p.mode == "uniaxial" and p.top < 1.0:
            # Coulomb friction under a cylinder: the pressure grows exponentially inwards
            x = 3.0 * a["platen-friction"] * true**-1.5
            found = found * 2.0 * (np.exp(x) - 1.0 - x) / x**2
        return np.asarray(found)

    offset, soft = a.get("strain-offset", 0.0), a.get("machine-compliance", 0.0)
    slipped = a.get("slip", 0.0) * (p.top - 1.0) * (np.arange(len(ramp)) >= shape.get("slip", 1.0) * p.points)
    waves = a.get("wavy-gauge", 0.0) * (p.top - 1.0)
    wave = waves * np.sin(2.0 * np.pi * shape.get("wavy-gauge", 1.0) * (recorded - 1.0) / (p.top - 1.0))
    true = recorded + offset - slipped + wave
    if soft:
        true = inverse_of(lambda s: s + soft * stress(s), true)
    found = stress(true)
    largest = float(np.abs(found).max())
    if "wrong-area" in a:
        found = found * (1.0 + a["wrong-area"])
    if "cell-drift" in a:
        found = found + a["cell-drift"] * largest * time / time[-1]
    if "cell-saturates" in a:
        limit = (1.0 - a["cell-saturates"]) * largest
        found = np.sign(found) * limit * np.tanh((np.abs(found) / limit) ** 3) ** (1.0 / 3.0)
    return np.asarray(found)


def errors(p: Protocol) -> Array:
    """Standard deviation of each point's stress as the lab would say [Pa]."""
    recorded, _, _ = p.path()
    solid = Solid(G=p.G)
    slope = (solid.stress(p.mode, recorded + 1e-6) - solid.stress(p.mode, recorded - 1e-6)) / 2e-6
    return np.asarray(np.hypot(p.stress_sd, slope * p.stretch_sd))


def until_it_locks(p: Protocol, hidden: tuple[Hidden, ...]) -> Protocol:
    """The same test, to no more than 3/4 of the chains' length: a lab stops where the curve shoots up."""
    inverse = sum(h.amplitude for h in hidden if h.name == "limited-extensibility" and h.hits(p))
    while first_invariant(p) * inverse / 3.0 > CHAINS:
        p = replace(p, top=1.0 + 0.95 * (p.top - 1.0))
    return p
