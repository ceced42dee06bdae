"""Relaxation of meat in indentation: held-out records predicted from the relaxation of another place.

    python -m studies.indentation.meat        # a core-minute; TISIM_MEASURED as in studies/measured.py

The indenter's shape is not stated, so that nothing is simulated: each record's elastic curve is a power law
of the depth, F = f (d / 2 mm)^p, which is fitted to its own loading. The relaxation, fractions of the
long-time modulus at stated times, comes from the whole record of another place; the hold is predicted. Forces
are followed as in a fit (`calibration.measurements.indentation._memory_force`).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from calibration.measurements.indentation._memory_force import loads, stiffnesses, thresholds
from studies.measured import real
from tisim import Prony

Array = NDArray[np.float64]

SET = "meat-indentation-relaxation"
TIMES = tuple(float(t) for t in 10.0 ** np.arange(-1.0, 1.6, 0.5))  # [s]
FRACTION, FRACTION_SD = 0.3, 1.0  # prior of each fraction of the spectrum
SD = 0.01  # of a force, over the largest
REFERENCE = 2e-3  # depth at which a curve's force is stated [m]
AT = (1.0, 5.0, 10.0)  # after the largest force [s]
BEFORE = 4  # rows at rest that the force's zero is taken from


@dataclass(frozen=True, eq=False, kw_only=True)
class Meat:
    """A record: rows of time [s], depth [m] and force over its largest, shape (t,)."""

    name: str
    time: Array
    depth: Array
    force: Array

    @property
    def turn(self) -> int:
        """Row of the largest force."""
        return int(np.argmax(self.force))

    @property
    def cut(self) -> str:
        return self.piece.rstrip("0123456789")

    @property
    def piece(self) -> str:
        """Cut and side."""
        return self.name.split("-")[0]

    def after(self, wait: float) -> float:
        """Force at a time after the largest [s]."""
        return float(np.interp(self.time[self.turn] + wait, self.time, self.force))


@dataclass(frozen=True, eq=False, kw_only=True)
class Fitted:
    """A record's own fit: force at REFERENCE over the largest, power of its curve, fractions at TIMES, and
    forces at its rows (t,)."""

    scale: float
    power: float
    fractions: Array
    force: Array


def read(path: Path) -> Meat:
    """A record of the set."""
    time, depth, force = np.genfromtxt(path, delimiter=",", skip_header=1, unpack=True)
    force = force - np.median(force[:BEFORE])
    return Meat(name=path.stem, time=time, depth=1e-3 * depth, force=force / force.max())


def springs(record: Meat, fractions: Array) -> tuple[Array, Array]:
    """Loads of the springs that its course meets, and the depths at which it does."""
    met = thresholds(float(record.depth.max()))
    spectrum = Prony(fractions=tuple(fractions), times=TIMES).spectrum()
    return loads(spectrum, record.time, record.depth, met[:-1]), met


def curve(met: Array, scale: float, power: float) -> Array:
    """Stiffnesses of the springs of a power law."""
    return stiffnesses(met, scale * (met / REFERENCE) ** power)


def fit(record: Meat) -> Fitted:
    """Curve and relaxation of a record by itself."""

    def force(x: Array) -> Array:
        found, met = springs(record, x[2:])
        return np.asarray(found @ curve(met, float(np.exp(x[0])), float(x[1])))

    def residuals(x: Array) -> Array:
        return np.concatenate([(force(x) - record.force) / SD, (x[2:] - FRACTION) / FRACTION_SD])

    terms = len(TIMES)
    found = least_squares(
        residuals,
        np.concatenate([[np.log(0.2), 1.5], np.full(terms, FRACTION)]),
        bounds=([-10.0, 1.0, *[0.0] * terms], [5.0, 4.0, *[20.0] * terms]),
    )
    return Fitted(
        scale=float(np.exp(found.x[0])), power=float(found.x[1]), fractions=found.x[2:], force=force(found.x)
    )


def predicted(record: Meat, fractions: Array) -> Array:
    """Forces (t,) of a record with another's relaxation: its curve is fitted to its loading alone."""
    found, met = springs(record, fractions)
    rows = slice(record.turn + 1)

    def residuals(x: Array) -> Array:
        force = found[rows] @ curve(met, float(np.exp(x[0])), float(x[1]))
        return np.asarray(force - record.force[rows])

    best = least_squares(residuals, [np.log(0.2), 1.5], bounds=([-10.0, 1.0], [5.0, 4.0]))
    return np.asarray(found @ curve(met, float(np.exp(best.x[0])), float(best.x[1])))


