"""How large a cause in made pokes is, in sigmas, and the amplitude that makes it so large."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from _blind_poke_case import BASES, LARGEST, Hidden, Trial
from _blind_poke_curve import force, table
from _blind_record_case import reaching
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

Array = NDArray[np.float64]
# what the finder's simulation may be off by, as docs/pokes.md states it: together, and what wanders
# (sd, width of contact)
REFINED = 1.5
MESH, SHALLOW = 0.025 / REFINED**2, 0.4
WANDER = ((0.008 / REFINED**2, 0.04 / REFINED), (0.006 / REFINED**2, 0.5 / REFINED))


@lru_cache(maxsize=4)
def _root(trials: tuple[Trial, ...]) -> Array:
    """Lower factor of the covariance of all forces [N2]: noise, touch, and what a simulation may be off
    by."""
    base = [force(t, ()) for t in trials]
    parts, width, radii, relative = [], [], [], []
    for t, f in zip(trials, base, strict=True):
        _, depth, _ = t.path()
        radius = 1e-3 * table()[t.base]["setup"]["rod"]
        slope = np.abs(np.interp(depth, *_unique(depth, f)))
        white = t.force_sd**2 + (slope * t.depth_sd) ** 2
        parts.append((white, slope * t.depth_sd))
        shallow = np.sqrt(1 + (SHALLOW * radius / np.maximum(depth, 0.1 * SHALLOW * radius)) ** 2)
        width.append(np.sqrt(np.maximum(depth, 0.0) / radius))
        relative.append(shallow * f)
        radii.append(np.full(len(depth), BASES.index(t.base), dtype=float))
    w, g, r, f = (np.concatenate(x) for x in (width, radii, relative, base))
    same = g[:, None] == g[None, :]
    alike = sum(sd**2 * np.exp(-0.5 * ((w[:, None] - w) / over) ** 2) for sd, over in WANDER)
    total = same * np.outer(r, r) * alike + MESH**2 * np.outer(f, f)
    first = 0
    for white, touch in parts:
        mine = slice(first, first + len(white))
        total[mine, mine] += np.diag(white + 1e-14) + np.outer(touch, touch)
        first += len(white)
    return np.asarray(np.linalg.cholesky(total))


def _unique(depth: Array, f: Array) -> tuple[Array, Array]:
    """Depths of the first stroke with the slope of its force."""
    last = int(np.argmax(depth)) + 1
    x, y = depth[:last], f[:last]
    return x, np.gradient(y, x)


def sigmas(trials: tuple[Trial, ...], hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, a modulus a material projected out."""
    base = [force(t, others) for t in trials]
    root = _root(trials)
    change = np.concatenate([force(t, (*others, hidden)) - b for t, b in zip(trials, base, strict=True)])
    columns = []
    for m in sorted({t.material for t in trials}):
        columns.append(np.concatenate([b * (t.material == m) for t, b in zip(trials, base, strict=True)]))
    z = solve_triangular(root, np.column_stack([change, *columns]), lower=True)
    q, _ = np.linalg.qr(z[:, 1:])
    left = z[:, 0] - q @ (q.T @ z[:, 0])
    return float(np.linalg.norm(left))


def sized(trials: tuple[Trial, ...], hidden: Hidden, target: float) -> Hidden:
    """The cause with the amplitude that makes it `target` sigmas, or the largest that a lab meets."""
    if hidden.table:
        return replace(hidden, sigma=sigmas(trials, hidden))
    sign = math.copysign(1.0, hidden.amplitude)

    def scaled(amplitude: float) -> Hidden:
        return replace(hidden, amplitude=sign * amplitude)

    found = scaled(
        reaching(lambda a: sigmas(trials, scaled(a)), target, largest=LARGEST[hidden.name], steps=12)
    )
    return replace(found, sigma=sigmas(trials, found))
