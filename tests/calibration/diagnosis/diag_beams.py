"""Small photographed beams for tests of the outline model: two cantilevers and, optionally, bridges.

tisim simulates them on the mesh that the model uses: the tests check how effects, noise and nuisances enter
the model, not the simulator.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from numpy.typing import NDArray
from photograph_errors import photographed

import tisim
from calibration.diagnosis.catalogue import effects_of
from calibration.experiment import read
from calibration.experiment.model import Experiment
from calibration.measurements.outlines import COARSE
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.simulators import TISIM, Simulator
from tisim.mesh import outline

Array = NDArray[np.float64]

SHEAR = 25e3
Change = Callable[[tisim.Beam, float], tisim.Beam]


def tiny(
    folder: Path,
    *,
    lengths_mm: Sequence[float] = (50.0, 100.0),
    bridges_mm: Sequence[float] = (),
    times: Sequence[float] = (10.0,),
    shears: Sequence[float] = (SHEAR,),
    change: Change = lambda beam, _: beam,
    noise: float = 0.0,
    seed: int = 0,
    sure: bool = True,
) -> Experiment:
    """Write and read an experiment with one material for each shear modulus (S0, S1, ...).

    `noise` scales all errors. `change` applies the fault of a beam at a time [s]. With `sure`, radius, length
    and density are known exactly.
    """
    rng = np.random.default_rng([3, seed])
    trials, tables = [], {}
    materials = {}
    for k, shear in enumerate(shears):
        name = f"S{k}"
        belief = {"density_kg_m3": 1000.0} | ({} if sure else {"density_sd_kg_m3": 5.0})
        materials[name] = belief
        for length, bridge in [(x, False) for x in lengths_mm] + [(x, True) for x in bridges_mm]:
            identifier = f"{name}-{'bridge' if bridge else 'cantilever'}-{length:.0f}"
            supports = "clamped-clamped" if bridge else "clamped-free"
            beam = tisim.Beam(
                material=tisim.material_from_moduli(
                    "neo-hookean", shear_modulus=shear, bulk_modulus=300.0 * shear
                ),
                length=length / 1e3,
                supports=supports,  # type: ignore[arg-type]
                element=COARSE.element,  # type: ignore[arg-type]
                axial_element_size=COARSE.axial_element_size,
                radial_elements=COARSE.radial_elements,
                solver=COARSE.solver,
            )
            captures = []
            for time in times:
                (result,) = tisim.simulate([change(beam, time)], workers=1)
                assert result.ok
                file = f"beams/{identifier}-{time:.0f}.csv"
                tables[file] = outline_columns(*photographed(_edges(result), rng, noise, _contour_error))
                captures.append(capture_entry(time, file))
            entry = beam_entry(
                identifier,
                material=name,
                specimen=name,
                free_length_mm=length,
                supports=supports,
                captures=captures,
            )
            if sure:
                entry["section"] = {"circle": {"radius_mm": 10.0}}
                del entry["free_length_sd_mm"]
            trials.append(entry)
    return read(write_experiment(folder, trials, tables=tables, materials=materials))


def _edges(result: tisim.Result) -> list[Array]:
    """Upper and lower edge [mm] at points some 1.3 mm apart, without the end points."""
    assert isinstance(result.scene, tisim.Beam)
    seen = outline(result.mesh, result.positions[-1])
    free = (seen.x >= -1e-9) & (seen.x <= result.scene.length + 1e-9)
    found = []
    for line in (seen.upper[free], seen.lower[free]):
        t = np.arange(len(line)) / 2.0  # mid-side nodes have odd indices: one quadratic per three nodes
        at = np.linspace(0.0, t[-1], int(1e3 * result.scene.length / 1.3))[1:-1]
        k = 2 * np.minimum(at.astype(int), len(line) // 2 - 1)
        s = (at - k / 2.0)[:, None]
        a, b, c = line[k], line[k + 1], line[k + 2]
        found.append(1e3 * (a * (1 - s) * (1 - 2 * s) + 4 * b * s * (1 - s) + c * s * (2 * s - 1)))
    return found


def _contour_error(correlations: Array, sd: float, rng: np.random.Generator) -> Array:
    C = correlations + 4e-4 * np.eye(len(correlations))
    return np.asarray(sd * np.linalg.cholesky(C) @ rng.standard_normal(len(C)))


def beam_model(
    made: Experiment,
    *,
    simulator: Simulator = TISIM,
    without: Sequence[str] = (),
    workers: int | None = None,
) -> OutlineModel:
    """Model with the catalogue's effects."""
    effects = {n: e for n, e in effects_of("outlines").items() if n not in without}
    return OutlineModel(made, effects=effects, simulator=simulator, workers=workers)  # type: ignore[arg-type]
