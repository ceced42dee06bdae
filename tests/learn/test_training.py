"""Training is reproducible, resumes to the same result, stops on invalid values, and keeps good results."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor
from typer.testing import CliRunner

import learn.training.loop
from learn.data import open_store
from learn.errors import InputError
from learn.models import MODELS, Scenes, pokes_of
from learn.progress import Progress
from learn.train import app
from learn.training import DivergedError, ProcessGroup, Recipe, Trainer, load_recipe, load_run, read_log
from learn.training.recipe import RECIPES
from learn.training.run_folder import load_checkpoint, save_checkpoint
from tests.learn.small_store import write_store

ROOT = Path(__file__).parent.parent.parent
TINY = Recipe(name="tiny", model="invariant-gnn-small", epochs=2, batch=4, ema_decay=0.9)
ONE = TINY.model_copy(update={"epochs": 1})


@pytest.fixture(scope="module", autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_store(tmp_path_factory.mktemp("training") / "s.zarr", sites=2, frames=2)


def _train(
    store: Path, recipe: Recipe, out: Path, *, resume: bool = False, stop_after: int | None = None
) -> None:
    def watch(progress: Progress) -> None:
        if stop_after is not None and progress.values is None and progress.done > stop_after:
            raise KeyboardInterrupt

    Trainer(open_store(store), recipe, out, resume=resume, on_progress=watch).train()


@pytest.fixture(scope="module")
def trained(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of one epoch, which no test changes."""
    out = tmp_path_factory.mktemp("trained") / "run"
    _train(folder, ONE, out)
    return out


@pytest.fixture
def run(trained: Path, tmp_path: Path) -> Path:
    """A copy of the run of one epoch."""
    return Path(shutil.copytree(trained, tmp_path / "run"))


def _weights(out: Path) -> dict[str, Tensor]:
    found: dict[str, Tensor] = load_checkpoint(out / "last.pt")["model"]
    return found


def _same(a: dict[str, Tensor], b: dict[str, Tensor]) -> bool:
    return all(torch.equal(a[name], b[name]) for name in a)


