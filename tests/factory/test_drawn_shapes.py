"""Shapes with lengths that a recipe draws between two bounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from factory._errors import InputError
from factory.plan import make_plan
from factory.recipe import Recipe, load_recipe
from tests.factory.conftest import TINY

CUBES = {"kind": "cube", "id": "cube", "draw": 20, "side_mm": [6, 20]}


def read(folder: Path, *shapes: dict[str, Any], **changed: object) -> Recipe:
    path = folder / "recipe.yaml"
    path.write_text(yaml.safe_dump({**yaml.safe_load(TINY), "shapes": list(shapes), **changed}))
    return load_recipe(path)


def test_as_many_as_asked_for_between_the_two_lengths(tmp_path: Path) -> None:
    stated = {"kind": "cube", "id": "mine", "side_mm": 9.0}
    recipe = read(tmp_path, CUBES, stated)
    assert [shape.id for shape in recipe.shapes] == [*(f"cube-{k + 1:02}" for k in range(20)), "mine"]
    sides = np.array([shape.lengths_mm["side"] for shape in recipe.shapes[:-1]])
    assert 6 <= sides.min() < 8
    assert 18 < sides.max() <= 20
    assert len(set(sides)) == 20
    # afterwards they are ordinary shapes: part of the plan and of the store
    assert Recipe.model_validate(recipe.model_dump(by_alias=True)) == recipe


def test_the_draws_depend_on_the_seed_and_the_entry_alone(tmp_path: Path) -> None:
    first = read(tmp_path, CUBES).shapes
    assert read(tmp_path, CUBES, friction=0.1).shapes == first
    assert read(tmp_path, CUBES, seed=4).shapes != first
    both = read(tmp_path, CUBES, {**CUBES, "id": "other"}).shapes
    assert both[:20] == first
    assert [s.lengths_mm for s in both[20:]] != [s.lengths_mm for s in first]


def test_each_leaves_the_cover_and_the_border(tmp_path: Path) -> None:
    tall = {"kind": "cylinder", "id": "c", "draw": 30, "radius_mm": [3, 60], "height_mm": [5, 40]}
    recipe = read(tmp_path, tall, cover_mm=4)
    assert max(shape.top_mm for shape in recipe.shapes) <= 28
    assert max(shape.reach_mm for shape in recipe.shapes) <= 40


def test_the_wide_recipe() -> None:
    plan = make_plan(load_recipe("wide"), "ogden")
    assert len(plan.recipe.shapes) == 42
    assert len(plan.pokes) == 840
    assert sum(not poke.derived for poke in plan.pokes) == 420
    covers = [plan.recipe.block_mm[2] - shape.top_mm for shape in plan.recipe.shapes]
    assert 3 <= min(covers) < 4
    assert max(covers) > 24


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"side_mm": [20, 6]},
            "key shapes.0.side_mm: expected the smaller of two lengths first, got 20 and 6",
        ),
        ({"side_mm": [6, 9, 12]}, "key shapes.0.side_mm: tuple should have at most 2 items"),
        ({"side_mm": [0, 9]}, "key shapes.0.side_mm.0: input should be greater than 0, got 0"),
        ({"side_mm": [29, 31]}, "shapes.cube: none of 1000 drawn fits; of the last, its top at"),
        ({"draw": 0}, "key shapes.0.draw: input should be greater than or equal to 1, got 0"),
        ({"kind": "cone"}, "key shapes.0: expected as kind one of 'cube', 'sphere', 'cylinder'"),
        ({"hight_mm": 3}, "key shapes.0.hight_mm: unknown key"),
    ],
)
def test_bad_draws_are_one_sentence(tmp_path: Path, changed: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, {**CUBES, **changed})
    assert sentence in str(caught.value)
    assert "recipe.yaml: " in str(caught.value)


def test_what_they_are_drawn_from_is_named_where_it_is_wrong(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"key border_mm: input should be greater than or equal to 0"):
        read(tmp_path, CUBES, border_mm=-1)
