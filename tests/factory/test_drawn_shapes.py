"""Shapes with lengths that a recipe draws between two bounds."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from factory.errors import InputError
from factory.plan import make_plan
from factory.recipe import Recipe, load_recipe
from tests.factory.conftest import TINY
from tisim import inclusions

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


def test_covers_are_even_in_their_logarithm(tmp_path: Path) -> None:
    """Of covers of 3 to 24 mm, drawn evenly, half are below 13.5 mm; in their logarithm below 8.5."""
    discs = {"kind": "cylinder", "id": "c", "draw": 400, "radius_mm": [3, 20], "height_mm": [8, 29]}
    evenly, log = (
        np.array([32 - shape.top_mm for shape in read(tmp_path, {**discs, **more}, cover_mm=3).shapes])
        for more in ({}, {"cover_mm": [3, 24]})
    )
    assert np.median(evenly) == pytest.approx(13.5, abs=1.5)
    shares = np.histogram(log, np.geomspace(3, 24, 5))[0] / len(log)
    np.testing.assert_allclose(shares, 0.25, atol=0.065)  # three standard deviations of 400 draws
    narrow = read(tmp_path, {**discs, "cover_mm": [5, 6]}, cover_mm=3).shapes
    assert all(5 <= 32 - shape.top_mm <= 6 for shape in narrow)
    # afterwards they are ordinary shapes
    assert "cover_mm" not in narrow[0].model_dump()


def test_the_covers_recipe() -> None:
    """Half of the covers are thinner than 8 mm, and every second contact point lies above its inclusion."""
    plan = make_plan(load_recipe("covers"), "ogden")
    assert sum(not poke.derived for poke in plan.pokes) == 240
    covers = [plan.recipe.block_mm[2] - shape.top_mm for shape in plan.recipe.shapes]
    assert 2.5 <= min(covers) < 3.5
    assert np.median(covers) == pytest.approx(8, abs=2)
    height = np.linspace(1e-4, 0.032, 200)
    above = np.array(
        [
            plan.inclusions[poke.shape]
            .contains(np.stack([*(np.full(200, x) for x in poke.scene.site), height], axis=1))
            .any()
            for poke in plan.pokes
        ]
    )
    assert above[[poke.site % 2 == 1 for poke in plan.pokes]].all()
    assert above[[poke.site % 2 == 0 for poke in plan.pokes]].mean() < 0.3


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
        ({"cover_mm": [3, 9]}, "shapes.cube: cover_mm: expected at least the recipe's cover_mm = 8, got 3"),
        ({"cover_mm": [9, 11]}, "shapes.cube: none of 1000 drawn fits; of the last, the"),
        ({"cover_mm": 9}, "key shapes.0.cover_mm: expected a list, got 9"),
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


ONE = {"kind": "cylinder", "id": "c", "radius_mm": 4, "height_mm": 12}


def over(folder: Path, fraction: float, **changed: object) -> Recipe:
    protocol = {**yaml.safe_load(TINY)["protocol"], "shared_sites": 8, "own_sites": 4}
    return read(folder, ONE, protocol={**protocol, "over_inclusion": fraction, **changed})


def test_a_fraction_of_the_contact_points_lies_above_the_inclusion(tmp_path: Path) -> None:
    """A quarter: the fourth of each four, in both sets; the others are where they would have been."""
    some, none = (make_plan(over(tmp_path, fraction), "ogden").pokes for fraction in (0.25, 0))
    beside = [
        k
        for k, (one, other) in enumerate(zip(some, none, strict=True))
        if one.scene.site == other.scene.site and one.scene.direction == other.scene.direction
    ]
    drawn_above = [k for k in range(len(some)) if k not in beside]
    assert [k % 12 for k in drawn_above] == [3, 7, 11] * (len(some) // 12)
    for k in drawn_above:
        inclusion = some[k].scene.block.inclusion
        assert inclusion is not None
        centre = np.array(inclusion.centre)  # type: ignore[attr-defined]
        assert np.hypot(*(np.array(some[k].scene.site) - centre[:2])) <= 4e-3
    sites = np.array([some[k].scene.site for k in drawn_above])
    assert len(np.unique(sites, axis=0)) == len({(some[k].seed) for k in drawn_above})


def test_every_contact_point_above_the_inclusion_fills_its_top(tmp_path: Path) -> None:
    recipe = over(tmp_path, 1, shared_sites=0, own_sites=200)
    plan = make_plan(recipe, "ogden")
    centre = np.array(plan.inclusions[0].centre)[:2]  # type: ignore[attr-defined]
    away = np.linalg.norm(np.array([poke.scene.site for poke in plan.pokes]) - centre, axis=1)
    assert away.max() <= 4e-3
    # evenly over a disc: half of them within its radius over the root of two
    assert (away < 4e-3 / np.sqrt(2)).mean() == pytest.approx(0.5, abs=0.12)


def test_an_inclusion_that_no_contact_point_can_be_above_is_named(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"protocol\.over_inclusion: found no contact point above c that is marg"
    ):
        make_plan(over(tmp_path, 0.5, margin_mm=49, depth_mm=1, max_angle_deg=0), "ogden")
    with pytest.raises(
        InputError, match=r"key protocol\.over_inclusion: input should be less than or equal to 1"
    ):
        over(tmp_path, 1.5)


def test_recipes_without_these_keys_are_what_they_were(tmp_path: Path) -> None:
    assert "over_inclusion" not in read(tmp_path, CUBES).identity()["protocol"]
    assert over(tmp_path, 0.5).identity()["protocol"]["over_inclusion"] == 0.5


@pytest.mark.parametrize("name", ["top", "reach", "lengths", "turned", "length_0"])
def test_a_parameter_may_have_any_other_name(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also that of an attribute of a recipe's shapes."""
    cube = inclusions.recipe_shapes()["cube"]
    own = dataclasses.replace(
        cube,
        name="own",
        parameters=(inclusions.RecipeParameter(name),),
        standing=lambda p, *place: cube.standing({"side": p[name]}, *place),
        reach=None,
        top=None,
    )
    monkeypatch.setattr(inclusions, "recipe_shapes", lambda: {"own": own})
    stated, drawn = read(
        tmp_path,
        {"kind": "own", "id": "a", f"{name}_mm": 9.5},
        {"kind": "own", "id": "b", "draw": 1, f"{name}_mm": [7, 9]},
    ).shapes
    assert (stated.lengths_mm, stated.top_mm) == ({name: 9.5}, pytest.approx(9.5))
    assert 7 <= drawn.lengths_mm[name] <= 9
    assert stated.model_dump(by_alias=True)[f"{name}_mm"] == 9.5


def test_a_parameter_with_the_name_of_a_recipes_key_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cube = inclusions.recipe_shapes()["cube"]
    own = dataclasses.replace(cube, name="own", parameters=(inclusions.RecipeParameter("block"),))
    monkeypatch.setattr(inclusions, "recipe_shapes", lambda: {"own": own})
    for more in ({}, {"block_mm": 3.0}, {"draw": 2}, {"draw": 2, "block_mm": 3.0}):
        with pytest.raises(
            InputError, match=r"kind own: expected another name .* use block_mm for the block"
        ):
            read(tmp_path, {"kind": "own", "id": "a", **more})
