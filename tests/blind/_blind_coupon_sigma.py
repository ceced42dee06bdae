"""How large a cause in made coupons is, in sigmas, and the amplitude that makes it so large."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from _blind_coupon_case import LARGEST, Hidden, Protocol, first_invariant
from _blind_coupon_curve import CHAINS, curve, errors
from _blind_coupon_law import Solid
from _blind_record_case import reaching
from numpy.typing import NDArray

Array = NDArray[np.float64]


def sigmas(case_protocols: tuple[Protocol, ...], hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, after projecting out a modulus a specimen."""
    changed: list[Array] = []
    free: dict[str, Array] = {}
    first = 0
    sizes = [len(p.path()[0]) for p in case_protocols]
    for p, size in zip(case_protocols, sizes, strict=True):
        sd = errors(p)
        base = curve(p, others)
        changed.append((curve(p, (*others, hidden)) - base) / sd)
        column = free.setdefault(p.specimen or p.material, np.zeros(sum(sizes)))
        column[first : first + size] = base / sd
        first += size
    q, _ = np.linalg.qr(np.column_stack(list(free.values())))
    z = np.concatenate(changed)
    return float(np.linalg.norm(z - q @ (q.T @ z)))


def sized(protocols: tuple[Protocol, ...], hidden: Hidden, target: float) -> Hidden:
    """The cause with the amplitude that makes it `target` sigmas, or the largest that a lab meets."""
    high = LARGEST[hidden.name] / hidden.amplitude
    if hidden.name == "limited-extensibility":
        furthest = max(first_invariant(p) for p in protocols if hidden.hits(p))
        high = min(high, CHAINS * 3.0 / furthest / hidden.amplitude)
    if hidden.name == "machine-compliance":
        # the rig takes at most a fifth of the travel
        travel = [
            abs(p.top - 1.0) / float(np.abs(Solid(G=p.G).stress(p.mode, np.array([p.top])))[0])
            for p in protocols
            if hidden.hits(p)
        ]
        high = min(high, 0.2 * min(travel) / hidden.amplitude)

    def scaled(factor: float) -> Hidden:
        return replace(hidden, amplitude=factor * hidden.amplitude)

    factor = reaching(lambda f: sigmas(protocols, scaled(f)), target, largest=high, steps=40)
    found = scaled(factor)
    return replace(found, sigma=sigmas(protocols, found))
