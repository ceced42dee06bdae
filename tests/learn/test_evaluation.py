"""From a trained run to a report, a prediction and ONNX files, by the commands of a user."""

from __future__ import annotations

import importlib.util
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import zarr
from typer.testing import CliRunner, Result

import learn.baselines
import learn.evaluate
import learn.export
import learn.predict
import learn.train
from learn.data import MemoryDataset, Store, contact_points, open_store, split_of, split_pokes
from learn.data.clouds import scattered
from learn.errors import InputError
from learn.evaluation import ensembles, evaluate, join_runs, parts_of, summarise
from learn.evaluation.predictions import interpolation_error_mm, predict_on
from learn.evaluation.report import cautions, tables
from learn.metrics import METRICS
from learn.models import Ensemble, Model, Pokes, Response, Scene, pokes_of, scene_on
from learn.scene_file import load_poke, scene_and_poke
from learn.training import Run, load_run
from tests.learn.drawn import assert_drawn
from tests.learn.small_store import write_store

MODEL = "invariant-gnn-small"  # no statement here is about a certain network
BLUE, ORANGE, INDENTER, RIGID_GREY = "#1f77b4", "#ff7f0e", "#d62728", "#bfbfbf"
POKE = "site_mm: [5, -10]\ndepth_mm: 2\nangle_deg: 20\nheading_deg: 45\nshape: shape-1\nsoftness: S1\n"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("evaluation") / "s.zarr", sites=2, frames=3)


