"""Nuisances of cantilever releases, and their discrepancy basis: columns [m] in the rows of all records."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._basis import Columns
from calibration.measurements.release._beam import BeamParameters
from calibration.measurements.release._fem import Correction
from calibration.measurements.release._record import FIRST, LAST, Record
from calibration.measurements.release._vibration import beam_markers, free_vibration

Array = NDArray[np.float64]

# Standard deviations.
FRAME = float(np.radians(2.0))  # of the cameras' frame against the beam's, a trial [rad]
POSITION = 1e-3  # of a marker on the beam, in x and z [m]
ZERO = 2e-3  # of a marker's displacement before the release, which its first sample knows better [m]
TWIST = 0.02  # of the tip about the beam's axis at equilibrium: no mass hangs exactly in the middle [rad]
CORRECTION = 0.2  # fraction of the markers' correction by FEM
EQUILIBRIUM = (
    0.003  # fraction of the equilibrium by which the reduced beam may err beside its vibration, a load
)
# Drop of the tip by which a beam that is held by hand is not straight, in the shape of its equilibrium [m]: a
# nuisance of fits over time, where the modulus at rest is another than that of the vibration.
HELD = 3e-4


def nuisance_columns(
    records: Sequence[Record],
    parameters: Sequence[BeamParameters],
    release_times: Sequence[float],
    corrections: Sequence[Correction],
    simulated: Callable[[int, BeamParameters], Array],
    *,
    over_time: bool = False,
) -> tuple[Array, list[str]]:
    """One standard deviation of each nuisance, shape (rows, k) [m], and their names, "" for most.

    What changes the frequency is no nuisance: it moves the phase of the last periods by more than is linear.
    A length, a section or a density other than stated is an effect, or goes into the modulus.

    Parameters
    ----------
    parameters, release_times, corrections : of each record.
    simulated : rows of a record, by its index, with these parameters.
    over_time : the materials have a relaxation spectrum.
    """
    starts = np.cumsum([0, *(r.points for r in records)])
    shared: dict[object, Array] = {}

    def add(name: object, k: int, values: Array) -> None:
        column = shared.setdefault(name, np.zeros(int(starts[-1])))
        column[starts[k] : starts[k + 1]] += values

    for k, (r, s) in enumerate(zip(records, parameters, strict=True)):
        marker, axis, time = r.labels()
        held = ~np.isfinite(time)
        base = simulated(k, s)
        z_rows, x_rows = axis == 1, axis == 0
        other = np.empty_like(base)
        other[z_rows], other[x_rows] = -base[x_rows], base[z_rows]
        add(("frame", k), k, FRAME * other)
        c, n = _rotated(r, s, release_times[k])
        for i, name in enumerate(r.names):
            mine = marker == i
            key = (r.specimen, name)
            add(("x", *key), k, POSITION * mine * np.where(z_rows, n, c - 1.0))
            add(("z", *key), k, POSITION * mine * np.where(z_rows, c - 1.0, -n))
            for a, rows in enumerate((x_rows, z_rows)):
                add(("zero", k, i, a), k, ZERO * (mine & rows))
        twist = np.zeros(len(base))
        for i in range(len(r.names)):
            mine = (marker == i) & z_rows
            tip = (marker == int(np.argmax(r.outer))) & z_rows
            if mine.sum() == tip.sum():
                x = min(max(r.positions[i][0], 0.0) / s.length, 1.0)
                twist[mine] = r.across[i] * x * base[tip] / corrections[k].drop
        add(("twist", k), k, TWIST * twist)
        correction, equilibrium = np.zeros(len(base)), np.zeros(len(base))
        for i in range(len(r.names)):
            for a, rows in enumerate((x_rows, z_rows)):
                after = (marker == i) & rows & ~held
                correction[after] = corrections[k].markers[i, a]
                equilibrium[after] = r.equilibrium[i, a] * (not r.near_clamp[i])
        add("correction", k, CORRECTION * correction)
        add(("equilibrium", round(r.parameters.tip_mass, 4)), k, EQUILIBRIUM * equilibrium)
        if over_time:
            add(f"{r.name}: held below straight", k, HELD / corrections[k].drop * equilibrium)
    kept = {name: v for name, v in shared.items() if v.any()}
    return np.column_stack([*kept.values()]), [n if isinstance(n, str) and ":" in n else "" for n in kept]


def _rotated(record: Record, parameters: BeamParameters, release_time: float) -> tuple[Array, Array]:
    """Cosine and sine, row by row, of the rotation of what carries the marker."""
    q = free_vibration(parameters).coordinates(record.time - release_time)
    rotations = beam_markers(parameters, q, record.positions).rotation
    none = np.zeros((len(record.positions), 2))
    after = record.time > release_time
    at = record.rows(lambda i: np.column_stack([rotations[i] * after] * 2), none)
    return np.cos(at), np.sin(at)


def discrepancies(records: Sequence[Record]) -> Mapping[str, Array]:
    """Sets of columns (rows, k) [m].

    drifts : of each trial's tip, polynomials in the logarithm of time. vibrations : of each trial's tip, at
    its frequency and twice that, growing and decaying. markers : of each marker, a constant and a logarithm
    of time.
    """
    columns = Columns([r.points for r in records])
    for k, r in enumerate(records):
        marker, axis, time = r.labels()
        after = np.isfinite(time)
        t = np.where(after, time, 1.0)
        log = np.log10(t / (FIRST * r.period)) - 1.0
        tips = r.outer[marker]
        for a in range(2):
            hit = after & tips & (axis == a)
            for degree in range(4):
                columns.add("drifts", [(k, np.where(hit, log**degree, 0.0))])
            for order in (1.0, 2.0):
                phase = 2.0 * np.pi * order * t / r.period
                decay = np.exp(-order * r.damping_ratio * 2.0 * np.pi * t / r.period)
                early = hit & (t <= LAST * r.period)
                for power in range(3):
                    envelope = decay * (t / (LAST * r.period)) ** power
                    columns.add("vibrations", [(k, np.where(early, envelope * np.cos(phase), 0.0))])
                    columns.add("vibrations", [(k, np.where(early, envelope * np.sin(phase), 0.0))])
            for i in range(len(r.names)):
                mine = after & (marker == i) & (axis == a)
                columns.add("markers", [(k, mine.astype(float))])
                columns.add("markers", [(k, np.where(mine, log, 0.0))])
    return {name: 1e-3 * raw for name, raw in columns.by_name().items()}
