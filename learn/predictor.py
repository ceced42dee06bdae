"""Predict pokes with a trained run, from Python.

>>> import learn
>>> predictor = learn.load("runs/quick")
>>> answer = predictor.predict({"site_mm": [5, -10], "depth_mm": 8, "shape": "cube-18", "softness": "S0.5"})
>>> answer.force, answer.displacement.shape, answer.inside
>>> answer.save("prediction")

Both objects print as tables in a notebook, the answer with its picture.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import Store
from learn.errors import InputError, OutsideDomainError
from learn.evaluation import Intervals, join_runs, load_intervals
from learn.models import Response
from learn.models.at_points import respond_at
from learn.points_file import AskedPoints, points_on_top
from learn.prediction import AtPoints, PokePrediction, html_table
from learn.quantities import covariates, poke_values
from learn.real_time import RealTime
from learn.scene_file import PokeInput, PokeScene, kind_of, load_poke, scene_and_poke
from learn.training import Run, check_dataset, known_domain, load_run, open_tables
from learn.validity import Domain, unknown_checks

Floats = NDArray[np.float64]


class Predictor:
    """A trained run, or several as an ensemble, ready to predict pokes.

    Attributes
    ----------
    run : the trained model with its recipe.
    store : the dataset that it was trained on, or its tables alone if it is not at hand (`Store.has_fields`).
    domain : domain of validity; recorded with the checkpoint, or derived from the dataset.
    """

    def __init__(self, run: Run, store: Store) -> None:
        check_dataset(run.uuid, run.folder, store)
        self.run, self.store = run, store
        self.domain = known_domain(run, store)

    def predict(
        self,
        scene: Path | str | Mapping[str, Any] | PokeScene,
        *,
        points: Path | str | Floats | None = None,
        strict: bool = False,
    ) -> PokePrediction:
        """Predict displacement and force of one poke, and compare it with the domain of validity.

        Parameters
        ----------
        scene : keys and values as in `learn.scene_file.PokeScene`, or the path of a YAML file of them.
        points : points of the top face at which the displacement is asked besides the grid's, (x, y), shape
            (n, 2) [m], or the path of a CSV file of them [mm] (`learn.points_file.load_points`).
        strict : refuse pokes that are not inside the domain of validity.

        Raises
        ------
        InputError
            If a key is wrong, the poke does not fit the block, or a point lies beside the top face.
        OutsideDomainError
            If `strict` is set and the poke is outside the domain of validity, or that is not known.
        """
        poke = load_poke(scene)
        where = str(scene) if isinstance(scene, str | Path) else "scene"
        if poke.free and not self.run.model.free_interior:
            raise InputError(
                f"{where}: model {self.run.recipe.model} knows the dataset's shapes and softness levels alone"
            )
        if self.run.model.takes_clock != (poke.clock is not None):
            wanted = "expected keys time_s, rod_speed_mm_per_s and approach_speed_mm_per_s, since"
            if not self.run.model.takes_clock:
                wanted = "expected no key time_s, since"
            timed = "with" if self.run.model.takes_clock else "without"
            raise InputError(f"{where}: {wanted} the model was trained {timed} time")
        given = scene_and_poke(poke, self.store, where)
        asked = None if points is None else points_on_top(points, given.setup)
        answer = self._answer(poke, given, asked)
        if not (np.isfinite(answer.displacement).all() and np.isfinite(answer.force)):
            raise InputError(f"{where}: the model's answer is not finite")
        if strict and answer.inside is not True:
            raise OutsideDomainError(f"{where}: --strict: {_first_lower(answer.verdict)}")
        return answer

    def real_time(self, interior: Mapping[str, Any]) -> RealTime:
        """Prepare one interior for predictions in real time (about 1 kHz).

        Parameters
        ----------
        interior : keys as in `learn.scene_file.PokeScene` that describe the tissue: shape or inclusion,
            block_mm, softness or shear_modulus_kPa, and law.

        Raises
        ------
        InputError
            If the run's model has no such form, a key is wrong, or the inclusion does not fit the block.
        """
        return RealTime(self.run, self.store, interior, domain=self.domain, intervals=self.intervals)

    def _answer(self, poke: PokeScene, given: PokeInput, asked: AskedPoints | None) -> PokePrediction:
        setup, interior, scene, pokes = given
        start, direction, depth = pokes.start[0].numpy(), pokes.direction[0].numpy(), float(pokes.depth[0])
        values = poke_values(
            setup,
            interior,
            start=start,
            direction=direction,
            depth=depth,
            modulus=float(pokes.modulus[0]),
            clock=pokes.clock[0].numpy(),
        )
        distance = self.domain.distance(values, poke.law) if self.domain else 0.0
        near = covariates(setup, interior, start=start, direction=direction, depth=depth)

        def radius(points: Floats, response: Response) -> Floats | None:
            if self.intervals is None:
                return None
            return 1e-3 * self.intervals.radius_at_mm(
                np.linalg.norm(response.displacement[0].numpy(), axis=1),
                away=np.linalg.norm(points - start, axis=1),
                depth=depth,
                spread=0.0 if response.spread is None else response.spread[0].double().numpy(),
                covariates=near,
                distance=distance,
            )

        with torch.no_grad():
            response = self.run.model(scene, pokes)
        force, interval = float(response.force[0]), None
        if self.intervals is not None and force > 0.0:
            spread = 0.0 if response.force_spread is None else float(response.force_spread[0])
            factor = math.exp(self.intervals.force_log(spread, covariates=near, distance=distance))
            interval = force / factor, force * factor
        at_points = None
        if asked is not None:
            there = respond_at(self.run.model, setup, scene, pokes, asked.points)
            at_points = AtPoints(
                names=asked.names,
                points=asked.points,
                displacement=there.displacement[0].numpy(),
                radius=radius(asked.points, there),
            )
        checked = values, kind_of(poke, self.store), poke.law
        return PokePrediction(
            poke=poke,
            points=setup.points,
            displacement=response.displacement[0].numpy(),
            force=force,
            radius=radius(setup.points, response),
            force_interval=interval,
            checks=self.domain.check(*checked) if self.domain else unknown_checks(*checked),
            scene=scene,
            pokes=pokes,
            asked=at_points,
        )

    @cached_property
    def intervals(self) -> Intervals | None:
        """Intervals of the run, made by `learn.evaluate`; None if there are none."""
        return load_intervals(self.run)

    @property
    def has_intervals(self) -> bool:
        """True if the run has intervals (made by `learn.evaluate`)."""
        return self.intervals is not None

    def _rows(self) -> list[tuple[str, str]]:
        run, store = self.run, self.store
        rows = [
            ("run", ", ".join(str(folder) for folder in run.members) or str(run.folder)),
            ("model", f"{run.recipe.model}, epoch {run.epoch} of {run.recipe.epochs}"),
            (
                "dataset",
                f"{store.location}, {store.law}, {store.pokes} pokes"
                f"{'' if store.has_fields else ' (tables alone)'}",
            ),
            ("trained on", f"{run.statistics.frames} frames"),
            ("shapes", ", ".join(store.shapes)),
            ("blocks", store.describe_blocks()),
            ("softness levels", ", ".join(store.softness_names)),
            ("intervals", "none" if self.intervals is None else self.intervals.text),
        ]
        if self.domain is None:
            return [*rows, ("domain of validity", "not known")]
        return [*rows, *self.domain.rows()]

    def __repr__(self) -> str:
        return "Predictor(\n" + "".join(f"  {key}: {value}\n" for key, value in self._rows()) + ")"

    def _repr_html_(self) -> str:
        return html_table(self._rows())


def _first_lower(text: str) -> str:
    return text[:1].lower() + text[1:].rstrip(".")


def load(run: Path | str | Sequence[Path | str], *, dataset: Path | str | None = None) -> Predictor:
    """Load a trained run for predictions.

    Intervals are those that `learn.evaluate` made last for the run: calibrated on the validation part of its
    dataset, or on the other folds if it was evaluated together with them, as "covers" was
    (185 indentations of the other folds); `repr` of the predictor states the number.

    Parameters
    ----------
    run : folder of a run, or "covers", the network that comes with the package; or several runs that differ
        in seed, to be joined as an ensemble.
    dataset : the dataset, if it moved since the training. The tables in the run's folder are enough without.

    Raises
    ------
    InputError
        If a run or the dataset is missing or damaged, or they do not belong together.
    """
    folders = [run] if isinstance(run, str | Path) else list(run)
    if not folders:
        raise InputError("expected the folder of a run, got none")
    runs = [load_run(folder) for folder in folders]
    joined = join_runs(runs) if len(runs) > 1 else runs[0]
    store = open_tables(joined, dataset)
    if len(runs) == 1:
        return Predictor(joined, store)
    domains = [known_domain(one, store) for one in runs]
    known = [domain for domain in domains if domain is not None]
    common = Domain.common(known) if len(known) == len(runs) else None
    return Predictor(replace(joined, domain=common), store)
