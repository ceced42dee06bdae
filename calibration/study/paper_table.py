"""The paper's table of calibration results: simulated bodies at a fit's parameters against measured ones."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from calibration import metrics
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment
from calibration.measurements.outlines import REFERENCE, beam_scene
from calibration.measurements.outlines.dice import MeasuredBody, measured_bodies
from calibration.measurements.outlines.setup import Setup
from calibration.shape import body_between, body_mesh
from calibration.study import Calibration, OnSetup, usable
from tisim import Material, Result, laws, simulate
from tisim.mesh import unfold

if TYPE_CHECKING:
    import trimesh

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Printed:
    """One printed row, in the paper's units: mm, ratio, percent, and seconds of one simulation."""

    surface_distance_mm: float
    hd95_mm: float
    dice: float
    volume_difference_percent: float
    time_s: float


@cache
def printed() -> dict[tuple[str, str], Printed]:
    """Rows by (law, mixture): six laws, mixtures S0, S0.5 and S1."""
    text = files("calibration.study").joinpath("paper.csv").read_text(encoding="utf-8")
    return {
        (r["law"], r["mixture"]): Printed(**{f.name: float(r[f.name]) for f in fields(Printed)})
        for r in csv.DictReader(text.splitlines())
    }


def fits_folder(folder: Path) -> Path:
    """The folder of fits in what was given: calibration.fit's OUT, or OUT/fits itself.

    InputError where neither holds a fit, finished or begun.
    """
    if not folder.is_dir():
        raise InputError(f"--fits {folder}: expected a folder that calibration.fit wrote")
    for place in (folder / "fits", folder):
        if place.is_dir() and any(p.suffix in (".json", ".jsonl") for p in place.iterdir()):
            return place
    raise InputError(
        f"--fits {folder}: expected a folder that calibration.fit wrote, with fits/MATERIAL-LAW.json in it"
    )


