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
FRAME = float(np.radians(2.0))  # rotation of the cameras' frame relative to the beam's, per trial [rad]
POSITION = 1e-3  # position of a marker on the beam, in x and z [m]
ZERO = 2e-3  # zero of a marker's displacement [m]; its first sample determines it better
TWIST = 0.02  # twist of the tip at equilibrium, since a mass does not hang exactly in the middle [rad]
CORRECTION = 0.2  # error of the FEM correction of markers, as a fraction of it
EQUILIBRIUM = (
    0.003  # error of the reduced beam's equilibrium relative to its vibration, as a fraction, per load
)
# Drop of the tip of a beam that is held by hand and not straight, in the shape of its equilibrium [m]: a
# nuisance of time-dependent fits, where the static modulus differs from that of the vibration.
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
    """Nuisance columns, one standard deviation each [m], shape (rows, k), and their names ("" for most).

    A quantity that changes the frequency is not a nuisance: its effect on the phase of the last periods is
    not linear. Errors of length, section or density are effects, or are absorbed by the modulus.

    Parameters
    ----------
    records : the records.
    parameters, release_times, corrections : one per record.
    simulated : function from the index of a record and parameters to its simulated rows.
    over_time : True if the materials have a relaxation spectrum.
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
    """Cosine and sine of the rotation of each row's marker, shape (rows,)."""
    q = free_vibration(parameters).coordinates(record.time - release_time)
    rotations = beam_markers(parameters, q, record.positions).rotation
    none = np.zeros((len(record.positions), 2))
    after = record.time > release_time
    at = record.rows(lambda i: np.column_stack([rotations[i] * after] * 2), none)
    return np.cos(at), np.sin(at)


def discrepancies(records: Sequence[Record]) -> Mapping[str, Array]:
    """Discrepancy basis: sets of columns (rows, k) [m].

    drifts : for the outer markers of each trial, polynomials in the logarithm of time.
    vibrations : for the outer markers, oscillations at the frequency and twice the frequency with several
        envelopes.
    markers : for each marker, a constant and a logarithm of time.
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
