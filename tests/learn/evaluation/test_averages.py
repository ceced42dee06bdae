"""What is averaged: runs that differ in fold or seed alone, the members of an ensemble, points of a field."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from learn.data import MemoryDataset, open_store
from learn.data.clouds import scattered
from learn.errors import InputError
from learn.evaluation import ensembles, evaluate, join_runs, summarise
from learn.evaluation.predictions import interpolation_error_mm, predict_on
from learn.evaluation.report import tables
from learn.models import Ensemble, Model, Pokes, Response, Scene, pokes_of, scene_on
from learn.training import Run, load_run
from tests.learn.evaluation.cases import MODEL
from tests.learn.small_store import write_store


def _changed(run: Run, **recipe: object) -> Run:
    """The run with other keys of its recipe, and a folder named after these."""
    folder = run.folder.with_name("-".join(f"{key}-{value}" for key, value in recipe.items()))
    return replace(run, folder=folder, recipe=run.recipe.model_copy(update=recipe))


@pytest.mark.usefixtures("few_motions")
def test_runs_that_differ_in_more_than_the_fold_have_rows_of_their_own(store: Path, run: Path) -> None:
    """Two runs tested on the same pokes: these count once, and recipes of one model are not averaged."""
    loaded, data = load_run(run), open_store(store)
    other = _changed(loaded, epochs=77)
    same = replace(_changed(loaded, seed=5), domain=None)  # of before the domain was recorded
    alone = evaluate([loaded], data, baselines=False, clouds=False)
    both = evaluate([loaded, same], data, baselines=False, clouds=False)
    assert (both.pokes, both.frames, both.models) == (alone.pokes, alone.frames, [MODEL])
    first, second = (both.covered[f"{MODEL}, fold 0{more}"] for more in ("", ", seed 5"))
    assert (first.found, first.radius_mm) == (second.found, second.radius_mm)  # taken from the dataset
    apart = evaluate([loaded, other], data, baselines=False, clouds=False)
    name = loaded.recipe.name
    assert apart.models == [f"{MODEL} ({name} 1)", f"{MODEL} ({name} 2)"]
    mixed = replace(both, models=[*both.models, "b"], folds={**both.folds, "b": alone.folds[MODEL]})
    for found, words in (
        (alone, "over frames, as in the paper."),
        (apart, "over frames, as in the paper."),
        (both, "over runs."),
        (mixed, f"over runs for {MODEL}; over frames, as in the paper, for b."),
    ):
        assert f"± is the standard deviation {words}" in tables(found)["The paper's table"][1][0]


def test_runs_that_differ_in_more_than_the_seed_are_not_joined(store: Path, run: Path) -> None:
    loaded = load_run(run)
    second, longer = _changed(loaded, seed=1, name="other"), _changed(loaded, epochs=77)
    [(joined, name)] = ensembles([loaded, second, longer])
    assert joined.members == (loaded.folder, second.folder)
    assert name == f"{MODEL} ({loaded.recipe.name} 1), 2 together"
    refused: list[tuple[list[Run], str]] = [
        ([loaded, replace(second, uuid="other")], "trained on dataset other"),
        ([loaded, second, _changed(loaded, seed=0)], f"seed-0: .* has seed 0, as {run}"),
        ([loaded, replace(second, groups={})], "other: expected .* was trained on other pokes than"),
        ([loaded, longer], "needs two or more runs that differ in seed alone"),
    ]
    for runs, words in refused:
        with pytest.raises(InputError, match=words):
            ensembles(runs)
    with pytest.raises(InputError, match=r"epochs-77: expected .* has epochs 77, .*run 3"):
        join_runs([loaded, longer])
    again = replace(loaded, folder=run.parent / "x" / ".." / run.name)
    with pytest.raises(InputError, match="given twice"):
        evaluate([loaded, again], open_store(store))


class Truth(Model):
    """Model that returns the stores' analytic field over homogeneous tissue, times a factor."""

    def __init__(self, more: float = 1.0) -> None:
        super().__init__()
        self.more = more

    def encode(self, scene: Scene, prepared: object = None) -> Scene:  # noqa: ARG002
        return scene

    def decode(self, encoded: Scene, pokes: Pokes) -> Response:
        r = encoded.points[None] - pokes.start[:, None]
        rho = (r.square().sum(dim=2) + 2.5e-3**2).sqrt()
        fall = (2.5e-3 / rho * torch.exp(-rho / 0.02))[..., None] * pokes.depth[:, None, None]
        lean = pokes.direction[:, None] + 0.3 * (1 + 20 * pokes.depth[:, None, None]) * r / rho[..., None]
        u = (fall * lean).float() * self.more
        return Response(displacement=u, force=pokes.depth.float() * self.more)


class WithoutForce(Truth):
    """The same, with a force of 0 at half of the depth: negative above it."""

    def decode(self, encoded: Scene, pokes: Pokes) -> Response:
        found = super().decode(encoded, pokes)
        return replace(found, force=found.force - 1.5e-3)


def test_an_ensemble_is_the_mean_of_its_members(store: Path) -> None:
    opened = open_store(store)
    scene, data = scene_on(opened.setup, opened.profile), MemoryDataset(opened, np.arange(4))
    pokes = pokes_of(data.__getitems__([0, 1, 2, 3]))
    plain = Truth()
    found = Ensemble([plain, Truth(more=1.02), Truth(more=1.04)])(scene, pokes)
    exact = plain(scene, pokes)
    torch.testing.assert_close(found.displacement, exact.displacement * 1.02)
    size = exact.displacement.norm(dim=2)
    torch.testing.assert_close(found.spread, 0.02 * size, rtol=1e-3, atol=1e-9)
    torch.testing.assert_close(
        found.force_spread, torch.full((4,), float(np.log([1, 1.02, 1.04]).std(ddof=1)))
    )


def test_answers_that_are_not_finite_are_no_part_of_a_mean(run: Path, store: Path) -> None:
    """Forces of both signs have no geometric mean: such frames of an ensemble were left out of the means."""
    loaded = load_run(run)
    joined = Ensemble([Truth(), WithoutForce()])
    bad = replace(loaded, model=joined, members=(run, Path("other")))
    with pytest.raises(
        InputError, match=r"other: the answer to .* frames, the first of poke .* no geometric mean"
    ):
        evaluate([bad], open_store(store), baselines=False, clouds=False)


def test_other_clouds_see_the_same_field(tmp_path: Path) -> None:
    """The exact field at scattered points differs from the target only by the mesh's interpolation error."""
    store = open_store(write_store(tmp_path / "s.zarr", sites=1, frames=1))
    rows = np.arange(store.frames)
    points = scattered(store.setup, 300)
    assert points.shape == (300, 3)
    gaps = np.sort(np.linalg.norm(points[:, None] - points[None], axis=2), axis=1)[:, 1]
    assert gaps.min() > 1e-3
    soft = ~(scene_on(store.setup, store.profile).rigid.sum(dim=(0, 2)) > 0).numpy()
    on_grid = summarise(predict_on(Truth(), store, rows, lambda setup: setup.points[soft]))
    assert on_grid["max"].mean < 1e-4
    off_grid = summarise(predict_on(Truth(), store, rows, lambda _: points))
    assert 0 < off_grid["rel L2"].mean < 0.5
    assert interpolation_error_mm(store, rows) < 1e-6
