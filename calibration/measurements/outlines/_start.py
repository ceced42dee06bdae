"""Shear moduli to begin from: a coarse scan of those of soft materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calibration.measurements._baseline import Baseline
from calibration.measurements._state import State
from calibration.measurements.outlines._photographs import TracedPhotograph, distances, projections_of
from calibration.measurements.outlines._solutions import SolutionCache

SCAN = np.geomspace(3e5, 3e3, 9)  # shear moduli to begin from, stiff to soft [Pa]


def scanned_moduli(
    baseline: Baseline, photographs: Sequence[TracedPhotograph], solutions: SolutionCache
) -> dict[str, float]:
    """Shear modulus of each specimen [Pa] whose simulated edges are nearest to the traced points.

    The scan goes from stiff to soft and ends after the best modulus, since beams that are far too soft are
    expensive or have no equilibrium. ValueError if a specimen has no equilibrium.
    """
    names = baseline.specimens
    best, found = dict.fromkeys(names, np.inf), dict.fromkeys(names, float(SCAN[0]))
    left = set(names)  # specimens that the last modulus brought nearer
    for shear in SCAN:
        state = State(u=baseline.start(dict.fromkeys(names, float(shear))))
        cost = dict.fromkeys(left, 0.0)
        seen = [p for p in photographs if p.specimen in left]
        results = replace(solutions, photographs=seen).solve([state])[0]
        for p, r in zip(seen, results, strict=True):
            cost[p.specimen] += np.inf if r is None else float(np.sum(distances(projections_of(p, r)) ** 2))
        left = {n for n in left if cost[n] < best[n]}
        for n in left:
            best[n], found[n] = cost[n], float(shear)
        if not left:
            break
    if not all(np.isfinite(b) for b in best.values()):
        raise ValueError("no shear modulus from 3 to 300 kPa gives every beam an equilibrium")
    return found
