"""Damaged runs and stores, and a full disk: one sentence that names the file, exit code 2, no loss."""

from __future__ import annotations

import errno
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
import zarr

import learn.bench
import learn.evaluate
import learn.export
import learn.onnx_bundle
import learn.predict
import learn.train
import learn.training
from learn.data import open_store
from learn.data.tables import TABLES
from learn.errors import InputError
from learn.evaluation import Evaluation, intervals_file
from learn.evaluation.report import write_report
from learn.training import Recipe, Trainer, load_run, read_log, run_folder
from learn.training.run_folder import load_checkpoint, save_checkpoint
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import write_manifest, write_store

POKE = "site_mm: [5, -10]\ndepth_mm: 2\nshape: shape-1\nsoftness: S1\n"


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    return write_store(tmp_path_factory.mktemp("damage") / "s.zarr", sites=2, frames=2)


@pytest.fixture(scope="module")
def whole(store: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    recipe = "name: tiny\nepochs: 1\nbatch: 8\nmodel: invariant-gnn-small\n"
    return train_small(store, tmp_path_factory.mktemp("run") / "run", recipe=recipe)


@pytest.fixture
def run(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "run"))


def _content(**changes: Any) -> Callable[[Path], None]:
    """Change best.pt: set keys, or remove those whose value is None."""

    def spoil(run: Path) -> None:
        content = load_checkpoint(run / "best.pt")
        for key, value in changes.items():
            if value is None:
                del content[key]
            else:
                content[key] = value
        save_checkpoint(run / "best.pt", content)

    return spoil


def _bytes(data: bytes) -> Callable[[Path], None]:
    def spoil(run: Path) -> None:
        (run / "best.pt").write_bytes(data)

    return spoil


def _torn(run: Path) -> None:
    path = run / "best.pt"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _weights(change: Callable[[dict[str, torch.Tensor]], None]) -> Callable[[Path], None]:
    def spoil(run: Path) -> None:
        content = load_checkpoint(run / "best.pt")
        change(content["model"])
        save_checkpoint(run / "best.pt", content)

    return spoil


def _folder(run: Path) -> None:
    (run / "best.pt").unlink()
    (run / "best.pt").mkdir()


def _moved(run: Path) -> None:
    _content(location="/nowhere/s.zarr")(run)
    (run / TABLES).unlink()


def _another_pickle(run: Path) -> None:
    torch.save([1, 2, 3], run / "best.pt")