def read_fit(folder: Path, experiment: Experiment, material: str, label: str) -> Calibration | None:
    """The finished fit of a law, None where there is none.

    InputError where the file is no fit, or one of other data, another material, another law or another rig
    than the experiment's (`OnSetup`).
    """
    path = folder / f"{material}-{label}.json"
    if not path.exists():
        return None
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        header = data["header"]
        digest, rig, rig_file = header["data"], header.get("rig"), header.get("rig_file")
        fit = Calibration.from_json(data["calibration"])
        if fit.parameters:
            laws.get(fit.law).check(fit.parameters)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: expected a fit that calibration.fit wrote ({type(error).__name__}: {error})"
        ) from error
    if digest != experiment.digest:
        raise InputError(
            f"{path}: header.data: expected a fit of {experiment.folder}, this one is of other or older data"
        )
    if (fit.material, fit.label) != (material, label):
        raise InputError(f"{path}: expected {label} of {material}, it holds {fit.label} of {fit.material}")
    known = experiment.setup.digest if isinstance(experiment, OnSetup) else None
    if rig != known:
        made = f"that it was made with, {rig_file}" if rig_file else "that it was made with"
        raise InputError(
            f"{path}: header.rig: expected the same --rig {made}"
            if rig
            else f"{path}: header.rig: expected no --rig, since this fit was made without one"
        )
    return fit


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Means over the photographs of a beam, then over the beams.

    Attributes
    ----------
    surface_distance, hd95 : float
        [m]
    dice, volume_difference : float
        Ratios.
    node_distance, node_hd95 : float
        As `metrics.vertex_distance` has it, all nodes of the simulated volume mesh against the vertices of
        the swept body [m]: what the paper's figures look like (studies/metrics).
    beam_seconds : float
        Core time of one simulated beam.
    further : mapping
        Values of the metrics that were registered from outside, by name, SI.
    """

    surface_distance: float
    hd95: float
    dice: float
    volume_difference: float
    node_distance: float
    node_hd95: float
    beam_seconds: float
    further: Mapping[str, float] = field(default_factory=dict)


FIELDS = tuple(f.name for f in fields(Measures) if f.name != "further")


@dataclass(frozen=True, kw_only=True)
class Row:
    """A law on a mixture. status: of its fit, or "no fit"; message: why measures are missing, or the fit's.

    shear_modulus [Pa]; candidate_seconds, fit_seconds: core time; wall_seconds: of the whole fit.
    mixture: the paper's name where the lab states a softener ratio, else the material's.
    """

    law: str
    material: str
    mixture: str
    status: str
    message: str
    measures: Measures | None
    paper: Printed | None
    shear_modulus: float = float("nan")
    candidate_seconds: float = float("nan")
    fit_seconds: float = float("nan")
    wall_seconds: float = float("nan")


def traced_beams(experiment: Experiment, material: str) -> list[BeamTrial]:
    """Beams of a material with at least one traced outline."""
    own = [t for t in experiment.trials if t.material == material]
    return [t for t in own if isinstance(t, BeamTrial) and t.traced]


def row(
    law: str,
    fit: Calibration | None,
    experiment: Experiment,
    material: str,
    bodies: Mapping[str, Sequence[MeasuredBody]],
    *,
    workers: int | None = None,
) -> Row:
    """The row of a law; bodies: of each traced beam, by trial id (see `measured`)."""
    ratio = experiment.materials[material].softener_ratio
    mixture = material if ratio is None else f"S{ratio:g}"
    paper = printed().get((law, mixture))
    if fit is None:
        return Row(
            law=law,
            material=material,
            mixture=mixture,
            status="no fit",
            message="not fitted",
            measures=None,
            paper=paper,
        )
    found, message = None, fit.message
    if usable(fit):
        density = experiment.materials[material].density
        assert density is not None  # a fit to outlines is refused without one
        trials = traced_beams(experiment, material)
        setup = experiment.setup if isinstance(experiment, OnSetup) else None
        found, trouble = measure(fit, trials, bodies, density=density, setup=setup, workers=workers)
        message = "; ".join(m for m in (fit.message, trouble, fit.note) if m)
    return Row(
        law=law,
        material=material,
        mixture=mixture,
        status=fit.status,
        message=message,
        measures=found,
        paper=paper,
        shear_modulus=fit.shear_modulus,
        candidate_seconds=fit.candidate_seconds,
        fit_seconds=fit.search_seconds + fit.polish_seconds,
        wall_seconds=fit.wall_seconds,
    )


def measured(experiment: Experiment, material: str) -> dict[str, list[MeasuredBody]]:
    """Swept bodies of each traced beam of a material, by trial id."""
    return {t.id: measured_bodies(t) for t in traced_beams(experiment, material)}


def measure(
    fit: Calibration,
    trials: Sequence[BeamTrial],
    bodies: Mapping[str, Sequence[MeasuredBody]],
    *,
    density: float,
    setup: Setup | None = None,
    workers: int | None = None,
) -> tuple[Measures | None, str]:
    """Measures of a fit, or None and the reason: a beam without equilibrium, a body that crosses itself.

    Beams are simulated on a fine mesh (REFERENCE), as the lab states them (density [kg/m3]) and the known
    setup of its rig and camera makes them: no nuisance of the fit is used, and photographs lie where they
    were registered; the figures hold those errors too.
    """
    material = Material(law=fit.law, parameters=fit.parameters)
    scenes = [beam_scene(t, material, density=density, fidelity=REFERENCE) for t in trials]
    if setup is not None:
        scenes = [setup.bend(beam, t) for beam, t in zip(scenes, trials, strict=True)]
    results = simulate(scenes, workers=workers)
    for trial, result in zip(trials, results, strict=True):
        if not result.ok:
            return None, f"{trial.id}: {result.status} at the fitted parameters: {result.message}"
    beams = []
    for trial, result in zip(trials, results, strict=True):
        seen = None if setup is None else _Seen.of(result, trial, setup)
        try:
            beams.append(_beam(result, bodies[trial.id], seen))
        except InputError as error:
            return None, f"{trial.id}: {error}"
    return _mean_measures(beams), ""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Seen:
    """Visible part of a simulated beam in photographs of a known setup: nothing behind the grips' faces.

    Images move and turn sections, but do not enlarge them: of a measured body only the mid line is traced.
    """

    setup: Setup
    trial: BeamTrial
    line: Array  # mid line, x and z [m], shape (k, 2)

    @classmethod
    def of(cls, result: Result, trial: BeamTrial, setup: Setup) -> _Seen:
        mesh, x = unfold(result.mesh, result.positions[-1])
        _, section, count = np.unique(mesh.nodes[:, 0].round(7), return_inverse=True, return_counts=True)
        middle = [np.bincount(section, weights=x[:, i]) / count for i in (0, 2)]
        fine = np.linspace(0.0, len(count) - 1.0, FINE)
        line = [np.interp(fine, np.arange(len(count)), m) for m in middle]
        return cls(setup=setup, trial=trial, line=np.column_stack(line))

    def faces(self) -> tuple[float, float]:
        """Positions along the scene's x of the grips' faces [m]; infinite where no beam is behind them."""
        shown = self.setup.image(self.line, self.trial)[:, 0]
        far = self.trial.free_length if self.trial.supports == "clamped-clamped" else np.inf
        # faces are near the ends, where the line runs along x
        first = int(np.argmax(shown >= -ROUNDING))
        last = len(shown) - 1 - int(np.argmax(shown[::-1] <= far + ROUNDING))
        x = self.line[:, 0]
        return x[first] if first else -np.inf, x[last] if last < len(shown) - 1 else np.inf

    def body(self, body: trimesh.Trimesh) -> trimesh.Trimesh:
        found = body_between(body, *self.faces())
        found.vertices = self._image(np.asarray(found.vertices))
        return found

    def nodes(self, nodes: Array) -> Array:
        first, last = self.faces()
        return self._image(nodes[(nodes[:, 0] >= first) & (nodes[:, 0] <= last)])

    def _image(self, points: Array) -> Array:
        shown = self.setup.image(self.line, self.trial)
        turn = _angle(shown) - _angle(self.line)
        near = cKDTree(self.line).query(points[:, [0, 2]])[1]
        away = points[:, [0, 2]] - self.line[near]
        c, s = np.cos(turn[near]), np.sin(turn[near])
        x, z = shown[near].T + np.array([c * away[:, 0] - s * away[:, 1], s * away[:, 0] + c * away[:, 1]])
        return np.column_stack([x, points[:, 1], z])


FINE = 4001  # points of a mid line: at most 0.05 mm apart
ROUNDING = 1e-6  # of a position [m]


def _angle(line: Array) -> Array:
    along = np.gradient(line, axis=0)
    return np.asarray(np.unwrap(np.arctan2(along[:, 1], along[:, 0])))


def _beam(result: Result, photographs: Sequence[MeasuredBody], seen: _Seen | None) -> Measures:
    """Measures of one beam, mean over its photographs."""
    simulated = body_mesh(result)
    _, nodes = unfold(result.mesh, result.positions[-1])
    if seen is not None:
        simulated, nodes = seen.body(simulated), seen.nodes(nodes)
    found = []
    for photograph in photographs:
        values = metrics.compare(simulated, photograph.body)
        vertices = np.asarray(photograph.body.vertices)
        found.append(
            Measures(
                **{n: values.pop(n) for n in ("surface_distance", "hd95", "dice", "volume_difference")},
                node_distance=metrics.vertex_distance(nodes, vertices),
                node_hd95=metrics.vertex_hd95(nodes, vertices),
                beam_seconds=result.cost.core_seconds,
                further=values,
            )
        )
    return _mean_measures(found)


def _mean_measures(several: Sequence[Measures]) -> Measures:
    return Measures(
        **{name: float(np.mean([getattr(m, name) for m in several])) for name in FIELDS},
        further={n: float(np.mean([m.further[n] for m in several])) for n in several[0].further},
    )


def averages(rows: Sequence[Row]) -> list[Row]:
    """One more row a law, "average" over its mixtures, where every one of them has measures."""
    found = []
    for law in dict.fromkeys(r.law for r in rows):
        mine = [r for r in rows if r.law == law]
        have = [r.measures for r in mine if r.measures]
        if len(mine) < 2 or len(have) < len(mine):
            continue
        papers = [r.paper for r in mine if r.paper]
        found.append(
            Row(
                law=law,
                material="average",
                mixture="average",
                status="",
                message="",
                measures=_mean_measures(have),
                paper=_mean_printed(papers) if len(papers) == len(mine) else None,
                **{
                    name: float(np.mean([getattr(r, name) for r in mine]))
                    for name in ("candidate_seconds", "fit_seconds", "wall_seconds")
                },
            )
        )
    return found


def _mean_printed(values: Sequence[Printed]) -> Printed:
    return Printed(**{f.name: float(np.mean([getattr(v, f.name) for v in values])) for f in fields(Printed)})
