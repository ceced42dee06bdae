"""One row of the table: bodies at a fit's parameters against the bodies that were measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from calibration import metrics
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Experiment
from calibration.outlines import REFERENCE, beam_scene
from calibration.outlines.dice import MeasuredBody, measured_bodies
from calibration.shape import body_mesh
from calibration.study import Calibration, usable
from calibration.table_of_paper.paper import Printed, printed
from tisim import Material, Result, simulate
from tisim.mesh import unfold


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Means over the photographs of a beam, then over the beams. Lengths in m, ratios plain.

    node_distance, node_hd95: as `metrics.vertices` has it, all nodes of the simulated volume mesh against the
        vertices of the swept body: what the paper's figures look like (docs/metrics.md).
    beam_seconds: core time of one simulated beam.
    """

    surface_distance: float
    hd95: float
    dice: float
    volume_difference: float
    node_distance: float
    node_hd95: float
    beam_seconds: float


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
    return [
        t
        for t in experiment.trials
        if isinstance(t, BeamTrial) and t.material == material and any(c.outline for c in t.captures)
    ]


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
        found, trouble = measure(fit, trials, bodies, density=density, workers=workers)
        message = "; ".join(m for m in (fit.message, trouble) if m)
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
    workers: int | None = None,
) -> tuple[Measures | None, str]:
    """Measures of a fit, or None and the reason: a beam without equilibrium, a body that crosses itself.

    Beams are simulated on the fit's reference mesh as the lab states them (density [kg/m3]): no nuisance of
    the fit is used, and photographs lie where they were registered; the figures hold those errors too.
    """
    material = Material(law=fit.law, parameters=fit.parameters)
    scenes = [beam_scene(t, material, density=density, fidelity=REFERENCE) for t in trials]
    results = simulate(scenes, workers=workers)
    for trial, result in zip(trials, results, strict=True):
        if not result.ok:
            return None, f"{trial.id}: {result.status} at the fitted parameters: {result.message}"
    beams = []
    for trial, result in zip(trials, results, strict=True):
        try:
            beams.append(_beam(result, bodies[trial.id]))
        except InputError as error:
            return None, f"{trial.id}: {error}"
    mean = np.mean(beams, axis=0)
    return Measures(**{f.name: float(v) for f, v in zip(fields(Measures), mean, strict=True)}), ""


def _beam(result: Result, photographs: Sequence[MeasuredBody]) -> list[float]:
    """Measures of one beam in the order of `Measures`, mean over its photographs."""
    simulated = body_mesh(result)
    _, nodes = unfold(result.mesh, result.positions[-1])
    found = []
    for photograph in photographs:
        values = metrics.compare(simulated, photograph.body)
        vertices = np.asarray(photograph.body.vertices)
        found.append(
            [
                *(values[n] for n in ("surface_distance", "hd95", "dice", "volume_difference")),
                metrics.vertex_distance(nodes, vertices),
                metrics.vertex_hd95(nodes, vertices),
                result.cost.core_seconds,
            ]
        )
    return [float(v) for v in np.mean(found, axis=0)]


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
                measures=Measures(**_mean(have)),
                paper=Printed(**_mean(papers)) if len(papers) == len(mine) else None,
                **{
                    name: float(np.mean([getattr(r, name) for r in mine]))
                    for name in ("candidate_seconds", "fit_seconds", "wall_seconds")
                },
            )
        )
    return found


def _mean(values: Sequence[Measures] | Sequence[Printed]) -> dict[str, float]:
    names = [f.name for f in fields(values[0])]
    return {n: float(np.mean([getattr(v, n) for v in values])) for n in names}
