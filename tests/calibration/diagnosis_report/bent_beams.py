"""Two photographs each of two cantilevers with residual curvature from casting, by a planar elastica."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from hanging_beams import elastica

ALONG = np.linspace(0.03, 0.995, 40)  # points of an edge, as fractions of the length


def bent_folder(folder: Path, *, curvature: float, name: str = "long") -> Path:
    draws = np.random.default_rng(2)
    tables, trials = {}, []
    for trial, length in (("short", 0.06), (name, 0.1)):
        captures = []
        for time in (10.0, 100.0):
            exact = elastica(25e3, length, at=ALONG, curvature=curvature)
            edges = [e + 0.05 * draws.standard_normal(e.shape) for e in exact]
            file = f"beams/{len(tables)}.csv"
            tables[file] = outline_columns(*edges)
            captures.append(capture_entry(time, file))
        trials.append(beam_entry(trial, free_length_mm=1e3 * length, captures=captures))
    return write_experiment(folder, trials, tables=tables)
