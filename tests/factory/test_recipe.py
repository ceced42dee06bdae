"""Recipes, cards and plans: the paper's numbers, random draws, and invalid input in one sentence."""

from __future__ import annotations

import math
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from factory.errors import InputError
from factory.plan import Plan, make_plan
from factory.recipe import Recipe, load_recipe, recipe_names
from factory.strict_yaml import read_yaml
from tests.factory.conftest import TINY
from tisim.bodies import BoxInclusion, CylinderInclusion, SphereInclusion


@pytest.fixture(scope="module")
def plan() -> Plan:
    """The paper's 1,320 pokes, planned once."""
    return make_plan(load_recipe("paper"), "ogden")


def test_the_papers_recipe(plan: Plan) -> None:
    assert len(plan.pokes) == 11 * 3 * 40 == 1320
    assert {type(inclusion) for inclusion in plan.inclusions} == {
        BoxInclusion,
        SphereInclusion,
        CylinderInclusion,
    }
    assert plan.recipe.levels == ("S0", "S0.5", "S1")
    assert [card.stiffness for card in plan.cards] == [0.8, 0.4, 0.0]
    scene = plan.pokes[0].scene
    assert (scene.depth, scene.frame_spacing, scene.rod.radius, scene.rod.length) == (
        0.02,
        0.001,
        0.0025,
        0.04,
    )
    assert scene.block.size == (0.1, 0.1, 0.032)
    assert [poke.index for poke in plan.pokes] == list(range(1320))


def test_quick_is_of_the_same_kind() -> None:
    quick, paper = load_recipe("quick"), load_recipe("paper")
    assert len(quick.shapes) >= 2
    assert quick.levels == paper.levels
    assert len(make_plan(quick, "ogden").pokes) >= 12
    assert quick.protocol.depth_mm >= 10  # a third of the paper's: it builds in minutes
    for key in ("frame_spacing_mm", "margin_mm", "max_angle_deg"):
        assert getattr(quick.protocol, key) == getattr(paper.protocol, key)
    assert (quick.block_mm, quick.rod, quick.friction) == (paper.block_mm, paper.rod, paper.friction)


def test_shared_sites_are_shared_and_own_ones_are_not(plan: Plan) -> None:
    for shape in range(11):
        where = [
            [
                (poke.scene.site, poke.scene.direction)
                for poke in plan.pokes
                if (poke.shape, poke.level, poke.shared) == (shape, softness, shared)
            ]
            for shared in (True, False)
            for softness in range(3)
        ]
        assert where[0] == where[1] == where[2]
        assert all(len(sites) == 20 for sites in where)
        assert len({*where[0], *where[3], *where[4], *where[5]}) == 80
    assert len({poke.seed for poke in plan.pokes}) == 11 * 80


def test_draws_stay_in_their_bounds_and_fill_them(plan: Plan) -> None:
    pokes = plan.pokes
    sites = np.array([poke.scene.site for poke in pokes])
    assert np.abs(sites).max() <= 0.030
    assert np.abs(sites).max() > 0.0295
    angles = np.degrees([math.acos(-poke.scene.direction[2]) for poke in pokes])
    assert 0 <= angles.min() < 1
    assert 44 < angles.max() <= 45
    assert angles.mean() == pytest.approx(22.5, abs=1.5)
    np.testing.assert_allclose(np.linalg.norm([p.scene.direction for p in pokes], axis=1), 1)


def test_an_indenter_that_leaves_through_a_side_is_refused() -> None:
    """The contact points lie inside; the inclined path leaves the block."""
    paper = load_recipe("paper")
    near = paper.model_copy(update={"protocol": paper.protocol.model_copy(update={"margin_mm": 6.5})})
    with pytest.raises(InputError, match=r"protocol\.margin_mm: expected .* got 6.5: that of poke"):
        make_plan(near, "ogden")
    upright = near.protocol.model_copy(update={"max_angle_deg": 0.0})
    assert make_plan(near.model_copy(update={"protocol": upright}), "ogden").pokes