DAMAGES: dict[str, tuple[Callable[[Path], None], str]] = {
    "missing": (lambda run: (run / "best.pt").unlink(), "best.pt: no such checkpoint"),
    "a folder": (_folder, "best.pt: no such checkpoint"),
    "empty": (_bytes(b""), "not a readable checkpoint"),
    "text": (_bytes(b"hello"), "not a readable checkpoint"),
    "torn": (_torn, "not a readable checkpoint"),
    "another object": (_another_pickle, "expected a checkpoint of format 1"),
    "no recipe": (_content(recipe=None), "key recipe: this key is missing"),
    "recipe of another type": (_content(recipe="fast"), "key recipe: "),
    "garbled recipe": (_content(recipe={"batch": "many"}), "key batch: "),
    "unknown model": (_content(recipe={"model": "best"}), "key model: expected one of"),
    "no statistics": (_content(statistics={}), "key statistics."),
    "statistics of another type": (_content(statistics=[1]), "key statistics: "),
    "groups of another type": (_content(groups={"train": 3}), "key groups.train: "),
    "no uuid": (_content(uuid=None), "key uuid: this key is missing"),
    "location of another type": (_content(location=3), "key location: "),
    "no weights": (_content(model={}), "does not fit model"),
    "weights of another type": (_content(model={"a": 3}), "key model.a: "),
    "a weight is gone": (_weights(lambda w: w.pop("look.weight")), "does not fit model"),
    "a weight is not finite": (_weights(lambda w: w["look.weight"].fill_(float("nan"))), "look.weight"),
    "garbled domain": (_content(domain={"ranges": {"depth_mm": [1]}}), "domain: key "),
    "dataset moved, no tables": (_moved, "if it has moved, --dataset states where"),
    "another dataset": (_content(uuid="other"), "trained on dataset other"),
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_runs(run: Path, tmp_path: Path, name: str) -> None:
    spoil, words = DAMAGES[name]
    spoil(run)
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    refused(call(learn.predict.app, run, scene, "--out", tmp_path / "out"), words)
    refused(call(learn.evaluate.app, run, "--threads", 1), words)
    assert not (tmp_path / "out").exists()
    assert not (run / "evaluation").exists()


@pytest.mark.parametrize(
    "text",
    ["", "null", "[]", "{", '{"members": []}', "[" * 100_000, '{"members": [], "level": "a"}'],
)
def test_damaged_intervals(run: Path, tmp_path: Path, text: str) -> None:
    (run / "intervals.json").write_text(text)
    scene = tmp_path / "poke.yaml"
    scene.write_text(POKE)
    refused(call(learn.predict.app, run, scene, "--out", tmp_path / "out"), "intervals.json: not readable")


@pytest.mark.parametrize("text", ["{", "[]\n", '{"step": 1}\n', '{"epoch": "a"}\n', "\ufffd\n"])
def test_a_damaged_log_is_no_fault(run: Path, text: str) -> None:
    (run / "log.jsonl").write_text(text)
    assert read_log(run) == []


def test_an_export_that_fails_leaves_the_earlier_one(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def write(_part: object, _inputs: object, path: Path, names: list[str], _out: object) -> None:
        if names == stop:
            raise KeyboardInterrupt
        path.write_text("new")

    def texts() -> dict[str, str]:
        return {path.name: path.read_text() for path in folder.iterdir()}

    folder, difference = run / "onnx", 1.0
    earlier = dict.fromkeys(("encoder.onnx", "poke.onnx", "model.json"), "old")
    folder.mkdir()
    for name, text in earlier.items():
        (folder / name).write_text(text)
    monkeypatch.setattr(learn.onnx_bundle, "need_packages", lambda: None)
    monkeypatch.setattr(learn.onnx_bundle, "write_graph", write)
    monkeypatch.setattr(learn.onnx_bundle, "largest_difference", lambda *_: difference)
    stop = ["code", "vectors", "clear", *learn.onnx_bundle.ROD]  # of poke.onnx, after encoder.onnx
    assert call(learn.export.app, run).exit_code != 0
    assert texts() == earlier
    stop = []
    refused(call(learn.export.app, run), "off torch, more than 1e-05; nothing was written")
    assert texts() == earlier
    difference = 0.0
    done = call(learn.export.app, run)
    assert done.exit_code == 0, done.output
    assert [text for text in texts().values() if text == "new"] == ["new", "new"]
    assert set(texts()) == set(earlier)
    (folder / "poke.onnx").unlink()
    refused(call(learn.bench.app, run, "--repeats", 3), f"{folder}: expected", "poke.onnx is missing")


def test_a_report_that_cannot_be_made_is_not_begun(run: Path, store: Path, tmp_path: Path) -> None:
    found = Evaluation(runs=[load_run(run)], store=open_store(store), device=torch.device("cpu"))
    with pytest.raises(AssertionError):  # it has no predictions
        write_report(found, tmp_path / "report")
    assert not (tmp_path / "report").exists()


@pytest.mark.usefixtures("unrendered", "few_motions")
def test_a_run_that_cannot_be_written_to_has_its_report(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only its intervals cannot be kept: the last thing that is tried."""

    def read_only(path: Path, _: bytes) -> None:
        raise OSError(errno.EROFS, "Read-only file system", str(path))

    monkeypatch.setattr(intervals_file, "write_whole", read_only)
    flags = ("--no-clouds", "--no-baselines", "--threads", 1, "--out", tmp_path / "out")
    done = call(learn.evaluate.app, run, *flags)
    refused(done, "cannot use", "intervals.json: Read-only file system")
    assert "is off by" in done.stdout
    assert (tmp_path / "out" / "report.html").exists()
    # nor has JSON a word for what is no number, as the errors on clouds that were left out
    text = (tmp_path / "out" / "tables.json").read_text()
    assert json.loads(text, parse_constant=pytest.fail)["cloud_interpolation_mm"] is None


def test_a_run_that_cannot_be_resumed_says_why(store: Path, run: Path) -> None:
    content = load_checkpoint(run / "last.pt")
    recipe = Recipe(**content["recipe"])
    for changes, words in (({"optimiser": {}}, "not a readable"), ({"step": "x"}, "key step")):
        save_checkpoint(run / "last.pt", {**content, **changes})
        with pytest.raises(InputError, match=words):
            Trainer(open_store(store), recipe, run, resume=True)


def _attribute(name: str, value: object) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        zarr.open_group(folder, mode="r+").attrs[name] = value

    return spoil


def _drop_attribute(name: str) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        del zarr.open_group(folder, mode="r+").attrs[name]

    return spoil


def _array(name: str, change: Callable[[Any], None]) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        change(zarr.open_group(folder, mode="r+")[name])
        write_manifest(folder)

    return spoil


def _file(name: str, text: str) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        (folder / name).write_text(text)

    return spoil


STORES: dict[str, Callable[[Path], None]] = {
    **{
        f"{name} is {value!r}": _attribute(name, value)
        for name in ("uuid", "model", "pokes", "shapes", "softness", "parameter_names", "identity")
        for value in (None, 3, "x", [], [1], {})
        if not (name == "uuid" and value == "x")
    },
    **{f"no {name}": _drop_attribute(name) for name in ("format", "uuid", "pokes", "shapes", "identity")},
    "moduli of another type": _attribute("shear_modulus", ["a"]),
    "garbled root": _file("zarr.json", "{"),
    "empty root": _file("zarr.json", ""),
    "an array's metadata is garbled": _file("depth/zarr.json", "{"),
    "poke_shape out of range": _array("poke_shape", lambda a: a.__setitem__(0, 99)),
    "poke_softness out of range": _array("poke_softness", lambda a: a.__setitem__(0, -1)),
    "manifest is a list": _file("provenance/manifest.json", "[]"),
    "manifest of another type": _file("provenance/manifest.json", '{"sha256": {"depth/c/0": 3}}'),
}


@pytest.mark.parametrize("name", STORES)
def test_damaged_stores(run: Path, store: Path, tmp_path: Path, name: str) -> None:
    copy = Path(shutil.copytree(store, tmp_path / "s.zarr"))
    STORES[name](copy)
    out = tmp_path / "out"
    refused(call(learn.evaluate.app, run, "--dataset", copy, "--out", out, "--threads", 1))
    refused(call(learn.train.app, copy, "--out", out, "--threads", 1))
    assert not out.exists()


@pytest.mark.parametrize(
    "name", ["../secret", "/etc/hostname", "depth/../../secret", "a\\..\\b", "depth//c", "."]
)
def test_a_manifest_is_not_followed_out_of_the_store(store: Path, tmp_path: Path, name: str) -> None:
    copy = Path(shutil.copytree(store, tmp_path / "s.zarr"))
    (tmp_path / "secret").write_text("secret")
    path = copy / "provenance" / "manifest.json"
    sums = json.loads(path.read_text())["sha256"]
    path.write_text(json.dumps({"sha256": {**sums, name: "0" * 64}}))
    with pytest.raises(InputError, match="leads out of the store"):
        open_store(copy)


def test_a_link_out_of_the_store_is_not_followed(store: Path, tmp_path: Path) -> None:
    copy = Path(shutil.copytree(store, tmp_path / "s.zarr"))
    shutil.move(copy / "depth" / "c", tmp_path / "elsewhere")
    (copy / "depth" / "c").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="a link that leads out of the store"):
        open_store(copy)


def test_stopped_before_the_first_checkpoint_there_is_nothing_to_resume(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(learn.training, "Trainer", stop)
    (tmp_path / "r.yaml").write_text("model: invariant-gnn-small\n")
    command = (store, "--recipe", tmp_path / "r.yaml", "--threads", 1, "--out", tmp_path / "run")
    stopped = call(learn.train.app, *command)
    assert stopped.exit_code == 130
    sentence = f"Stopped; no epoch was finished: the same command begins again ({tmp_path / 'run'}).\n"
    assert stopped.stderr == sentence
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "last.pt").touch()
    assert "Stopped; the same command with --resume goes on" in call(learn.train.app, *command).stderr


RESUMED = Recipe(name="tiny", epochs=3, batch=8, model="invariant-gnn-small")


@pytest.mark.parametrize("name", ["best.pt", "last.pt"])
def test_a_full_disk_keeps_what_was_good(
    store: Path, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """/dev/full refuses every byte, as a full disk does; with free space the command works again."""
    arguments = (store, "--recipe", tmp_path / "r.yaml", "--threads", 1, "--out", tmp_path / "run")
    (tmp_path / "r.yaml").write_text("name: tiny\nepochs: 1\nbatch: 8\nmodel: invariant-gnn-small\n")
    (tmp_path / "run").mkdir()
    part = tmp_path / "run" / f"{name}.00000000.part"
    remove = run_folder._remove_parts

    def fill(folder: Path) -> None:
        remove(folder)
        part.symlink_to("/dev/full")

    with monkeypatch.context() as patch:
        patch.setattr("secrets.token_hex", lambda _: "00000000")
        patch.setattr(run_folder, "_remove_parts", fill)
        full = call(learn.train.app, *arguments)
    refused(full, "cannot write", str(tmp_path / "run" / name), "No space left on device")
    assert "nothing was kept" in full.stderr
    assert not part.is_symlink()
    again = call(learn.train.app, *arguments)
    assert again.exit_code == 0, again.output


def test_a_disk_that_fills_up_later_is_resumed_to_the_same_weights(
    store: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Trainer(open_store(store), RESUMED, tmp_path / "whole").train()
    plain, calls = Path.replace, 0

    def full(self: Path, target: Path) -> Path:
        nonlocal calls
        calls += Path(target).name == "last.pt"
        if calls == 2 and Path(target).name == "last.pt":
            raise OSError(errno.ENOSPC, "No space left on device")
        return plain(self, target)

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space left on device"):
        Trainer(open_store(store), RESUMED, tmp_path / "parts").train()
    assert load_checkpoint(tmp_path / "parts" / "last.pt")["epoch"] == 1
    assert not list((tmp_path / "parts").glob("*.part"))
    load_run(tmp_path / "parts")
    assert [line["epoch"] for line in read_log(tmp_path / "parts")] == [0, 1]
    Trainer(open_store(store), RESUMED, tmp_path / "parts", resume=True).train()
    assert [line["epoch"] for line in read_log(tmp_path / "parts")] == [0, 1, 2]
    one, other = (load_checkpoint(tmp_path / name / "last.pt")["model"] for name in ("whole", "parts"))
    assert all(torch.equal(one[key], other[key]) for key in one)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name: a\nname: b\n", "key name: stands twice"),
        ("a: &a [*a]\n", "expected no alias"),
        ("epochs: " + "[" * 3000, "nested deeper"),
        ("epochs: true\n", "key epochs: "),
        ("epochs: .inf\n", "key epochs: "),
        ("learning_rate: .nan\n", "key learning_rate: "),
        ("learning_rate: '1'\n", "key learning_rate: "),
        ("rate: 1e-3\nlearning_rate: 1e-3\n", "rate is the old name of learning_rate"),
        ("point_jitter: 0.5\ndata: stream\n", "point_jitter needs data: memory"),
        ("name: a/b\n", "key name: "),
    ],
)
def test_bad_recipe_files(store: Path, tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "r[/x].yaml"  # brackets are no markup
    file.parent.mkdir(exist_ok=True)
    file = tmp_path / "r[bold].yaml"
    file.write_text(text)
    refused(call(learn.train.app, store, "--recipe", file, "--out", tmp_path / "out"), str(file), words)
    assert not (tmp_path / "out").exists()