@pytest.fixture(scope="module")
def run(store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "run"
    recipe = folder.parent / "r.yaml"
    recipe.write_text(
        f"name: small\nmodel: {MODEL}\nepochs: 3\nbatch: 8\nema_decay: 0.9\ntrain_depth_mm: 2.5\n"
        "near_weight: 20\nnear_width_mm: 6\ndepth_power: 0\n"  # weighs absolute errors, as the mean does
    )
    done = _call(learn.train.app, store, "--recipe", recipe, "--out", folder, "--threads", 1)
    assert done.exit_code == 0, done.output
    return folder


def _call(app: object, *arguments: object) -> Result:
    return CliRunner().invoke(app, [str(a) for a in arguments])  # type: ignore[arg-type]


def _assert_pictures(folder: Path, *, learning: tuple[str, ...]) -> None:
    """The pictures of a report are drawn: the learning curve, ranked pokes (simulated, predicted), forces."""
    assert_drawn(folder / "learning.png", *learning)
    assert_drawn(folder / "force.png", BLUE)
    ranked = [folder / f"{name}.png" for name in ("best", "median", "worst")]
    shown = [path for path in ranked if path.exists()]
    assert len(shown) >= 2
    for path in shown:
        assert_drawn(path, "#000000", ORANGE)


def _means_by_hand(folder: Path) -> list[float]:
    """Mean distance over the test part [mm], of the run's model and of no displacement at all."""
    run = load_run(folder)
    store = open_store(run.location)
    found: list[list[float]] = []
    for row in split_of(store, run.recipe).test:
        batch = MemoryDataset(store, np.array([row])).__getitems__([0])
        scene = scene_on(store.setup, store.profile)
        with torch.no_grad():
            u = run.model(scene, pokes_of(batch)).displacement[0]
        true = batch.displacement[0]
        found.append([1e3 * float(torch.linalg.norm(d, dim=1).mean()) for d in (u - true, true)])
    return np.mean(found, axis=0).tolist()


@pytest.fixture(scope="module")
def evaluated(run: Path) -> Path:
    """The run, with its evaluation and its intervals."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learn.baselines, "_STEPS", 50)
        done = _call(learn.evaluate.app, run, "--threads", 1, "--no-clouds")
    assert done.exit_code == 0, done.output
    return run


def test_report_and_tables(evaluated: Path) -> None:
    run = evaluated
    html = (run / "evaluation" / "report.html").read_text()
    assert html.count("data:image/png;base64") == 5
    for name in ("learning", "best", "median", "worst", "force"):
        assert (run / "evaluation" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    for words in ("analytic kernel", "zero displacement", "Symmetry", "Intervals", "Deeper"):
        assert words in html
    tables = json.loads((run / "evaluation" / "tables.json").read_text())
    ours, zero = (tables["tables"][name]["all"] for name in (MODEL, "zero displacement"))
    assert set(ours) == set(METRICS)
    assert [ours["mean"]["mean"], zero["mean"]["mean"]] == pytest.approx(_means_by_hand(run), rel=1e-4)
    assert ours["mean"]["mean"] < zero["mean"]["mean"]
    assert tables["symmetry"][f"{MODEL}, fold 0"]["displacement_mm"] < 1e-5
    assert set(tables["tables"][MODEL]) == {"S0", "S1", "all"}
    assert (run / "intervals.json").is_file()


@pytest.fixture(scope="module")
def second(store: Path, run: Path) -> Path:
    """A run that differs from the first only by its seed."""
    folder = run.parent / "second"
    done = _call(
        learn.train.app,
        store,
        "--recipe",
        run.parent / "r.yaml",
        "--seed",
        1,
        "--out",
        folder,
        "--threads",
        1,
    )
    assert done.exit_code == 0, done.output
    return folder


def test_a_run_whose_dataset_is_now_divided_otherwise_is_refused(store: Path, run: Path) -> None:
    """A store that was a part of what it is now: shapes that the run has seen would count as unseen."""
    loaded, data = load_run(run), open_store(store)
    parts = parts_of(data, loaded)
    assert parts.groups == loaded.groups
    moved = {**loaded.groups, "train": loaded.groups["test"], "test": loaded.groups["train"]}
    with pytest.raises(InputError, match=r"was trained on other shapes of .*: train it again"):
        parts_of(data, replace(loaded, groups=moved))


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


def _changed(run: Run, **recipe: object) -> Run:
    """The run with other keys of its recipe, and a folder named after these."""
    folder = run.folder.with_name("-".join(f"{key}-{value}" for key, value in recipe.items()))
    return replace(run, folder=folder, recipe=run.recipe.model_copy(update=recipe))


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


@pytest.mark.slow
def test_folds_together(store: Path, run: Path, tmp_path: Path) -> None:
    """Each run's intervals come from the other folds' test parts, in the tables and in its folder."""
    runs = [tmp_path / f"fold{k}" for k in range(3)]
    for fold, folder in enumerate(runs):
        flags = ("--fold", fold, "--out", folder, "--threads", 1)
        done = _call(learn.train.app, store, "--recipe", run.parent / "r.yaml", *flags)
        assert done.exit_code == 0, done.output
    flags = ("--no-baselines", "--no-clouds", "--threads", 1, "--out", tmp_path / "all")
    done = _call(learn.evaluate.app, *runs, *flags)
    assert done.exit_code == 0, done.output
    tables = json.loads((tmp_path / "all" / "tables.json").read_text())
    names = [f"{MODEL}, fold {k}" for k in range(3)]
    assert list(tables["intervals"]) == [*names, *(f"{name}, by the other folds" for name in names)]
    assert "mean of those by the other folds" in (tmp_path / "all" / "report.html").read_text()
    tested = [split_pokes(open_store(store), fold=k, train_depth=2.5e-3).test for k in range(3)]
    poke = open_store(store).frame_poke
    for fold, folder in enumerate(runs):
        others = [len(np.unique(poke[rows])) for k, rows in enumerate(tested) if k != fold]
        kept = json.loads((folder / "intervals.json").read_text())
        assert kept["pokes"] == sum(others)


def test_runs_together(run: Path, second: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """Two runs as an ensemble: its own row of the tables, intervals, symmetry and mean predictions."""
    flags = ("--ensemble", "--no-baselines", "--no-clouds", "--threads", 1, "--out", tmp_path / "both")
    namesake = shutil.copytree(second, tmp_path / run.name)  # the folders' names are the same
    (tmp_path / "both").mkdir()
    (tmp_path / "both" / "only.png").touch()  # of an earlier report, on one poke
    done = _call(learn.evaluate.app, run, namesake, *flags)
    assert done.exit_code == 0, done.output
    assert not (tmp_path / "both" / "only.png").exists()
    _assert_pictures(tmp_path / "both", learning=(BLUE, ORANGE))  # a curve of each run
    request.getfixturevalue("unrendered")
    tables = json.loads((tmp_path / "both" / "tables.json").read_text())
    assert tables["runs"] == [str(run), str(namesake)]
    assert list(tables["tables"]) == [f"{MODEL}, 2 together", MODEL]
    assert tables["symmetry"][f"{MODEL}, 2 together, fold 0"]["displacement_mm"] < 1e-5
    assert list(tables["intervals"]) == [
        f"{MODEL}, 2 together, fold 0",
        f"{MODEL}, fold 0",
        f"{MODEL}, fold 0, seed 1",
    ]
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    answers = []
    for number, runs in enumerate(([run], [namesake], [run, namesake])):
        done = _call(learn.predict.app, *runs, scene, "--out", tmp_path / str(number))
        assert done.exit_code == 0, done.output
        answers.append(json.loads((tmp_path / str(number) / "prediction.json").read_text()))
    one, other, both = answers
    assert both["force_N"] == pytest.approx((one["force_N"] * other["force_N"]) ** 0.5, rel=1e-5)
    assert both["radius_max_mm"] > 0
    alone = _call(learn.evaluate.app, run, "--ensemble", "--out", tmp_path / "alone")
    assert alone.exit_code == 2
    assert "two or more runs" in alone.stderr
    assert not (tmp_path / "alone").exists()
    twice = _call(learn.predict.app, run, run, scene, "--out", tmp_path / "twice")
    assert twice.exit_code == 2
    assert "expected runs that differ in seed alone" in twice.stderr


def test_an_ensemble_is_the_mean_of_its_members(store: Path) -> None:
    opened = open_store(store)
    scene, data = scene_on(opened.setup, opened.profile), MemoryDataset(opened, np.arange(4))
    pokes = pokes_of(data.__getitems__([0, 1, 2, 3]))
    plain = _Truth()
    found = Ensemble([plain, _Truth(more=1.02), _Truth(more=1.04)])(scene, pokes)
    exact = plain(scene, pokes)
    torch.testing.assert_close(found.displacement, exact.displacement * 1.02)
    size = exact.displacement.norm(dim=2)
    torch.testing.assert_close(found.spread, 0.02 * size, rtol=1e-3, atol=1e-9)
    torch.testing.assert_close(
        found.force_spread, torch.full((4,), float(np.log([1, 1.02, 1.04]).std(ddof=1)))
    )


def test_a_run_of_another_dataset_is_refused(run: Path, tmp_path: Path) -> None:
    other = write_store(tmp_path / "o.zarr", seed=4, sites=3, frames=2)
    refused = _call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out")
    assert refused.exit_code == 2
    assert "trained on dataset" in refused.stderr
    assert not (tmp_path / "out").exists()


def test_a_damaged_run_is_refused(run: Path, tmp_path: Path) -> None:
    (tmp_path / "best.pt").write_bytes((run / "best.pt").read_bytes()[:500])
    refused = _call(learn.evaluate.app, tmp_path)
    assert refused.exit_code == 2
    assert refused.stderr.count("\n") == 1
    assert "not a readable checkpoint" in refused.stderr
    assert not (tmp_path / "evaluation").exists()


def test_prediction_of_one_poke(run: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    done = _call(learn.predict.app, run, scene, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert_drawn(tmp_path / "out" / "prediction.png", BLUE, INDENTER, RIGID_GREY)
    request.getfixturevalue("unrendered")
    answer = json.loads((tmp_path / "out" / "prediction.json").read_text())
    assert answer["force_N"] > 0
    table = np.loadtxt(tmp_path / "out" / "displacement.csv", delimiter=",", skiprows=1)
    assert len(table) == 1024
    deepest = table[np.linalg.norm(table[:, 3:6], axis=1).argmax()]
    assert np.linalg.norm(deepest[:2] - [5, -10]) < 5  # mm from the contact point
    scene.write_text(POKE.replace("softness: S1", "shear_modulus_kPa: 18"))
    double = _call(learn.predict.app, run, scene, "--out", tmp_path / "double")
    assert double.exit_code == 0, double.output
    stiffer = json.loads((tmp_path / "double" / "prediction.json").read_text())
    assert stiffer["force_N"] > 1.3 * answer["force_N"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("depth_mm: 2", "depth_mm: -2", "key depth_mm"),
        ("depth_mm: 2", "depth: 2", "key depth"),
        ("site_mm: [5, -10]", "site_mm: [500, 0]", "key site_mm: expected x within"),
        ("shape: shape-1", "shape: cat", "key shape: expected one of shape-0"),
        ("softness: S1", "softness: S9", "key softness: expected one of S0, S1, got 'S9'"),
        ("softness: S1\n", "", "either softness or shear_modulus_kPa"),
    ],
)
def test_bad_scene_files_are_refused(run: Path, tmp_path: Path, old: str, new: str, words: str) -> None:
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE.replace(old, new))
    done = _call(learn.predict.app, run, scene, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_inclusions_of_ones_own(store: Path, tmp_path: Path) -> None:
    scene = tmp_path / "poke.yaml"
    body = "inclusion: {kind: sphere, radius_mm: 8, centre_mm: [0, 0, 8]}"
    scene.write_text(POKE.replace("shape: shape-1", body))
    _, _, about, pokes = scene_and_poke(load_poke(scene), open_store(store))
    column = about.rigid[0, 16 * 32 + 16].numpy()  # nearest to the centre
    height = 32 - (np.arange(128) + 0.5) / 4  # mm above the base
    assert np.abs(height[column > 0].max() - 16) < 0.5
    assert column[height < 0.3].all() == (np.hypot(1.5625, 1.5625) < np.sqrt(64 - 7.8**2))
    assert float(pokes.direction.norm()) == pytest.approx(1)


class _Truth(Model):
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


class _WithoutForce(_Truth):
    """The same, with a force of 0 at half of the depth: negative above it."""

    def decode(self, encoded: Scene, pokes: Pokes) -> Response:
        found = super().decode(encoded, pokes)
        return replace(found, force=found.force - 1.5e-3)


def test_answers_that_are_not_finite_are_no_part_of_a_mean(run: Path, store: Path) -> None:
    """Forces of both signs have no geometric mean: such frames of an ensemble were left out of the means."""
    loaded = load_run(run)
    joined = Ensemble([_Truth(), _WithoutForce()])
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
    on_grid = summarise(predict_on(_Truth(), store, rows, lambda setup: setup.points[soft]))
    assert on_grid["max"].mean < 1e-4
    off_grid = summarise(predict_on(_Truth(), store, rows, lambda _: points))
    assert 0 < off_grid["rel L2"].mean < 0.5
    assert interpolation_error_mm(store, rows) < 1e-6


def test_another_dataset_where_it_is_asked_for(evaluated: Path, tmp_path: Path) -> None:
    """Transfer tests all pokes of shapes unseen by the run, no others, and keeps the run's intervals."""
    run = evaluated
    other = write_store(tmp_path / "o.zarr", shapes=5, sites=2, frames=2)
    flags = ("--transfer", "--no-clouds", "--threads", 1)
    kept = (run / "intervals.json").read_bytes()
    for extra, words in (
        (["--transfer"], "expected another --dataset"),
        (["--out", run / "best.pt"], "--out"),
    ):
        wrong = _call(learn.evaluate.app, run, *extra)  # type: ignore[arg-type]
        assert (wrong.exit_code, words in wrong.stderr) == (2, True), wrong.output
    refused = _call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out")
    assert refused.exit_code == 2
    assert not (tmp_path / "out").exists()
    allowed = _call(learn.evaluate.app, run, "--dataset", other, "--out", tmp_path / "out", *flags)
    assert allowed.exit_code == 0, allowed.output
    _assert_pictures(tmp_path / "out", learning=(BLUE,))
    tables = json.loads((tmp_path / "out" / "tables.json").read_text())
    assert list(tables["tables"]) == [MODEL]
    assert list(tables["intervals"]) == [f"{MODEL}, fold 0"]
    # the training part has one interior, and not the smaller nor the larger ones
    assert all(name.startswith(f"{MODEL}, fold 0, ") for name in tables["outside"])
    assert f"{MODEL}, fold 0, beyond 1" in tables["outside"]
    frames = sum(one["frames"] for one in tables["outside"].values())
    assert frames == tables["test_frames"]
    assert "Outside what was trained" in (tmp_path / "out" / "report.html").read_text()
    assert (run / "intervals.json").read_bytes() == kept
    store, loaded = open_store(other), load_run(run)
    tested = np.unique(store.shape[store.frame_poke[parts_of(store, loaded).test]])
    assert {store.shapes[k] for k in tested} == {*loaded.groups["test"], "shape-3", "shape-4"}
    few = write_store(tmp_path / "few.zarr", seed=5, shapes=3)
    everything = replace(loaded, groups={**loaded.groups, "train": ["shape-0", "shape-1", "shape-2"]})
    with pytest.raises(InputError, match="trained on all its shapes"):
        parts_of(open_store(few), replace(everything, location=str(tmp_path / "gone.zarr")))


def _renamed(folder: Path) -> Store:
    """The dataset with other names of its shapes, as another recipe may give them."""
    zarr.open_group(folder, mode="r+").attrs.update(uuid="renamed", shapes=["round-1", "round-2", "round-3"])
    return open_store(folder)


def test_shapes_of_another_dataset_are_told_by_what_they_are(run: Path, store: Path, tmp_path: Path) -> None:
    """Drawn shapes of one name differ, and one shape has different names; by name where the rest is gone."""
    loaded, own = load_run(run), open_store(store)
    trained = {*loaded.groups["train"], *loaded.groups["validation"]}
    renamed = _renamed(write_store(tmp_path / "twin.zarr", sites=2, frames=3))
    parts = parts_of(renamed, loaded)
    assert parts.groups["test"] == [renamed.shapes[own.shapes.index(n)] for n in loaded.groups["test"]]
    drawn = open_store(write_store(tmp_path / "drawn.zarr", seed=7))
    assert set(parts_of(drawn, loaded).groups["test"]) == set(drawn.shapes) > trained
    away = replace(loaded, location=str(tmp_path / "gone.zarr"))
    assert set(parts_of(drawn, away).groups["test"]) == set(loaded.groups["test"])
    found = evaluate([away], drawn, baselines=False, clouds=False)
    assert found.by_name == [str(run)]
    assert any("identified by their names" in sentence for sentence in cautions(found))
    assert not evaluate([loaded], drawn, baselines=False, clouds=False).by_name


def test_a_run_split_by_site_is_tested_elsewhere_on_contact_points_that_it_has_not_seen(
    run: Path, tmp_path: Path
) -> None:
    """Two laws of one recipe have the same contact points."""
    store = open_store(write_store(tmp_path / "a.zarr", sites=2))
    recipe = load_run(run).recipe.model_copy(update={"split": "site"})
    split = split_of(store, recipe)
    trained = np.unique(store.frame_poke[np.concatenate([split.train, split.validation])])
    by_site = replace(
        load_run(run),
        recipe=recipe,
        groups=split.groups,
        seen=frozenset(contact_points(store, trained).tolist()),
    )
    # told by interior and place where its own dataset is there, else by the keys that it was saved with
    there = replace(by_site, uuid=store.uuid, location=store.address)
    other = _renamed(write_store(tmp_path / "b.zarr", sites=2))
    found = np.unique(other.frame_poke[parts_of(other, there).test])
    np.testing.assert_array_equal(found, np.unique(store.frame_poke[split.test]))
    by_site = replace(by_site, uuid="of another law")
    tested = np.unique(store.frame_poke[parts_of(store, by_site).test])
    np.testing.assert_array_equal(tested, np.unique(store.frame_poke[split.test]))
    everything = contact_points(store, np.arange(store.pokes)).tolist()
    with pytest.raises(InputError, match="trained on all its sites"):
        parts_of(store, replace(by_site, seen=frozenset(everything)))
    with pytest.raises(InputError, match="does not say which contact points it was trained on"):
        parts_of(store, replace(by_site, seen=frozenset()))
    # of its own dataset, when that has changed under the same groups
    with pytest.raises(InputError, match="train it again"):
        parts_of(store, replace(by_site, uuid=store.uuid, seen=frozenset(everything)))


@pytest.mark.slow
def test_report_of_other_clouds(run: Path, tmp_path: Path) -> None:
    done = _call(learn.evaluate.app, run, "--threads", 1, "--no-baselines", "--out", tmp_path)
    assert done.exit_code == 0, done.output
    tables = json.loads((tmp_path / "tables.json").read_text())
    assert list(tables["clouds"]) == [
        "1024, the grid",
        "512, scattered",
        "1024, scattered",
        "4096, scattered",
    ]
    assert tables["cloud_interpolation_mm"] < 1e-6


@pytest.mark.slow
@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("onnx", "onnxscript", "onnxruntime")),
    reason="the onnx packages are not installed",
)
def test_onnx_gives_what_torch_gives(run: Path, tmp_path: Path) -> None:
    done = _call(learn.export.app, run, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    about = json.loads((tmp_path / "model.json").read_text())
    assert about["difference_from_torch"] < 1e-5
    assert (tmp_path / "poke.onnx").is_file()


@pytest.mark.slow
@pytest.mark.skipif(
    any(importlib.util.find_spec(name) is None for name in ("onnx", "onnxscript", "onnxruntime")),
    reason="the onnx packages are not installed",
)
def test_onnx_of_the_papers_model(store: Path, run: Path, tmp_path: Path) -> None:
    recipe = ("--recipe", run.parent / "r.yaml", "--model", "cegnn", "--epochs", 1)
    done = _call(learn.train.app, store, *recipe, "--out", tmp_path / "run", "--threads", 1)
    assert done.exit_code == 0, done.output
    done = _call(learn.export.app, tmp_path / "run")
    assert done.exit_code == 0, done.output
    about = json.loads((tmp_path / "run" / "onnx" / "model.json").read_text())
    assert about["difference_from_torch"] < 1e-5