def test_inclusions_stand_on_the_base_below_enough_silicone(plan: Plan) -> None:
    line = np.linspace(-0.05, 0.05, 101)
    for inclusion, shape in zip(plan.inclusions, plan.recipe.shapes, strict=True):
        grid = np.stack(np.meshgrid(line, line, np.arange(0.0001, 0.032, 0.0005)), axis=-1)
        held = grid[inclusion.contains(grid)]
        assert held[:, 2].min() < 0.0002
        assert held[:, 2].max() <= 0.032 - 0.008
        assert held[:, 2].max() == pytest.approx(shape.top_mm * 1e-3, abs=6e-4)
        assert np.abs(held[:, :2]).max() <= 0.040


def test_a_plan_is_a_function_of_the_recipe(plan: Plan) -> None:
    again = make_plan(load_recipe("paper"), "ogden")
    assert again.pokes == plan.pokes
    assert again.uuid == plan.uuid
    quick = load_recipe("quick")
    one, law = make_plan(quick, "ogden"), make_plan(quick, "neo-hookean")
    other = make_plan(quick.model_copy(update={"seed": 1}), "ogden")
    assert len({one.uuid, law.uuid, other.uuid, plan.uuid}) == 4
    assert other.pokes[0].scene.site != one.pokes[0].scene.site


def _tiny() -> dict[str, Any]:
    data: dict[str, Any] = yaml.safe_load(TINY)
    return data