@pytest.mark.parametrize(
    ("data", "optimiser"),
    [("memory", "adam"), ("memory", "muon"), pytest.param("stream", "adam", marks=pytest.mark.slow)],
)
def test_stopped_and_resumed_is_the_same_as_at_one_go(
    folder: Path, tmp_path: Path, data: str, optimiser: str
) -> None:
    changes = {"data": data, "shuffle_buffer": 2, "point_dropout": 0.5, "optimiser": optimiser}
    recipe = TINY.model_copy(update=changes)
    _train(folder, recipe, tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        _train(folder, recipe, tmp_path / "parts", stop_after=1)  # within the second epoch
    assert load_checkpoint(tmp_path / "parts" / "last.pt")["epoch"] == 1
    _train(folder, recipe, tmp_path / "parts", resume=True)
    assert _same(_weights(tmp_path / "whole"), _weights(tmp_path / "parts"))
    logs = [
        [{k: v for k, v in line.items() if "second" not in k} for line in read_log(tmp_path / part)]
        for part in ("whole", "parts")
    ]
    assert logs[0] == logs[1]
    assert [line["epoch"] for line in logs[0]] == [0, 1]


def test_another_seed_gives_other_weights(folder: Path, trained: Path, tmp_path: Path) -> None:
    _train(folder, ONE.model_copy(update={"seed": 1}), tmp_path / "b")
    assert not _same(_weights(trained), _weights(tmp_path / "b"))


@pytest.mark.slow
def test_dropout_of_the_baseline_resumes_as_well(folder: Path, tmp_path: Path) -> None:
    recipe = TINY.model_copy(
        update={
            "model": "cegnn",
            "epochs": 2,
            "train_depth_mm": 1.5,
            "train_softness": ["S0"],
            "force_loss": "square",
        }
    )
    _train(folder, recipe, tmp_path / "whole")
    with pytest.raises(KeyboardInterrupt):
        _train(folder, recipe, tmp_path / "parts", stop_after=1)
    _train(folder, recipe, tmp_path / "parts", resume=True)
    assert _same(_weights(tmp_path / "whole"), _weights(tmp_path / "parts"))


def test_a_checkpoint_carries_dataset_recipe_and_statistics(folder: Path, trained: Path) -> None:
    run = load_run(trained)
    assert run.uuid == open_store(folder).uuid
    assert run.recipe.name == "tiny"
    assert run.statistics.frames == 8
    assert set(run.groups) == {"train", "validation", "test"}


def test_weights_of_another_version_are_refused(folder: Path, run: Path) -> None:
    for name in ("best.pt", "last.pt"):
        content = load_checkpoint(run / name)
        save_checkpoint(run / name, {**content, "version": 1})
    now = MODELS[TINY.model].version
    with pytest.raises(InputError, match=f"of version 1 of model {TINY.model}, this is version {now}"):
        load_run(run)
    with pytest.raises(InputError, match="train again"):
        _train(folder, TINY, run, resume=True)


def test_nan_ends_the_run_and_keeps_the_last_good_checkpoint(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = learn.training.optimisation.loss_of
    calls = 0

    def broken(*args: object) -> learn.training.recipe.Loss:
        nonlocal calls
        calls += 1
        loss = plain(*args)  # type: ignore[arg-type]
        return learn.training.recipe.Loss(
            loss.total * (float("nan") if calls > 3 else 1), loss.displacement, loss.force
        )

    monkeypatch.setattr(learn.training.optimisation, "loss_of", broken)
    with pytest.raises(DivergedError, match="not finite"):
        _train(folder, TINY, tmp_path / "run")
    kept = load_checkpoint(tmp_path / "run" / "last.pt")
    assert kept["epoch"] == 1
    assert all(bool(torch.isfinite(v).all()) for v in kept["model"].values())


@pytest.mark.parametrize("split", ["shape", "site"])
def test_a_run_on_a_part_of_a_store_does_not_go_on_with_the_whole(
    folder: Path, tmp_path: Path, split: str
) -> None:
    """The parts would be others: what was trained on might be tested."""
    recipe = TINY.model_copy(update={"epochs": 1, "split": split})
    _train(folder, recipe, tmp_path / "run")
    before = (tmp_path / "run" / "last.pt").read_bytes()
    grown = write_store(tmp_path / "grown.zarr", sites=3, frames=2)
    assert open_store(grown).uuid == open_store(folder).uuid
    with pytest.raises(InputError, match=r"was trained on .* frames of .* train it again with another --out"):
        _train(grown, recipe.model_copy(update={"epochs": 2}), tmp_path / "run", resume=True)
    assert (tmp_path / "run" / "last.pt").read_bytes() == before


def test_a_runaway_loss_ends_the_run(folder: Path, tmp_path: Path) -> None:
    recipe = TINY.model_copy(update={"learning_rate": 30.0, "clip": 0.0, "warmup": 0.5, "epochs": 10})
    with pytest.raises(DivergedError):
        _train(folder, recipe, tmp_path / "run")


def test_of_two_trainings_in_one_folder_one_is_refused(folder: Path, tmp_path: Path) -> None:
    """Both began when the folder was new: the second may not write while the first does, nor after it."""
    refused: list[str] = []

    def second(progress: Progress) -> None:
        if not refused and progress.values is None:
            with pytest.raises(InputError) as error:
                late[0].train()
            refused.append(str(error.value))

    first = Trainer(open_store(folder), ONE, tmp_path / "run", on_progress=second)
    late = [Trainer(open_store(folder), ONE.model_copy(update={"seed": k}), tmp_path / "run") for k in (1, 2)]
    first.train()
    assert refused == [f"{tmp_path / 'run'}: another training is at work in it: choose another --out"]
    with pytest.raises(InputError, match=r"last\.pt: another training has written it in the meantime"):
        late[1].train()
    assert load_run(tmp_path / "run").recipe.seed == ONE.seed
    assert [line["epoch"] for line in read_log(tmp_path / "run")] == [0]
    (tmp_path / "run" / "last.pt").unlink()
    (tmp_path / "run" / "best.pt").unlink()
    _train(folder, ONE, tmp_path / "run")  # the refused ones hold no lock


def test_what_is_there_is_not_overwritten(folder: Path, run: Path, tmp_path: Path) -> None:
    before = (run / "last.pt").read_bytes()
    with pytest.raises(InputError, match="--resume goes on"):
        _train(folder, ONE, run)
    with pytest.raises(InputError, match="was trained with batch 4, the recipe now has 2"):
        _train(folder, ONE.model_copy(update={"batch": 2}), run, resume=True)
    other = write_store(tmp_path / "other.zarr", seed=9, frames=2)
    with pytest.raises(InputError, match="trained on dataset uuid-0-3"):
        _train(other, ONE, run, resume=True)
    assert (run / "last.pt").read_bytes() == before
    (run / "last.pt").write_bytes(before[:1000])
    with pytest.raises(InputError, match="not a readable checkpoint"):
        _train(folder, ONE, run, resume=True)
    with pytest.raises(InputError, match="no such checkpoint"):
        _train(folder, ONE, tmp_path / "nothing", resume=True)
    assert not (tmp_path / "nothing").exists()


def test_recipes(tmp_path: Path) -> None:
    paper = load_recipe("paper")
    assert (paper.model, paper.learning_rate, paper.batch, paper.epochs) == ("cegnn", 1e-4, 64, 200)
    assert set(RECIPES) >= {"fast", "paper"}
    file = tmp_path / "mine.yaml"
    file.write_text("name: mine\nepochs: 2\n")
    assert load_recipe(str(file)).epochs == 2
    file.write_text("name: mine\nepoch: 2\n")
    with pytest.raises(InputError, match="key epoch"):
        load_recipe(str(file))
    file.write_text("[1, 2")
    with pytest.raises(InputError, match="not YAML"):
        load_recipe(str(file))
    with pytest.raises(InputError, match="expected fast, quick, cegnn, paper or a YAML file"):
        load_recipe("slow")


def test_command_trains_and_refuses(folder: Path, tmp_path: Path) -> None:
    runner = CliRunner()
    arguments = [str(folder), "--recipe", "quick", "--split", "shape", "--epochs", "1", "--threads", "1"]
    done = runner.invoke(app, [*arguments, "--out", str(tmp_path / "run")])
    assert done.exit_code == 0, done.output
    assert "best.pt" in done.output
    again = runner.invoke(app, [*arguments, "--out", str(tmp_path / "run")])
    assert again.exit_code == 2
    assert again.stderr.count("\n") == 1
    bad = runner.invoke(app, [str(folder), "--fold", "9", "--out", str(tmp_path / "x")])
    assert bad.exit_code == 2
    assert "key fold" in bad.stderr
    nowhere = runner.invoke(app, [str(tmp_path / "no.zarr")])
    assert nowhere.exit_code == 2
    assert "no dataset there" in nowhere.stderr


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on(folder: Path, tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "learn.train",
        str(folder),
        "--epochs",
        "500",
        "--out",
        str(tmp_path / "run"),
    ]
    process = subprocess.Popen(command, env=_environment(), cwd=ROOT, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 600
    while not (tmp_path / "run" / "best.pt").exists() and time.monotonic() < until:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=600)
    assert process.returncode == 130
    assert "--resume goes on" in error
    assert load_run(tmp_path / "run").recipe.epochs == 500


@pytest.mark.slow
@pytest.mark.parametrize("data", ["memory", "stream"])
def test_two_processes_of_torchrun_train_one_model(tmp_path: Path, data: str) -> None:
    folder = write_store(tmp_path / "s.zarr", sites=4, frames=3)  # three training shards
    recipe = tmp_path / "two.yaml"
    recipe.write_text(f"name: two\nepochs: 2\nbatch: 4\ndata: {data}\n")
    command = [
        sys.executable, "-m", "torch.distributed.run", "--nproc-per-node", "2", "--standalone",
        "-m", "learn.train", str(folder), "--recipe", str(recipe), "--out", str(tmp_path / "run"),
        "--threads", "1",
    ]  # fmt: skip
    done = subprocess.run(command, env=_environment(), cwd=ROOT, timeout=600, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    log = read_log(tmp_path / "run")
    assert [line["epoch"] for line in log] == [0, 1]
    assert log[-1]["step"] > 2
    assert load_run(tmp_path / "run").epoch in (1, 2)


def test_a_stream_of_fewer_shards_than_processes_is_refused(folder: Path, tmp_path: Path) -> None:
    """It would train nothing: each process would wait for the others' batches."""
    recipe = TINY.model_copy(update={"data": "stream"})
    group = ProcessGroup(0, 2, torch.device("cpu"))
    with pytest.raises(InputError, match="1 shards to train on cannot be split among 2 processes"):
        Trainer(open_store(folder), recipe, tmp_path / "run", process_group=group)


def test_fewer_frames_than_a_batch_are_refused_by_several_processes(folder: Path, tmp_path: Path) -> None:
    """One process would train on a batch that the other does not have."""
    group = ProcessGroup(0, 2, torch.device("cpu"))
    with pytest.raises(InputError, match=r"frames to train on are no batch of 64 for 2 processes"):
        Trainer(
            open_store(folder), TINY.model_copy(update={"batch": 64}), tmp_path / "run", process_group=group
        )


def test_dropout_of_an_epoch_does_not_depend_on_where_the_run_was_resumed(
    folder: Path, tmp_path: Path
) -> None:
    """Of each process apart: a checkpoint holds the state of one alone."""
    recipe = TINY.model_copy(update={"model": "cegnn", "epochs": 1})
    drawn = []
    for rank in (0, 1):
        trainer = Trainer(open_store(folder), recipe, tmp_path / f"run{rank}")
        trainer.group = ProcessGroup(rank, 1, torch.device("cpu"))
        for before in (1, 2):  # whatever was drawn before
            torch.manual_seed(before)
            trainer._batches = lambda: iter(())  # type: ignore[method-assign]
            trainer._epoch()
            drawn.append(torch.rand(3).tolist())
    assert drawn[0] == drawn[1] != drawn[2] == drawn[3]


@pytest.mark.parametrize("data", ["memory", "stream"])
def test_batches_prepared_in_advance_train_the_same(folder: Path, tmp_path: Path, data: str) -> None:
    """As on a GPU, where another thread draws the dropped points of the next batches."""
    recipe = Recipe.model_validate(
        {
            "name": "tiny",
            "epochs": 2,
            "batch": 2,
            "model": "invariant-gnn-small",
            "point_dropout": 0.6,
            "data": data,
        }
    )
    weights = []
    for ahead in (0, 2):
        trainer = Trainer(open_store(folder), recipe, tmp_path / f"run{ahead}")
        assert trainer.ahead == 0
        trainer.ahead = ahead
        trainer.train()
        weights.append(_weights(tmp_path / f"run{ahead}"))
    assert _same(*weights)


@pytest.mark.parametrize("model", ["invariant-gnn-small", "cegnn"])
def test_a_step_encodes_the_interiors_of_its_batch_alone(tmp_path: Path, model: str) -> None:
    """What is predicted is as over all interiors; both models, of which one reads the profile itself."""
    recipe = TINY.model_copy(update={"model": model, "batch": 2, "point_dropout": 0.0})
    store = open_store(write_store(tmp_path / "s.zarr", shapes=5, sites=1, frames=2))
    trainer = Trainer(store, recipe, tmp_path / "run")
    scene_of_all, seen = Scenes.of(store).scenes[0], set()
    trainer.model.eval()
    with torch.no_grad():
        of_all = trainer.model.encode(scene_of_all, trainer.prepared[0])
    for _, parts in trainer.augmentation.each(trainer.train_data.batches(2, seed=1, epoch=0), 0):
        [(scene, prepared, batch)] = parts
        assert prepared is trainer.prepared[0]
        assert len(scene.profile) == len(batch.geometry.unique())
        seen.add(len(scene.rigid))
        interior = torch.from_numpy(store.geometry[store.frame_poke[batch.frame.numpy()]])
        with torch.no_grad():
            one = trainer.model(scene, pokes_of(batch))
            other = trainer.model.decode(of_all, pokes_of(replace(batch, geometry=interior)))
        torch.testing.assert_close(one.displacement, other.displacement, rtol=0, atol=1e-9)
        torch.testing.assert_close(one.force, other.force, rtol=1e-4, atol=0)
    assert seen == {1, 2}  # inclusions
    assert len(np.unique(store.shape[store.frame_poke[trainer.split.train]])) > 2


def test_best_weights_without_their_training_are_not_overwritten(folder: Path, run: Path) -> None:
    """A run is kept so for release. A stop within the first epoch leaves best.pt alone: it begins again."""
    store = open_store(folder)
    first = load_checkpoint(run / "best.pt")
    (run / "best.pt").unlink()
    with pytest.raises(InputError, match=r"best\.pt: missing beside last\.pt"):
        Trainer(store, ONE, run, resume=True)  # might end without any
    (run / "last.pt").unlink()
    for content, asked in (({**first, "epoch": 2}, ONE), (first, ONE.model_copy(update={"seed": 1}))):
        save_checkpoint(run / "best.pt", content)
        before = (run / "best.pt").read_bytes()
        with pytest.raises(InputError, match=r"the best\.pt of another training is there.*another --out"):
            Trainer(store, asked, run)
        assert (run / "best.pt").read_bytes() == before
    save_checkpoint(run / "best.pt", first)
    Trainer(store, ONE, run)
