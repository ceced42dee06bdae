"""The graph that the browser runs agrees with `learn.real_time`."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
import torch

from learn.errors import InputError
from learn.page import command
from learn.page.content import Content, content_of
from learn.page.controls import with_units
from learn.page.simulated import quantised
from learn.predictor import Predictor
from tests.learn.commands import call, refused


@pytest.fixture(scope="module")
def content(predictor: Predictor) -> Content:
    return content_of(predictor, pokes=2)


def _ask(content: Content, interior: int, poke: list[float]) -> dict[str, torch.Tensor]:
    inputs = [torch.from_numpy(array) for array in content.inputs[interior].values()]
    with torch.no_grad():
        found = content.graph(torch.tensor(poke, dtype=torch.float64), *inputs)
    return dict(zip(content.graph.outputs(), found, strict=True))


@pytest.mark.parametrize("name", ["shape-0", "shape-2", "none"])
def test_it_answers_as_real_time_does(predictor: Predictor, content: Content, name: str) -> None:
    """Displacement, force, direction, distance from the trained ranges, intervals."""
    names = [interior["name"] for interior in content.about["interiors"]]
    inside = {"inclusion": {"kind": "none"}} if name == "none" else {"shape": name}
    touch = predictor.real_time({**inside, "shear_modulus_kPa": 12.0})
    random, outside = np.random.default_rng(1), 0
    for depth in (5e-4, 1.5e-3, 2e-3, 6e-3, 1e-7):
        x, y = random.uniform(-0.03, 0.03, 2)
        angle, heading, modulus = random.uniform((0.0, -3.0, 8e3), (0.6, 3.0, 4e4))
        touch.modulus = modulus
        sine = math.sin(angle)
        push = (sine * math.cos(heading), sine * math.sin(heading), -math.cos(angle))
        true = touch(site=(x, y), direction=push, depth=depth)
        found = _ask(content, names.index(name), [x, y, angle, heading, depth, modulus])
        largest = np.abs(true.displacement).max()
        assert np.abs(found["displacement"].numpy() - true.displacement).max() < 3e-6 * largest
        assert float(found["force"]) == pytest.approx(true.force, rel=1e-5)
        np.testing.assert_allclose(found["direction"].numpy(), push, atol=1e-12)
        assert float(found["distance"]) == pytest.approx(true.distance, rel=1e-6, abs=1e-9)
        assert true.force_interval is not None
        assert float(found["factor"]) == pytest.approx(true.force_interval[1] / true.force, rel=1e-6)
        np.testing.assert_allclose(found["radius"].numpy(), true.radius, rtol=1e-4)
        assert bool((found["beyond"] > 0).any()) is not true.inside
        outside += not true.inside
    assert outside > 0


def test_beyond_names_the_quantities_of_the_domain(predictor: Predictor, content: Content) -> None:
    """The page's table and `Domain.check` agree on the quantities that are outside."""
    assert predictor.domain is not None
    for poke in ([0.0, 0.0, 0.1, 0.0, 0.012, 1e4], [0.04, 0.0, 0.7, 0.0, 2e-3, 9e4]):
        found = _ask(content, 0, poke)
        keys = [row["key"] for row in content.about["checks"]]
        values = dict(zip(keys, found["values"].tolist(), strict=False))
        checks = predictor.domain.check(values, content.about["interiors"][0]["kind"])
        assert [check.key for check in checks] == keys
        # an inclusion's kind that the dataset does not state is unknown, neither inside nor outside
        assert (found["beyond"] > 0).tolist() == [check.inside is False for check in checks]


def test_units_of_excesses_that_an_earlier_zip_lacks_are_read_off_the_ranges(content: Content) -> None:
    rows = [row for row in content.about["checks"] if row["trained"] not in ("any", "not known")]
    assert {row["unit"] for row in rows} == {"the range", "the trained value"}
    earlier = [{key: value for key, value in row.items() if key != "unit"} for row in rows]
    assert with_units(earlier) == rows
    assert with_units([{"trained": "0 mm", "unit": "30 mm"}]) == [{"trained": "0 mm", "unit": "30 mm"}]


def test_a_rod_that_does_not_touch_has_no_force(content: Content) -> None:
    found = _ask(content, 0, [0.0, 0.0, 0.0, 0.0, 0.0, 1e4])
    assert float(found["force"]) == 0.0
    assert not found["displacement"].any()
    assert not found["radius"].any()
    assert all(bool(torch.isfinite(value).all()) for value in found.values())


def test_simulated_pokes_are_those_of_the_test_part(predictor: Predictor, content: Content) -> None:
    """Displacements in 16 bits err by half a step; the surrogate takes the exact pose of the simulation."""
    store = predictor.store
    shown = content.about["simulated"]
    assert len(shown) == 2
    for number, about in enumerate(shown):
        poke = int(about["label"].split("poke ")[1].rstrip(")"))
        rows = slice(int(store.frame_start[poke]), int(store.frame_start[poke] + store.frame_count[poke]))
        truth, steps = store.displacement(rows), np.array(about["steps"])
        moved = content.arrays[f"simulated-{number}"] * steps[:, None, None]
        assert (np.abs(moved - truth).max(axis=(1, 2)) <= 0.51 * steps).all()
        assert steps.max() * 32767 == pytest.approx(np.abs(truth).max())
        p = about["poke"]
        pose = [p["x"] * 1e-3, p["y"] * 1e-3, math.radians(p["angle"]), math.radians(p["heading"]), 1e-3, 1e4]
        found = _ask(content, p["interior"], pose)
        np.testing.assert_allclose(found["direction"].numpy(), store.direction[poke], atol=1e-9)
        assert about["forces"] == pytest.approx(np.linalg.norm(store.rod_force[rows], axis=1).tolist())
    still = quantised(np.zeros((1, 4, 3), dtype=np.float32))
    assert not still[0].any()


def test_the_sliders_reach_beyond_what_was_trained(predictor: Predictor, content: Content) -> None:
    assert predictor.domain is not None
    sliders = content.about["sliders"]
    for key, name in (("depth", "depth_mm"), ("modulus", "shear_modulus_kPa")):
        low, high = predictor.domain.ranges[name]
        assert sliders[key]["trained"]["range"] == [low, high]
        assert sliders[key]["low"] < low
        assert sliders[key]["high"] > high
    start = content.about["start"]
    for key, limits in sliders.items():
        assert limits["low"] <= start[key] <= limits["high"], key


def test_what_has_no_page_is_refused(predictor: Predictor, tmp_path: Path) -> None:
    refused(call(command.app, tmp_path, "--out", tmp_path / "poke.html"), str(tmp_path))
    assert not (tmp_path / "poke.html").exists()
    with pytest.raises(InputError, match="--shape shape-9: expected one of shape-0"):
        content_of(predictor, shapes=["shape-9"])
    store = predictor.store
    part = dataclasses.replace(store, done=store.done & (store.shape != 0))
    with pytest.raises(
        InputError, match="--shape shape-0: expected one of shape-1, shape-2"
    ):  # not simulated
        content_of(Predictor(predictor.run, part), shapes=["shape-0"])
    other = Predictor(dataclasses.replace(predictor.run, model=torch.nn.Linear(1, 1)), predictor.store)
    with pytest.raises(InputError, match="expected one run of invariant-gnn or invariant-gnn-small"):
        content_of(other)