BAD: list[tuple[str, str, str]] = [
    ("{", "not valid YAML", ""),
    ("- 1", "expected keys and values at the top level", ""),
    ("", "expected keys and values at the top level", ""),
    (TINY.replace("seed: 3", "seed: three"), "key seed: input should be a valid integer", "'three'"),
    (TINY.replace("seed: 3", "seed: -1"), "key seed: ", "greater than or equal to 0"),
    (TINY.replace("seed: 3\n", ""), "key seed: this key is missing", ""),
    (TINY + "colour: red\n", "key colour: unknown key", ""),
    (TINY.replace("friction: 0.6", "friction: .nan"), "key friction: ", "finite"),
    (TINY.replace("friction: 0.6", "friction: true"), "key friction: ", "valid number"),
    (TINY.replace("own_sites: 2", "own_sites: 1.5"), "key protocol.own_sites: ", "integer"),
    (TINY.replace("max_angle_deg: 45", "max_angle_deg: 60"), "key protocol.max_angle_deg: ", "equal to 45"),
    (TINY.replace("depth_mm: 30", "depth_mm: 0"), "key protocol.depth_mm: ", "greater than 0"),
    (TINY.replace("[100, 100, 32]", "[100, 100]"), "key block_mm.2: this key is missing", ""),
    (TINY.replace("margin_mm: 20", "margin_mm: 50"), "margin_mm: expected less than half", ""),
    (TINY.replace("kind: cube", "kind: torus"), "key shapes.0: ", "'cube', 'sphere', 'cylinder'"),
    (TINY.replace("side_mm: 18", "side_mm: 25"), "shapes.cube-18: its top at 25 mm leaves less", "32 mm"),
    (TINY.replace("border_mm: 10", "border_mm: 45"), "shapes.cube-18: wider than the block", ""),
    (TINY.replace("[S0, S1]", "[S0, S0]"), "softness: expected different names", ""),
    (TINY.replace("[S0, S1]", "[]"), "key softness: ", "at least 1 item"),
    (TINY.replace("[S0, S1]", "[../S0]"), "key softness.0: ", "pattern"),
    (TINY.replace("own_sites: 2", "own_sites: 0"), "at least one poke", ""),
    (TINY.replace("[S0, S1]", "S0"), "key softness: expected a list", "'S0'"),
    (TINY.replace("radius_mm: 2.5", "radius_mm: 2,5"), "key rod.5: expected a name", "decimals have points"),
    (TINY.replace("depth_mm: 30", "depth_mm: 0.02"), "protocol.depth_mm: expected a depth in mm", "metres?"),
    # all missing and unknown keys
    (
        TINY.replace("depth_mm: 30, ", "depth: 30, "),
        "key protocol.depth_mm: this key is missing",
        "depth_mm?",
    ),
    (TINY.replace("seed: 3\n", "").replace("friction: 0.6\n", ""), "keys seed, friction: these keys", ""),
    (
        TINY.replace("side_mm: 18", "side: 18"),
        "key shapes.0.side_mm: this key is missing",
        "shapes.0.side: unkn",
    ),
    (TINY.replace("side_mm: 18", "side_mm: -1"), "key shapes.0.side_mm: ", "greater than 0"),
    (TINY.replace("kind: cube, ", ""), "key shapes.0.kind: this key is missing", ""),
    (TINY.replace("kind: cube", "kind: [cube]"), "key shapes.0: ", "'cube', 'sphere', 'cylinder'"),
    # shapes that do not fit into a block
    (TINY.replace("depth_mm: 30", "depth_mm: 32"), "depth_mm: expected less than the block's height", "32"),
    (TINY.replace("depth_mm: 30", "depth_mm: 50"), "depth_mm: expected less than the block's height", "50"),
    (
        TINY.replace("edge_radius_mm: 1}", "edge_radius_mm: 3}"),
        "key rod: edge_radius_mm: expected at most",
        "2.5",
    ),
    (TINY.replace("margin_mm: 20", "margin_mm: 0"), "margin_mm: expected at least 6.36 mm", "45 degrees"),
    (TINY.replace("margin_mm: 20", "margin_mm: 6.3"), "margin_mm: expected at least 6.36 mm", "got 6.3"),
    (
        TINY.replace(
            "kind: cube, id: cube-18, side_mm: 18", "kind: sphere, id: s, radius_mm: 9, sunk_mm: 18"
        ),
        "shapes.s: its top is at 0 mm: expected at least 1 mm",
        "",
    ),
    (
        TINY.replace(
            "kind: cube, id: cube-18, side_mm: 18", "kind: sphere, id: s, radius_mm: 9, sunk_mm: 30"
        ),
        "shapes.s: its top is at -12 mm",
        "",
    ),
    (
        TINY.replace("cover_mm: 8", "cover_mm: 0").replace("side_mm: 18", "side_mm: 31.5"),
        "leaves less than",
        "",
    ),
    # frames that no memory holds
    (
        TINY.replace("frame_spacing_mm: 1", "frame_spacing_mm: 1e-9"),
        "key protocol: frame_spacing_mm: expected at least 0.003, which is 10000 frames a poke",
        "got 1e-09",
    ),
    # YAML beyond limits
    (TINY + "seed: 4\n", "line 14: key seed is given twice (first at line 4)", ""),
    ("yes: 1\ntrue: 2\n", "line 2: key true is given twice (first at line 1)", ""),
    ("1: a\n+1: b\n", "line 2: key +1 is given twice (first at line 1)", ""),
    (
        TINY.replace("radius_mm: 2.5,", "radius_mm: 2.5, radius_mm: 3,"),
        "key radius_mm is given twice",
        "line 6",
    ),
    ("name: " + "[" * 100_000, "line 1: nested deeper than 40 levels", ""),
    ("a:\n" + "".join("  " * i + "- \n" for i in range(200)) + "x", "", ""),
    ("name: &a [*a]\n", "line 1: an alias stands inside of what it refers to", ""),
    ("a: &a {b: *a}\n", "an alias stands inside of what it refers to", ""),
    (
        "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
        + "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 12)),
        "holds more than 50000 values once its aliases are expanded",
        "",
    ),
    (
        "a0: &a0 [x]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}]\n" for i in range(1, 100)),
        "nested deeper than 40 levels once its aliases are expanded",
        "",
    ),
    (TINY.replace("seed: 3", "seed: 2026-13-45"), "key seed: input should be a valid integer", "2026-13-45"),
    (TINY.replace("seed: 3", "seed: 2026-11-22"), "key seed: input should be a valid integer", ""),
    (TINY.replace("seed: 3", "seed: 2001-01-01 99:99:99"), "", ""),
    (TINY.replace("seed: 3", "seed: " + "9" * 30), "line 4: expected a whole number below 2^64", "got 999"),
    (TINY.replace("seed: 3", "seed: " + "9" * 5000), "line 4: cannot read the value 999", ""),
    (TINY.replace("seed: 3", "seed: 0x" + "f" * 5000), "key seed: input should be a valid integer", ""),
    (TINY.replace("seed: 3", "seed: 010"), "key seed: input should be a valid integer, got '010'", ""),
    (TINY.replace("depth_mm: 30", "depth_mm: 1e999"), "key protocol.depth_mm: ", ""),
    (TINY.replace("seed: 3", "seed: !!python/object/apply:os.getcwd []"), "not valid YAML at line 4", "tag"),
    (TINY + "? [a, b]\n: 3\n", "line 14: expected a plain word as key", ""),
    (TINY + "---\nname: two\n", "not valid YAML at line 14", "single document"),
    (TINY + "1: 2\n", "", "1"),
    ("a: \0\n", "not valid YAML", ""),
    ("x" * 1_000_001, "expected at most 1000000 bytes, got 1000001", ""),
]


