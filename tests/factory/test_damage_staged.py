"""A damaged build in progress: one sentence instead of a traceback, damaged results are simulated again."""

from __future__ import annotations

import io
import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from factory.build import app as build_app
from factory.building.build import BuildProgress
from factory.errors import InputError
from factory.inspect import app as inspect_app
from factory.plan import Plan
from factory.store.staging import Staging, building_folder
from factory.verify import app as verify_app
from tests.factory.conftest import Builder, digest, run_app


def _torn(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-2000])


def _empty(path: Path) -> None:
    path.write_bytes(b"")


def _words(path: Path) -> None:
    path.write_text("my thesis\n" * 100)


def _flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def _folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def _other_poke(path: Path) -> None:
    shutil.copyfile(path.with_name("poke-00000.npz"), path)


def _rewritten(change: Callable[[dict[str, Any]], None]) -> Callable[[Path], None]:
    def rewrite(path: Path) -> None:
        with np.load(path) as kept:
            arrays = dict(kept)
        change(arrays)
        buffer = io.BytesIO()
        np.savez(buffer, **arrays)
        path.write_bytes(buffer.getvalue())

    return rewrite


def _unnamed_other(path: Path) -> None:
    """Another poke's result as an earlier version staged it, without the index of its poke."""
    _other_poke(path)
    _rewritten(lambda arrays: arrays.pop("poke"))(path)


def _pickled(path: Path) -> None:
    buffer = io.BytesIO()
    np.savez(buffer, depth=np.array([{"a": 1}], dtype=object))
    path.write_bytes(buffer.getvalue())


DAMAGE: dict[str, tuple[Callable[[Path], None], str]] = {
    "torn": (_torn, "zip"),
    "empty": (_empty, "No data left in file"),
    "no zip": (_words, "pickled"),
    "flipped bit": (_flipped, ""),
    "folder": (_folder, "Is a directory"),
    "of another poke": (_other_poke, "is the result of poke 0"),
    "of another scene": (_unnamed_other, "is the result of another scene"),
    "array gone": (_rewritten(lambda a: a.pop("rod_tip")), "has no array"),
    "array cut": (_rewritten(lambda a: a.update(depth=a["depth"][:-1])), "has type float64 and shape"),
    "array of words": (_rewritten(lambda a: a.update(status=np.array("x"))), "array status has type"),
    "not finite": (_rewritten(lambda a: a["rod_force"].__setitem__((0, 0), np.nan)), "not finite"),
    "unknown status": (_rewritten(lambda a: a.update(status=np.uint8(99))), "status 99 is unknown"),
    "triangle": (_rewritten(lambda a: a["surface_triangle"].__setitem__((0, 0), 10**6)), "no such node"),
    "pickle": (_pickled, ""),
}


# "of another poke" and "of another scene" replace a result by that of poke 0, which itself stays valid
_TOGETHER = [list(DAMAGE)[i : i + 2] for i in range(0, len(DAMAGE), 2)]


@pytest.mark.parametrize("names", _TOGETHER, ids=[" and ".join(names) for names in _TOGETHER])
def test_a_damaged_result_is_set_aside_and_simulated_again(
    names: list[str],
    plan: Plan,
    finished_store: Path,
    stopped: Path,
    standin_build: Builder,
    caplog: pytest.LogCaptureFixture,
) -> None:
    for poke, name in enumerate(names, start=1):
        DAMAGE[name][0](Staging(stopped).result_path(poke))
    assert run_app(inspect_app, stopped).exit_code == 0
    built = standin_build(plan, stopped)
    assert (built.simulated, built.damaged, built.errors) == (3, (1, 2), {})
    for poke, name in enumerate(names, start=1):
        (message,) = (m for m in caplog.messages if f"set aside as poke-0000{poke}.damaged-1" in m)
        assert "the poke is simulated again" in message
        assert DAMAGE[name][1] in message
    assert digest(stopped) == digest(finished_store)


def test_inspect_names_a_damaged_result(stopped: Path) -> None:
    _torn(Staging(stopped).result_path(1))
    shown = run_app(inspect_app, stopped)
    assert "2 of 4 pokes, 0 failed, 1 damaged" in shown.output
    assert "poke 1: its staged result is damaged (" in shown.output


def test_a_result_that_is_damaged_while_the_store_is_written(
    plan: Plan, finished_store: Path, standin_build: Builder, tmp_path: Path
) -> None:
    target, calls = tmp_path / "a.zarr", []

    def spoil(state: BuildProgress) -> None:
        calls.append(state.done)
        if calls == [0, 1, 2, 3, 4]:
            _torn(state.staging.result_path(2))

    built = standin_build(plan, target, on_progress=spoil)
    assert (built.simulated, built.damaged) == (5, (2,))
    assert digest(target) == digest(finished_store)


