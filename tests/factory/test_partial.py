"""A store of the pokes that a stopped build has finished: a smaller dataset of the same kind."""

from __future__ import annotations

from pathlib import Path

import pytest

from factory._build import build_dataset, in_turns
from factory._input import InputError
from factory._staging import Staging, building_folder
from factory.build import app
from factory.plan import Plan, make_plan
from factory.reader import open_dataset
from factory.recipe import load_recipe
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
    # nothing is simulated: there is no such simulator
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


def test_a_partial_store_without_a_poke_is_refused(plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--partial: no poke of it is finished yet"):
        build_dataset(plan, tmp_path / "none.zarr", partial=True)
    assert list(tmp_path.glob("none*")) == []


def test_the_command_says_that_the_store_is_partial(stopped: Path, tiny_file: Path) -> None:
    arguments = ["--model", "ogden", "--recipe", tiny_file, "--out", stopped, "--partial"]
    done = run_app(app, *arguments)
    assert done.exit_code == 0, done.output
    assert "3 of 4 pokes (partial: the others are marked as not done" in " ".join(done.output.split())
    refused = run_app(app, *arguments, "--overwrite")
    assert refused.exit_code == 2
    assert "--partial: expected without --overwrite" in " ".join(refused.output.split())
    assert open_dataset(stopped).attributes["pokes_done"] == 3