@pytest.mark.parametrize(("text", "first", "second"), BAD, ids=[str(i) for i in range(len(BAD))])
def test_bad_recipes(text: str, first: str, second: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    began = time.process_time()
    with pytest.raises(InputError) as caught:
        load_recipe(str(path))
    assert time.process_time() - began < 5.0
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert first in message
    assert second in message
    assert "\n" not in message


def test_what_is_no_file_is_not_read(tmp_path: Path) -> None:
    """Reading would wait for a pipe, and would not end for a device."""
    os.mkfifo(tmp_path / "pipe.yaml")
    for path in (tmp_path / "pipe.yaml", Path("/dev/zero")):
        with pytest.raises(InputError, match="expected a file"):
            load_recipe(path)
    with pytest.raises(InputError, match="expected a file"):
        load_recipe(tmp_path)
    (tmp_path / "latin.yaml").write_bytes(b"name: \xe4\n")
    with pytest.raises(InputError, match="expected UTF-8 text"):
        load_recipe(tmp_path / "latin.yaml")


def test_aliases_and_merge_keys_within_limits(tmp_path: Path) -> None:
    path = tmp_path / "aliases.yaml"
    path.write_text(TINY.replace("margin_mm: 20", "margin_mm: &d 20").replace("depth_mm: 30", "depth_mm: *d"))
    assert load_recipe(path).protocol.depth_mm == 20


def test_a_hemisphere_has_no_edge(tmp_path: Path) -> None:
    path = tmp_path / "round.yaml"
    path.write_text(
        TINY.replace(
            "radius_mm: 2.5, length_mm: 40, tip: flat", "radius_mm: 0.5, length_mm: 40, tip: hemisphere"
        )
    )
    assert load_recipe(path).rod.edge_radius_mm > load_recipe(path).rod.radius_mm


def _paths(value: object, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    found = [path] if path else []
    if isinstance(value, dict):
        for key in value:
            found += _paths(value[key], (*path, key))
    if isinstance(value, list):
        for number, item in enumerate(value):
            found += _paths(item, (*path, number))
    return found


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=5),
    st.lists(st.integers(), max_size=3),
)


@given(st.sampled_from(_paths(_tiny())), JUNK)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_junk_in_any_place_is_valid_or_named(tmp_path: Path, where: tuple[Any, ...], junk: object) -> None:
    data: Any = _tiny()
    holder = data
    for key in where[:-1]:
        holder = holder[key]
    holder[where[-1]] = junk
    path = tmp_path / "junk.yaml"
    path.write_text(yaml.safe_dump(data))
    try:
        recipe = read_yaml(path, Recipe)
    except InputError as error:
        assert str(error).startswith(f"{path}: ")  # noqa: PT017 - either outcome is right
    else:
        assert recipe.pokes_each > 0


def test_recipes_by_name() -> None:
    names = ["blocks", "covers", "paper", "quick", "sample", "surrogate", "surrogate-law", "timed", "wide"]
    assert recipe_names() == names
    with pytest.raises(
        InputError,
        match="--recipe papper: expected a path of a YAML file or one of: blocks, covers, paper",
    ):
        load_recipe("papper")
    with pytest.raises(InputError, match=r"cannot read nowhere\.yaml: No such file"):
        load_recipe("nowhere.yaml")
