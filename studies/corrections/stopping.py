"""The stopping rule's rows: the modulus that takes shapes it stopped for those that were photographed."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

import tisim
from calibration.measurements.outlines import COARSE
from studies.corrections.bench import MIXTURES, Beams, note, percent, signed
from studies.corrections.fits import default_fit, material
from studies.corrections.shortcuts import DAMPINGS, Stopped

Array = NDArray[np.float64]

FACTORS = np.geomspace(0.22, 1.3, 7)  # of the default fit's modulus: where runs are made


def stop() -> list[list[str]]:
    """Shapes from the paper's rule on a grid of moduli; the modulus that takes them for the photographs."""
    rows = []
    for mixture in MIXTURES:
        shear = default_fit(mixture).shear
        beams = Stopped(mixture, COARSE)
        static = Beams.simulate(beams, [material(shear, 300.0)])[0]
        for damping in DAMPINGS:
            beams.damping = damping
            begun = time.process_time()
            runs = beams.simulate([material(f * shear, 300.0) for f in FACTORS])
            each = [invert([r[i] for r in runs], deflection(static[i])) for i in range(len(beams.trials))]
            joint, misfit = nearest(beams, runs)
            cells = [percent(mixture, f * shear) for f in (joint, *each)]
            label = f"{damping[0]:g} / {damping[1]:g}"
            rows.append([mixture, label, *(signed(c) for c in cells), f"{1e3 * misfit:.2f}"])
            note(f"{mixture} {label}: {rows[-1][2:]} ({time.process_time() - begun:.0f} core-s)")
    return rows


def deflection(result: tisim.Result) -> float:
    """Largest way down of any node [m]; NaN without a shape."""
    if not result.ok:
        return float("nan")
    return float((result.mesh.nodes[:, 2] - result.positions[-1][:, 2]).max())


def invert(results: Sequence[tisim.Result], wanted: float) -> float:
    """Factor on the modulus at which the deflection is the wanted one, by interpolation in logarithms;
    NaN where the grid does not hold it exactly once."""
    down = np.array([deflection(r) for r in results])
    good = np.isfinite(down)
    x, y = np.log(FACTORS[good]), np.log(down[good] / wanted)
    crossing = np.flatnonzero(np.signbit(y[1:]) != np.signbit(y[:-1]))
    if len(crossing) != 1:
        return float("nan")
    k = crossing[0]
    return float(np.exp(x[k] - y[k] * (x[k + 1] - x[k]) / (y[k + 1] - y[k])))


def nearest(beams: Stopped, runs: Sequence[Sequence[tisim.Result]]) -> tuple[float, float]:
    """Factor on the modulus of least squared distance over all photographs, and its rms [m]; NaN where it
    lies at an end of the grid. Distances are interpolated between the moduli."""
    good = [k for k, r in enumerate(runs) if all(one.ok for one in r)]
    if len(good) < 3:
        return float("nan"), float("nan")
    known = np.array([beams.distances(runs[k]) for k in good])
    x = np.log(FACTORS[good])
    fine = np.linspace(x[0], x[-1], 2001)
    cost = np.array([(_between(x, known, at) ** 2).mean() for at in fine])
    best = int(cost.argmin())
    if best in (0, len(fine) - 1):
        return float("nan"), float("nan")
    return float(np.exp(fine[best])), float(np.sqrt(cost[best]))


def _between(x: Array, rows: Array, at: float) -> Array:
    k = int(np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2))
    share = (at - x[k]) / (x[k + 1] - x[k])
    return np.asarray((1 - share) * rows[k] + share * rows[k + 1])
