"""A store of the finished pokes of a stopped build: a smaller dataset of the same form."""

from __future__ import annotations

from pathlib import Path

import pytest

from factory.build import app
from factory.building.build import build_dataset, in_turns
from factory.errors import InputError
from factory.inspect import app as inspect_app
from factory.inspection.features import features
from factory.inspection.summary import summarise
from factory.plan import Plan, make_plan
from factory.reader import open_dataset
from factory.recipe import load_recipe
from factory.store.staging import Staging, building_folder
from factory.verify import app as verify_app
from tests.factory.conftest import Builder, digest, run_app


def test_the_first_pokes_are_of_all_shapes_and_levels() -> None:
    plan = make_plan(load_recipe("paper"), "ogden")
    ordered = in_turns(plan)
    assert sorted(poke.index for poke in ordered) == list(range(len(plan.pokes)))
    first = ordered[: 33 * 6]
    assert {sum(poke.geometry == key for poke in first) for key in range(33)} == {6}
    assert sum(poke.shared for poke in first) == 33 * 3


def test_a_partial_store_has_what_there_is_and_the_build_goes_on(
    plan: Plan, standin_build: Builder, finished_store: Path, stopped: Path
) -> None:
    # nothing is simulated: this simulator does not exist
    built = build_dataset(plan, stopped, partial=True, simulator="tests.factory.nowhere:simulate")
    assert (built.simulated, built.missing, built.errors) == (0, 1, {})
    some, whole = open_dataset(stopped), open_dataset(finished_store)
    done = [i for i in range(4) if some.table["done"][i]]
    assert sorted(some.table["poke_softness"][done]) == [0, 0, 1]
    assert some.attributes["pokes_done"] == 3
    for i in done:
        assert (some.poke(i).rod_force == whole.poke(i).rod_force).all()
    assert len(Staging(stopped).finished()) == 3
    assert standin_build(plan, stopped).simulated == 1
    assert digest(stopped) == digest(finished_store)
    assert not building_folder(stopped).exists()


def test_its_preview_shows_what_there_is(
    plan: Plan, tiny_file: Path, stopped: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[int] = []
    monkeypatch.setattr(
        "factory.inspection.figures.draw_preview", lambda _plan, traces, _path, _of: drawn.append(len(traces))
    )
    done = run_app(app, "--model", "ogden", "--recipe", tiny_file, "--out", stopped, "--partial")
    assert done.exit_code == 0, done.output
    assert drawn == [3]
    assert f"{len(plan.pokes)} pokes" in done.output


def test_a_partial_store_without_a_poke_is_refused(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--partial: no poke of it is finished yet"):
        build_dataset(plan, tmp_path / "none.zarr", partial=True)
    assert list(tmp_path.glob("none*")) == []


def test_what_a_partial_store_lacks_is_no_fault(plan: Plan, stopped: Path) -> None:
    build_dataset(plan, stopped, partial=True)
    (lacking,) = open_dataset(stopped).waiting
    verified = run_app(verify_app, stopped)
    assert verified.exit_code == 0, verified.output
    assert "3 pokes" in verified.output
    assert "no fault; 1 poke not simulated yet" in verified.output
    shown = " ".join(run_app(inspect_app, stopped).output.split())
    assert "partial: 3 of 4 pokes, 0 failed, 1 not simulated yet" in shown
    rows = features(open_dataset(stopped), summarise(stopped).done)
    assert sum(row.ended.get("not simulated yet", 0) for row in rows) == 1
    assert sum(row.ended.get("failed", 0) for row in rows) == 0
    refused = run_app(inspect_app, stopped, "--poke", lacking)
    assert "Traceback" not in refused.output


def test_the_command_says_that_the_store_is_partial(stopped: Path, tiny_file: Path) -> None:
    arguments = ["--model", "ogden", "--recipe", tiny_file, "--out", stopped, "--partial"]
    done = run_app(app, *arguments)
    assert done.exit_code == 0, done.output
    assert "3 of 4 pokes (partial: the others are marked as not done" in " ".join(done.output.split())
    refused = run_app(app, *arguments, "--overwrite")
    assert refused.exit_code == 2
    assert "--partial: expected without --overwrite" in " ".join(refused.output.split())
    assert open_dataset(stopped).attributes["pokes_done"] == 3
