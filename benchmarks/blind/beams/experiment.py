"""Write an experiment folder (docs/reference/experiment-format.md) from a case's true silhouettes.

Contour noise and one registration error per photograph are drawn from the case's seed when it is written.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from benchmarks.blind.beams.cases import TIMES, Case, Trial, seen
from benchmarks.blind.beams.detectability import CORRELATION, OUTLINE_SD, ROLL_SD, SCALE_SD, SHIFT_SD, trace
from benchmarks.blind.beams.ideal_beams import LENGTHS, RADIUS

Array = NDArray[np.float64]
SIDES = ("upper", "lower")


def write_experiment(case: Case, edges: Array, folder: Path, *, noise: bool = True) -> None:
    """Write experiment.yaml and one table per photograph, without any of the truth.

    `edges` are those of `solve_case`; `noise` False omits contour noise and registration errors.
    """
    rng = np.random.default_rng([case.seed, case.index, 2])
    (folder / "beams").mkdir(parents=True)
    trials = []
    for k, trial in enumerate(case.trials):
        captures = []
        for photograph, time in enumerate(TIMES):
            name = f"beams/{trial.id}-t{time:.0f}.csv"
            clean = seen(case, edges, k, photograph, jittered(trace(trial.kind), rng))
            text = as_traced(clean, rng) if noise else _table(clean)
            (folder / name).write_text(text, encoding="utf-8")
            captures.append(capture(name, time))
        trials.append(entry_of(trial, captures))
    experiment = {
        "format": 1,
        "name": f"blind-{case.index:03d}",
        "notes": "silicone cylinders under their own weight, made by a solver that is not under test",
        "materials": {
            name: {
                "softener_ratio": float(name[1:]),
                "density_kg_m3": round(density, 1),
                "density_sd_kg_m3": 5.0,
            }
            for name, density in case.stated.items()
        },
        "trials": trials,
    }
    text = yaml.safe_dump(experiment, sort_keys=False)
    (folder / "experiment.yaml").write_text(text, encoding="utf-8")


def rewrite_tables(folder: Path, moved: Callable[[Array], Array]) -> None:
    """Replace each edge (k, 2) [m] of each photograph by `moved` of it."""
    for path in sorted((folder / "beams").glob("*.csv")):
        _, *rows = path.read_text(encoding="utf-8").splitlines()
        points = {side: [r.split(",")[1:] for r in rows if r.startswith(side)] for side in SIDES}
        edges = [moved(1e-3 * np.array(points[side], dtype=float)) for side in SIDES]
        path.write_text(_table(np.stack(edges)), encoding="utf-8")


def jittered(s: Array, rng: np.random.Generator) -> Array:
    """Traced positions with the inner points moved at random by up to 5 % of the smallest spacing."""
    moved = s.copy()
    moved[1:-1] += 0.05 * np.diff(s).min() * rng.uniform(-1, 1, len(s) - 2)
    return moved


def as_traced(edges: Array, rng: np.random.Generator) -> str:
    """Table of a photograph from its edges (2, k, 2) [m], with contour noise and a registration error."""
    return _table(_registered(_noisy(edges, rng), rng))


def _noisy(edges: Array, rng: np.random.Generator) -> Array:
    """Move each edge along its normal by a smooth random error."""
    moved = np.empty_like(edges)
    for side, edge in enumerate(edges):
        apart = np.hypot(*np.diff(edge, axis=0).T)
        at = np.concatenate([[0.0], np.cumsum(apart)])
        kernel = np.exp(-((at[:, None] - at) ** 2) / (2 * CORRELATION**2)) + 1e-8 * np.eye(len(at))
        error = OUTLINE_SD * np.linalg.cholesky(kernel) @ rng.standard_normal(len(at))
        tangent = np.gradient(edge, at, axis=0)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) / np.hypot(*tangent.T)[:, None]
        moved[side] = edge + error[:, None] * normal
    return moved


def _registered(edges: Array, rng: np.random.Generator) -> Array:
    """Scale and rotate the edges about the frame's origin and shift them, at random."""
    shift, turn = SHIFT_SD * rng.standard_normal(2), ROLL_SD * rng.standard_normal()
    scale = 1 + SCALE_SD * rng.standard_normal()
    c, s = np.cos(turn), np.sin(turn)
    return np.asarray(scale * edges @ np.array([[c, s], [-s, c]]) + shift)


def _table(edges: Array) -> str:
    lines = ["side,x_mm,z_mm"]
    for side, edge in zip(SIDES, edges, strict=True):
        lines += [f"{side},{1e3 * x:.4f},{1e3 * z:.4f}" for x, z in edge]
    return "\n".join(lines) + "\n"


def capture(name: str, time: float) -> dict[str, object]:
    return {
        "time_s": time,
        "outline": name,
        "outline_sd_mm": 1e3 * OUTLINE_SD,
        "outline_correlation_mm": 1e3 * CORRELATION,
        "registration_sd": {"shift_mm": 1e3 * SHIFT_SD, "roll_deg": 0.15, "scale": SCALE_SD},
    }


def entry_of(trial: Trial, captures: list[dict[str, object]]) -> dict[str, object]:
    length, bridge = LENGTHS[trial.kind]
    return {
        "id": trial.id,
        "kind": "beam",
        "material": trial.material,
        "specimen": trial.specimen,
        "section": {"circle": {"radius_mm": 1e3 * RADIUS, "radius_sd_mm": 0.05}},
        "free_length_mm": round(1e3 * length, 3),
        "free_length_sd_mm": 0.2,
        "grip_length_mm": 20.0,
        "supports": "clamped-clamped" if bridge else "clamped-free",
        "gravity_m_s2": [0.0, 0.0, -9.81],
        "captures": captures,
    }
