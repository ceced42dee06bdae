"""What is not known of a trial and is no cause: columns of one standard deviation each [m]."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.bars._bar import carried, swing
from calibration.diagnosis.bars._fem import Correction
from calibration.diagnosis.bars._record import Record
from calibration.diagnosis.bars._setting import Setting

Array = NDArray[np.float64]

FRAME = float(np.radians(2.0))  # of the cameras' frame against the bar's, a trial
PLACE = 1e-3  # of a marker on the bar, in x and z [m]
ZERO = 2e-3  # of where a marker is counted from; its held sample says it better [m]
TWIST = 0.02  # of the tip about the bar's axis at rest: nothing is hung exactly in the middle [rad]
SHARE = 0.2  # of the markers' correction by FEM
SETTLED = 0.003  # of the settled pose, by which the reduced bar may err beside its swing, a load


def columns_of(
    records: Sequence[Record],
    settings: Sequence[Setting],
    releases: Sequence[float],
    fixes: Sequence[Correction],
    predicted: Callable[[int, Setting], Array],
) -> Array:
    """(rows, k). predicted: rows of a record with a setting.

    What changes the frequency is none of these: it moves the phase of the last swings by more than is linear.
    A length, a section or a density that is not as stated is an effect, or goes into the modulus."""
    sizes = [len(r.measured()) for r in records]
    starts = np.cumsum([0, *sizes])
    shared: dict[object, Array] = {}

    def add(name: object, k: int, values: Array) -> None:
        column = shared.setdefault(name, np.zeros(int(starts[-1])))
        column[starts[k] : starts[k + 1]] += values

    for k, (r, s) in enumerate(zip(records, settings, strict=True)):
        marker, axis, time = r.labels()
        held = ~np.isfinite(time)
        base = predicted(k, s)
        z_rows, x_rows = axis == 1, axis == 0
        other = np.empty_like(base)
        other[z_rows], other[x_rows] = -base[x_rows], base[z_rows]
        add(("frame", k), k, FRAME * other)
        c, n = _turned(r, s, releases[k])
        for i, name in enumerate(r.names):
            mine = marker == i
            key = (r.specimen, name)
            add(("x", *key), k, PLACE * mine * np.where(z_rows, n, c - 1.0))
            add(("z", *key), k, PLACE * mine * np.where(z_rows, c - 1.0, -n))
            for a, rows in enumerate((x_rows, z_rows)):
                add(("zero", k, i, a), k, ZERO * (mine & rows))
        swing_part = np.zeros(len(base))
        for i in range(len(r.names)):
            mine = (marker == i) & z_rows
            tip = (marker == int(np.argmax(r.tips))) & z_rows
            if mine.sum() == tip.sum():
                x = min(max(r.places[i][0], 0.0) / s.length, 1.0)
                swing_part[mine] = r.across[i] * x * base[tip] / fixes[k].drop
        add(("twist", k), k, TWIST * swing_part)
        left = np.zeros(len(base))
        for i in range(len(r.names)):
            for a, rows in enumerate((x_rows, z_rows)):
                left[(marker == i) & rows & ~held] = fixes[k].left[i, a]
        add("correction", k, SHARE * left)
        at_rest = np.zeros(len(base))
        for i in range(len(r.names)):
            for a, rows in enumerate((x_rows, z_rows)):
                at_rest[(marker == i) & rows & ~held] = r.settled[i, a] * (not r.near[i])
        add(("settled", round(r.setting.tip_mass, 4)), k, SETTLED * at_rest)
    return np.column_stack([v for v in shared.values() if v.any()])


def _turned(record: Record, setting: Setting, release: float) -> tuple[Array, Array]:
    """Cosine and sine, row by row, of the turn of what carries the marker."""
    q = swing(setting).coordinates(record.time - release)
    turns = carried(setting, q, record.places).turn
    none = np.zeros((len(record.places), 2))
    after = record.time > release
    at = record.flat(lambda i: np.column_stack([turns[i] * after] * 2), none)
    return np.cos(at), np.sin(at)
