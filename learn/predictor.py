"""Predict pokes with a trained run, from Python.

>>> import learn
>>> predictor = learn.load("runs/quick")
>>> answer = predictor.predict({"site_mm": [5, -10], "depth_mm": 8, "shape": "cube-18", "softness": "S0.5"})
>>> answer.force, answer.displacement.shape, answer.inside
>>> answer.save("prediction")

Both objects print as tables in a notebook, the answer with its picture.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from learn.data import Store
from learn.errors import InputError, OutsideDomainError
from learn.evaluation import Intervals, join_runs, load_intervals
from learn.evaluation.pictures import draw_prediction, encoded
from learn.models import Pokes, Response, Scene
from learn.real_time import RealTime
from learn.scene_file import PokeInput, PokeScene, kind_of, load_poke, scene_and_poke
from learn.training import Run, check_dataset, known_domain, load_run, open_dataset
from learn.training.run_folder import write_whole
from learn.validity import Check, Domain, gap_mm, poke_values, unknown_checks

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class PokePrediction:
    """The prediction of one poke. SI units.

    Attributes
    ----------
    poke : the requested poke.
    points : rest positions of the surface's points [m], shape (n, 3).
    displacement : displacement of these points [m], shape (n, 3).
    force : magnitude of the force on the indenter [N].
    radius : radius of the 90 % interval at each point [m], shape (n,); None without intervals.
    force_interval : 90 % interval of the force [N]; None without intervals, and for a predicted force that is
        0 or less, as model cegnn may have it, around which no factor makes an interval.
    checks : comparison of each quantity with its trained range.
    scene, pokes : the model's input.
    """

    poke: PokeScene
    points: Floats
    displacement: NDArray[np.float32]
    force: float
    radius: Floats | None
    force_interval: tuple[float, float] | None
    checks: list[Check]
    scene: Scene
    pokes: Pokes

    @property
    def inside(self) -> bool | None:
        """True if the poke is inside the domain of validity; None if that is not known."""
        if any(check.inside is False for check in self.checks):
            return False
        return None if all(check.inside is None for check in self.checks) else True

    @property
    def outside(self) -> list[Check]:
        """Checks of the quantities outside the domain of validity."""
        return [check for check in self.checks if check.inside is False]

    @property
    def verdict(self) -> str:
        """One sentence on the domain of validity."""
        if self.inside is None:
            return "The trained ranges are not known: the prediction may be wrong."
        if self.inside:
            return "Inside the trained ranges."
        names = ", ".join(
            f"{check.name} ({_value(check)}; trained: {check.trained})" for check in self.outside
        )
        wider = "" if self.radius is None else "; the intervals are wider, and not calibrated there"
        return f"Outside the trained ranges: {names}. The force may be wrong by a factor{wider}."

    def as_dict(self) -> dict[str, Any]:
        """The numbers of prediction.json."""
        size = np.linalg.norm(self.displacement, axis=1)
        answer: dict[str, Any] = {
            "force_N": self.force,
            "largest_displacement_mm": float(size.max() * 1e3),
        }
        if self.force_interval is not None:
            low, high = self.force_interval
            answer |= {"force_low_N": low, "force_high_N": high}
        if self.radius is not None:
            answer |= {"radius_mean_mm": float(self.radius.mean() * 1e3)}
            answer |= {"radius_max_mm": float(self.radius.max() * 1e3)}
        answer["inside_training"] = self.inside
        answer["domain"] = {
            check.key: {"value": check.value, "trained": check.trained, "inside": check.inside}
            for check in self.checks
        }
        return answer

    def save(self, folder: Path | str) -> Path:
        """Write FOLDER/displacement.csv, prediction.json and prediction.png.

        All are made before the first is written, so that a fault leaves an earlier prediction as it was.
        """
        folder = Path(folder)
        columns = [self.points * 1e3, self.displacement * 1e3]
        heads = "x_mm,y_mm,z_mm,ux_mm,uy_mm,uz_mm"
        if self.radius is not None:
            columns, heads = [*columns, self.radius[:, None] * 1e3], f"{heads},radius_mm"
        table = np.concatenate(columns, axis=1)
        rows, picture = io.StringIO(), io.BytesIO()
        np.savetxt(rows, table, delimiter=",", header=heads, comments="", fmt="%.6g")
        text = json.dumps(self.as_dict(), indent=1, allow_nan=False) + "\n"
        self.picture().savefig(picture, format="png", dpi=110)
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / "displacement.csv", rows.getvalue().encode())
        write_whole(folder / "prediction.json", text.encode())
        write_whole(folder / "prediction.png", picture.getvalue())
        return folder

    def picture(self) -> Any:
        """A matplotlib figure: the cut along the push with the indenter, and the displacement from above."""
        title = f"force {self._force_text}, {'inside' if self.inside else 'OUTSIDE'} the trained ranges"
        return draw_prediction(self.scene, self.pokes, self.displacement, radius=self.radius, title=title)

    @property
    def _force_text(self) -> str:
        if self.force_interval is None:
            why = "" if self.radius is None else " (no interval: it is 0 N or less)"
            return f"{self.force:.3g} N{why}"
        low, high = self.force_interval
        return f"{self.force:.3g} N (90 %: {low:.3g} to {high:.3g})"

    def __repr__(self) -> str:
        largest = float(np.linalg.norm(self.displacement, axis=1).max() * 1e3)
        return (
            f"PokePrediction(force {self._force_text}, largest displacement {largest:.3g} mm; {self.verdict})"
        )

    def _repr_html_(self) -> str:
        rows = [("force", self._force_text), ("", self.verdict), *((c.name, _value(c)) for c in self.checks)]
        return f'{_html_table(rows)}<img src="data:image/png;base64,{encoded(self.picture())}">'


def _value(check: Check) -> str:
    return check.text.removeprefix(f"{check.name} ").partition(":")[0]


def _html_table(rows: Sequence[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in rows)
    return f"<table>{cells}</table>"


class Predictor:
    """A trained run, or several as an ensemble, ready to predict pokes.

    Attributes
    ----------
    run : the trained model with its recipe.
    store : the dataset that it was trained on.
    domain : domain of validity; recorded with the checkpoint, or derived from the dataset.
    """

    def __init__(self, run: Run, store: Store) -> None:
        check_dataset(run.uuid, run.folder, store)
        self.run, self.store = run, store
        self.domain = known_domain(run, store)

    def predict(
        self, scene: Path | str | Mapping[str, Any] | PokeScene, *, strict: bool = False
    ) -> PokePrediction:
        """Predict displacement and force of one poke, and compare it with the domain of validity.

        Parameters
        ----------
        scene : keys and values as in `learn.scene_file.PokeScene`, or the path of a YAML file of them.
        strict : refuse pokes that are not inside the domain of validity.

        Raises
        ------
        InputError
            If a key is wrong, or the poke does not fit the block.
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
        with torch.no_grad():
            response = self.run.model(given.scene, given.pokes)
        answer = self._answer(poke, given, response)
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
        return RealTime(self, interior)

    def _answer(self, poke: PokeScene, given: PokeInput, response: Response) -> PokePrediction:
        setup, interior, scene, pokes = given
        u, force = response.displacement.numpy(), float(response.force[0])
        start, direction = pokes.start[0].numpy(), pokes.direction[0].numpy()
        values = poke_values(
            setup,
            interior,
            start=start,
            direction=direction,
            depth=float(pokes.depth[0]),
            modulus=float(pokes.modulus[0]),
            clock=pokes.clock[0].numpy(),
        )
        asked = values, kind_of(poke, self.store), poke.law
        distance = self.domain.distance(values, poke.law) if self.domain else 0.0
        away = np.linalg.norm(setup.points - pokes.start.numpy(), axis=1)
        depth = float(pokes.depth[0])
        near = np.array([interior.size, gap_mm(setup, interior, start + depth * direction)])
        radius, factor = self._interval(response, away, depth, near, distance)
        return PokePrediction(
            poke=poke,
            points=setup.points,
            displacement=u[0],
            force=force,
            radius=radius,
            force_interval=(force / factor, force * factor) if factor is not None and force > 0.0 else None,
            checks=self.domain.check(*asked) if self.domain else unknown_checks(*asked),
            scene=scene,
            pokes=pokes,
        )

    def _interval(
        self,
        response: Response,
        away: Floats,
        depth: float,
        size_gap: Floats,
        distance: float,
    ) -> tuple[Floats | None, float | None]:
        """Radius at each point [m] and factor around the force; None without intervals."""
        if self.intervals is None:
            return None, None
        radius = self.intervals.radius_at_mm(
            np.linalg.norm(response.displacement[0].numpy(), axis=1),
            away=away,
            depth=depth,
            spread=0.0 if response.spread is None else response.spread[0].double().numpy(),
            size_gap=size_gap,
            distance=distance,
        )
        spread = 0.0 if response.force_spread is None else float(response.force_spread[0])
        grown = self.intervals.force_log(spread, size_gap=size_gap, distance=distance)
        return radius * 1e-3, float(np.exp(grown))

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
            ("dataset", f"{store.location}, {store.law}, {store.pokes} pokes"),
            ("trained on", f"{run.statistics.frames} frames"),
            ("shapes", ", ".join(store.shapes)),
            ("blocks", store.describe_blocks()),
            ("softness levels", ", ".join(store.softness_names)),
            ("intervals", "yes" if self.has_intervals else "none"),
        ]
        if self.domain is None:
            return [*rows, ("domain of validity", "not known")]
        return [*rows, *self.domain.rows()]

    def __repr__(self) -> str:
        return "Predictor(\n" + "".join(f"  {key}: {value}\n" for key, value in self._rows()) + ")"

    def _repr_html_(self) -> str:
        return _html_table(self._rows())


def _first_lower(text: str) -> str:
    return text[:1].lower() + text[1:].rstrip(".")


def load(run: Path | str | Sequence[Path | str], *, dataset: Path | str | None = None) -> Predictor:
    """Load a trained run for predictions.

    Parameters
    ----------
    run : folder of a run, or several that differ in seed, to be joined as an ensemble.
    dataset : the dataset, if it moved since the training.

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
    store = open_dataset(joined, dataset, verify=False)
    if len(runs) == 1:
        return Predictor(joined, store)
    domains = [known_domain(one, store) for one in runs]
    known = [domain for domain in domains if domain is not None]
    common = Domain.common(known) if len(known) == len(runs) else None
    return Predictor(replace(joined, domain=common), store)