def copied(record: Meat, other: Meat) -> Array:
    """Forces (t,) of a record without any model: after the largest force, another's at the same time after
    it."""
    since = record.time - record.time[record.turn]
    return np.where(since > 0.0, np.interp(since, other.time - other.time[other.turn], other.force), np.nan)


def rms(record: Meat, force: Array) -> float:
    """Root mean square residual in the hold, over the largest force."""
    hold = slice(record.turn + 1, None)
    return float(np.sqrt(np.mean((force[hold] - record.force[hold]) ** 2)))


def of_the_ramp(records: Sequence[Meat], fractions: Array) -> tuple[Array, Array]:
    """Regression of the force AT[1] after the largest on the duration of the loading.

    Slope [1/s] and correlation, shape (2,), as measured and as one relaxation function of all contact points
    predicts them.
    """
    took = np.array([r.time[r.turn] for r in records])
    measured = np.array([r.after(AT[1]) for r in records])
    found = np.array(
        [np.interp(r.time[r.turn] + AT[1], r.time, predicted(r, fractions)) for r in records], dtype=float
    )
    lines = [np.array([np.polyfit(took, y, 1)[0], np.corrcoef(took, y)[0, 1]]) for y in (measured, found)]
    return lines[0], lines[1]


def _spread(values: Sequence[float]) -> str:
    low, middle, high = np.percentile(100.0 * np.asarray(values), [10.0, 50.0, 90.0])
    return f"{middle:.2f} ({low:.2f} to {high:.2f})"


def main() -> int:
    records = [read(p) for p in sorted(real(SET, "records").glob("*.csv"))]
    fits = [fit(r) for r in records]
    print("rms in the hold, % of the largest force: median (10 % to 90 % of the records or pairs)\n")
    print("| relaxation from | pairs | predicted | copied without a model |\n| --- | --- | --- | --- |")
    own = [rms(r, f.force) for r, f in zip(records, fits, strict=True)]
    print(f"| the record itself (fitted) | {len(own)} | {_spread(own)} | |")
    pairs = [
        (a, b, rms(a, predicted(a, f.fractions)), rms(a, copied(a, b)))
        for a in records
        for b, f in zip(records, fits, strict=True)
        if a is not b
    ]
    groups = {
        "another place of the same piece": [p for p in pairs if p[0].piece == p[1].piece],
        "another piece of the same cut": [
            p for p in pairs if p[0].cut == p[1].cut and p[0].piece != p[1].piece
        ],
        "the other cut": [p for p in pairs if p[0].cut != p[1].cut],
    }
    for name, some in groups.items():
        print(f"| {name} | {len(some)} | {_spread([p[2] for p in some])} | {_spread([p[3] for p in some])} |")
    means = [
        rms(
            a,
            predicted(a, np.mean([f.fractions for b, f in zip(records, fits, strict=True) if b is not a], 0)),
        )
        for a in records
    ]
    print(f"| the mean of all others | {len(means)} | {_spread(means)} | |\n")
    print("Scatter of places: force over the largest, mean and sd; and what is left of it when the mean of")
    print("all others predicts it\n\n| after | measured | error of the prediction |\n| --- | --- | --- |")
    for wait in AT:
        here = np.array([r.after(wait) for r in records])
        left = []
        for k, r in enumerate(records):
            others = np.mean([f.fractions for j, f in enumerate(fits) if j != k], 0)
            force = predicted(r, others)
            left.append(float(np.interp(r.time[r.turn] + wait, r.time, force)) - r.after(wait))
        print(
            f"| {wait:g} s | {here.mean():.3f} ± {here.std(ddof=1):.3f} |"
            f" {np.mean(left):+.3f} ± {np.std(left, ddof=1):.3f} |"
        )
    spectra = np.array([f.fractions for f in fits])
    measured, found = of_the_ramp(records, spectra.mean(0))
    print(
        f"\nForce {AT[1]:g} s after the largest, over it, a second more of loading: measured"
        f" {measured[0]:+.4f} (correlation {measured[1]:+.2f}), predicted {found[0]:+.4f}"
        f" (correlation {found[1]:+.2f})"
    )
    print("\nFractions of the long-time modulus, mean and sd over places\n")
    print("| " + " | ".join(f"{t:.2g} s" for t in TIMES) + " | power |")
    print("| --- " * (len(TIMES) + 1) + "|")
    cells = [f"{m:.2f} ± {s:.2f}" for m, s in zip(spectra.mean(0), spectra.std(0, ddof=1), strict=True)]
    powers = np.array([f.power for f in fits])
    print("| " + " | ".join(cells) + f" | {powers.mean():.2f} ± {powers.std(ddof=1):.2f} |")
    return 0


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    sys.exit(main())