def test_a_disk_that_damages_everything_ends_the_build(
    plan: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    def spoil(state: BuildProgress) -> None:
        if state.done == 4:
            _torn(state.staging.result_path(2))

    with pytest.raises(InputError, match=r"staged result of poke 2: .*3 times in a row; is the disk sound"):
        standin_build(plan, tmp_path / "a.zarr", on_progress=spoil)
    assert Staging(tmp_path / "a.zarr").finished() == {0, 1, 2, 3}


def test_foreign_files_among_the_results(
    plan: Plan, finished_store: Path, stopped: Path, standin_build: Builder
) -> None:
    results = Staging(stopped).results
    for name in ("poke-abc.npz", "poke-0000001.npz", "thesis.txt", "poke-00001.damaged-1"):
        (results / name).write_text("precious")
    shutil.copyfile(results / "poke-00000.npz", results / "poke-00099.npz")  # beyond the plan
    (results / "poke-00003.error").write_bytes(b"\xff\xfe torn")
    assert "1 damaged" in run_app(inspect_app, stopped).output
    built = standin_build(plan, stopped)
    assert (built.simulated, built.damaged) == (1, (99,))
    assert digest(stopped) == digest(finished_store)


LEDGERS = [
    b"",
    b"\xff\xfe\x00",
    b'[1, 2]\nnull\n3\n"x"\n' + b"[" * 100_000 + b"\n",
    b'{"poke": "0", "wall_seconds": 1}\n{"poke": 0}\n{"poke": true, "wall_seconds": 1}\n',
    b'{"poke": 0, "wall_seconds": "long", "error": null}\n{"poke": 1, "wall_seconds": null}\n',
    b'{"poke": 0, "wall_seconds": NaN}\n{"poke": 1, "wall_seconds": 1e999}\n{"poke": 1, "wall_seconds": -3}',
    b'{"poke": 0, "wall_seconds": 1.0, "core_seconds": {}, "error": 5}\n',
]


@pytest.mark.parametrize("ledger", LEDGERS, ids=[str(i) for i in range(len(LEDGERS))])
def test_an_edited_ledger_stops_nobody(ledger: bytes, plan: Plan, store: Path, stopped: Path) -> None:
    Staging(stopped).ledger_file.write_bytes(ledger)
    assert run_app(inspect_app, stopped).exit_code == 0
    recipe = stopped.parent / "tiny.yaml"
    arguments = ("--model", "ogden", "--recipe", recipe, "--out", stopped)
    assert run_app(build_app, *arguments, "--dry-run").exit_code == 0
    (store / "provenance" / "ledger.jsonl").write_bytes(ledger)
    assert run_app(inspect_app, store).exit_code == 0
    assert run_app(verify_app, store).exit_code == 0
    del plan


@pytest.mark.parametrize(
    "content", [b"", b"{", b"null", b"[]", b"3", b"\xff", b"[" * 100_000], ids=[str(i) for i in range(7)]
)
def test_a_damaged_plan_file_is_named(
    content: bytes, plan: Plan, stopped: Path, standin_build: Builder
) -> None:
    file = Staging(stopped).plan_file
    file.write_bytes(content)
    with pytest.raises(InputError, match=re.escape(f"{file}: is damaged: give --overwrite")):
        standin_build(plan, stopped)
    assert Staging(stopped).finished() == {0, 1, 2}  # the refusal loses nothing
    shown = run_app(inspect_app, stopped)
    assert shown.exit_code == 2
    assert shown.stderr.startswith(f"error: {file}: ")
    if content in (b"{", b"null"):  # no JSON, or no plan at all
        assert standin_build(plan, stopped, overwrite=True).simulated == 4


def test_inspect_names_what_is_wrong_in_a_plan_file(stopped: Path) -> None:
    file = Staging(stopped).plan_file
    identity = json.loads(file.read_text())
    del identity["recipe"]["softness"], identity["recipe"]["protocol"]
    file.write_text(json.dumps(identity))
    shown = run_app(inspect_app, stopped)
    assert shown.exit_code == 2
    assert "keys recipe.protocol, recipe.softness: these keys are missing" in shown.stderr


def test_a_link_in_the_building_folder_is_removed_not_followed(
    plan: Plan, stopped: Path, standin_build: Builder, tmp_path: Path
) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("precious")
    (building_folder(stopped) / "link").symlink_to(precious)
    standin_build(plan, stopped)
    assert not building_folder(stopped).exists()
    assert (precious / "thesis.txt").exists()
