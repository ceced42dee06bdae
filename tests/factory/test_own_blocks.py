"""Recipes whose shapes have blocks of their own: drawn and stated sides."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from factory.build import app as build_app
from factory.errors import InputError
from factory.plan import make_plan
from factory.recipe import Recipe, load_recipe
from tests.factory.conftest import TINY, run_app

SIDES = [[60, 90], [60, 90], [20, 34]]
CUBES = {"kind": "cube", "id": "cube", "draw": 15, "side_mm": [6, 24]}
STATED = {"kind": "sphere", "id": "ball", "radius_mm": 11}


def read(folder: Path, *shapes: dict[str, Any], **changed: object) -> Recipe:
    keys = {**yaml.safe_load(TINY), "block_mm": SIDES, "cover_mm": 3, "shapes": list(shapes)}
    keys["protocol"] = {**keys["protocol"], "depth_mm": 12}
    path = folder / "recipe.yaml"
    path.write_text(yaml.safe_dump({**keys, **changed}))
    return load_recipe(path)


def sides(recipe: Recipe) -> np.ndarray[Any, Any]:
    return np.array([recipe.block_of(shape) for shape in recipe.shapes])


def test_each_shape_has_a_block_between_the_limits_that_it_fits(tmp_path: Path) -> None:
    """Drawn shapes and stated ones."""
    recipe = read(tmp_path, CUBES, *({**STATED, "id": f"ball-{k}"} for k in range(5)))
    found = sides(recipe)
    low, high = np.array(SIDES).T
    assert (found >= low).all()
    assert (found <= high).all()
    assert (np.ptp(found, axis=0) > 0.6 * (high - low)).all()
    assert len(np.unique(found[:, 2])) == 20
    np.testing.assert_array_equal(found, found.round(2))
    tops, reach = (np.array([getattr(s, key) for s in recipe.shapes]) for key in ("top_mm", "reach_mm"))
    assert (tops + 3 <= found[:, 2]).all()
    assert (reach + 10 <= found[:, :2].min(axis=1) / 2).all()
    assert (tops + 3 > 20).sum() > 5, "some would not fit in every block"


def test_the_draws_depend_on_the_seed_and_the_entry_alone(tmp_path: Path) -> None:
    first = read(tmp_path, CUBES, STATED).shapes
    assert read(tmp_path, CUBES, STATED, friction=0.1).shapes == first
    assert not set(read(tmp_path, CUBES, STATED, seed=4).shapes) & set(first)
    assert read(tmp_path, CUBES, {**STATED, "id": "other"}).shapes[:15] == first[:15]


def test_sides_resolve_into_the_identity(tmp_path: Path) -> None:
    recipe = read(tmp_path, {**CUBES, "draw": 2}, {**STATED, "block_mm": [80, 70, 30]})
    found = make_plan(recipe, "ogden").identity["recipe"]
    assert found["block_mm"] == SIDES
    assert [shape["block_mm"] for shape in found["shapes"]] == sides(recipe).tolist()
    assert found["shapes"][2]["block_mm"] == [80, 70, 30]
    # afterwards nothing is drawn any more
    assert Recipe.model_validate(recipe.model_dump(by_alias=True)) == recipe
    assert recipe.with_levels(["S1"]).shapes == recipe.shapes


def test_a_block_of_its_own_gives_all_shapes_one(tmp_path: Path) -> None:
    recipe = read(tmp_path, CUBES, {**STATED, "block_mm": [80, 70, [26, 30]]}, block_mm=[70, 70, 30])
    assert {shape.block_mm for shape in recipe.shapes[:-1]} == {(70, 70, 30)}
    own = recipe.shapes[-1].block_mm
    assert own is not None
    assert own[:2] == (80, 70)
    assert 26 <= own[2] <= 30


@pytest.mark.parametrize(
    ("name", "recipe", "scenes"),
    [
        ("paper", "b347ef9963b9f2e8", "0e7ba4eab094389e"),
        ("wide", "53e8a89951c444c7", "572bceb5a7c30ac2"),
    ],
)
def test_recipes_of_one_block_stay_what_they_were(name: str, recipe: str, scenes: str) -> None:
    """Digests of before shapes could have their own blocks."""
    plan = make_plan(load_recipe(name), "ogden")
    text = json.dumps(plan.identity["recipe"], sort_keys=True, separators=(",", ":"))
    assert hashlib.sha256(text.encode()).hexdigest().startswith(recipe)
    drawn = [
        (*p.scene.site, *p.scene.direction, *plan.inclusions[p.shape].centre, p.seed) for p in plan.pokes
    ]
    text = repr(np.round(np.array(drawn, dtype=float), 9).tolist())
    assert hashlib.sha256(text.encode()).hexdigest().startswith(scenes)


def test_the_blocks_recipe() -> None:
    plan = make_plan(load_recipe("blocks"), "ogden")  # refused if a path left its block
    assert len(plan.recipe.shapes) == 36
    assert len(plan.pokes) == 576
    assert sum(not poke.derived for poke in plan.pokes) == 288
    found = sides(plan.recipe)
    assert found.min(axis=0) == pytest.approx([70, 70, 24], abs=1.5)
    assert found.max(axis=0) == pytest.approx([130, 130, 40], abs=4)
    covers = found[:, 2] - [shape.top_mm for shape in plan.recipe.shapes]
    assert 6 <= covers.min() < 7
    assert covers.max() > 25
    done = run_app(build_app, "--model", "ogden", "--recipe", "blocks", "--dry-run")
    assert done.exit_code == 0, done.output
    assert "70.7 to 129.81 x 70.12 to 126.93 x 25.19 to 39.52 mm" in done.stdout


def test_inclusions_and_contact_points_are_within_their_block(tmp_path: Path) -> None:
    plan = make_plan(read(tmp_path, CUBES, STATED), "ogden")
    for poke in plan.pokes:
        size = np.array(poke.scene.block.size)
        np.testing.assert_allclose(size, plan.blocks[poke.geometry], rtol=0, atol=0)
        np.testing.assert_allclose(size * 1e3, plan.recipe.block_of(plan.recipe.shapes[poke.shape]))
        assert (np.abs(poke.scene.site) <= size[:2] / 2 - 0.020).all()
        low, high = plan.inclusions[poke.shape].bounds
        assert (np.abs([low, high])[:, :2] <= size[:2] / 2 - 0.010 + 1e-12).all()


def test_draws_fill_the_block_that_they_are_in(tmp_path: Path) -> None:
    """A larger block spreads the inclusion and the contact points of its shape alone."""
    other = {"kind": "cube", "id": "other", "side_mm": 8, "block_mm": [70, 70, 30]}
    one, two = (
        make_plan(read(tmp_path, other, {**STATED, "block_mm": [*wide, 30]}), "ogden")
        for wide in ([60, 60], [90, 80])
    )
    reach = one.recipe.shapes[1].reach_mm
    room, sites = (np.array([45, 40]) - gap for gap in (10 + reach, 20))
    grown = room / (30 - 10 - reach)
    np.testing.assert_allclose(two.inclusions[1].centre[:2], grown * one.inclusions[1].centre[:2])
    for first, second in zip(one.pokes, two.pokes, strict=True):
        factor = sites / (30 - 20) if first.shape else 1.0
        np.testing.assert_allclose(second.scene.site, factor * np.array(first.scene.site))
    assert one.inclusions[0] == two.inclusions[0]


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"block_mm": [[90, 60], 60, 30]}, "key block_mm.0: expected the smaller of two lengths first"),
        ({"block_mm": [60, [60, 70, 80], 30]}, "key block_mm.1: tuple should have at most 2 items"),
        ({"block_mm": [60, [60], 30]}, "key block_mm.1.1: this key is missing"),
        ({"block_mm": [60, 60, [0, 30]]}, "key block_mm.2.0: input should be greater than 0, got 0"),
        ({"block_mm": [60, "wide", [20, 30]]}, "key block_mm.1: input should be a valid number, got 'wide'"),
        ({"block_mm": [60, [60, 70]]}, "key block_mm.2: this key is missing"),
        ({"block_mm": [[60, 70], 60, [14, 16]]}, "shapes.cube: none of 1000 drawn fits; of the last, its"),
        (
            {"shapes": [{**STATED, "radius_mm": 17}]},
            "shapes.ball: block_mm: none of 1000 drawn fits; of the last, its top at 34 mm leaves less",
        ),
        ({"shapes": [{**STATED, "block_mm": [60, 60, 24]}]}, "shapes.ball: its top at 22 mm leaves less"),
        ({"shapes": [{**STATED, "block_mm": [60, 60]}]}, "key shapes.0.block_mm.2: this key is missing"),
        ({"shapes": [{**STATED, "block_mm": None}]}, "key shapes.0.block_mm: expected a list"),
        ({"shapes": [{**STATED, "radius_mm": -1}]}, "key shapes.0.radius_mm: input should be greater than 0"),
        ({"shapes": [{**CUBES, "block_mm": [60, -1, 30]}]}, "key shapes.0.block_mm.1: input should be"),
        ({"border_mm": -1}, "key border_mm: input should be greater than or equal to 0"),
        (
            {"shapes": [{**STATED, "block_mm": [60, 38, 30]}], "border_mm": 1},
            "shapes.ball: protocol.margin_mm: expected less than half of the block's sides",
        ),
        (
            {"shapes": [{"kind": "cube", "id": "low", "side_mm": 6, "block_mm": [60, 60, 10]}]},
            "shapes.low: protocol.depth_mm: expected less than the block's height of 10 mm, got 12",
        ),
    ],
)  # fmt: skip
def test_bad_blocks_are_one_sentence(tmp_path: Path, changed: dict[str, Any], sentence: str) -> None:
    shapes = changed.pop("shapes", [{**CUBES, "side_mm": [15, 24]}])
    with pytest.raises(InputError) as caught:
        read(tmp_path, *shapes, **changed)
    assert sentence in str(caught.value)
    assert "recipe.yaml: " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_indenter_that_leaves_its_block_is_refused_by_the_shapes_name(tmp_path: Path) -> None:
    recipe = read(tmp_path, {**STATED, "block_mm": [60, 60, 30]})
    protocol = recipe.protocol.model_copy(update={"margin_mm": 4.0, "own_sites": 40})
    near = recipe.model_copy(update={"protocol": protocol})
    with pytest.raises(InputError, match=r"got 4: that of poke \d+ in the block of ball ends at x = "):
        make_plan(near, "ogden")
