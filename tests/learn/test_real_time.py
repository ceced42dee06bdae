"""One interior, poke by poke: the predictor's answers, the domain, and intervals that widen outside it."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

import learn
from learn.errors import ImpossiblePokeError, InputError
from learn.evaluation import Intervals
from learn.evaluation.intervals import FORCE_UNKNOWN
from learn.predictor import Predictor
from learn.quantities import Interior, gap_mm
from learn.real_time import RealTime
from tests.learn.commands import train_small
from tests.learn.small_store import write_store

INTERIOR = {"shape": "shape-1", "softness": "S1"}
# as `learn.evaluate` fits them, with factors per ring of distance [mm]
WIDTHS = Intervals(
    level=0.9, promised=0.9, pokes=20, scale=[-3.0, -0.5, 0.0, 0.0, 0.3, 0.0, 0.0, 0.1, 0.0],
    factors=[1.5] * 5, force_scale=0.02, force=1.7,
    growth=(0.05, -0.03, 0.02), force_growth=(0.04, -0.02, 0.01),
)  # fmt: skip


@pytest.fixture(scope="module")
def predictor(tmp_path_factory: pytest.TempPathFactory) -> Predictor:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("real-time")
    store = write_store(folder / "s.zarr", shapes=3, sites=3, frames=3)
    found = learn.load(train_small(store, folder / "run", "--epochs", 1))
    found.intervals = WIDTHS
    return found


@pytest.fixture(scope="module")
def touch(predictor: Predictor) -> RealTime:
    return predictor.real_time(INTERIOR)


def _way(angle_deg: float, heading_deg: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    lean, heading = math.radians(angle_deg), math.radians(heading_deg)
    return np.array([math.sin(lean) * math.cos(heading), math.sin(lean) * math.sin(heading), -math.cos(lean)])


@pytest.mark.parametrize(("depth_mm", "inside"), [(1.5, True), (4.0, False)])
def test_it_answers_as_the_predictor_does(predictor: Predictor, depth_mm: float, inside: bool) -> None:
    angle = sum(predictor.domain.ranges["angle_deg"]) / 2 if predictor.domain else 0.0
    interior = {**INTERIOR, "shape": predictor.run.groups["train"][0]}
    touch = predictor.real_time(interior)
    scene = {"site_mm": [5, -10], "depth_mm": depth_mm, "angle_deg": angle, "heading_deg": 40, **interior}
    slow = predictor.predict(scene)
    fast = touch(site=(5e-3, -10e-3), direction=_way(angle, 40), depth=depth_mm * 1e-3)
    assert np.abs(fast.displacement - slow.displacement).max() < 3e-6 * np.abs(slow.displacement).max()
    assert fast.force == pytest.approx(slow.force, rel=1e-5)
    assert fast.force_interval == pytest.approx(slow.force_interval, rel=1e-5)
    np.testing.assert_allclose(fast.radius, slow.radius, rtol=1e-4)
    assert fast.inside is slow.inside is inside


def test_intervals_widen_with_the_distance_from_what_was_trained(touch: RealTime) -> None:
    """Far outside the radius equals the displacement, and the force has the factor exp(FORCE_UNKNOWN)."""
    widths, radii = [], []
    for depth in (2e-3, 2.5e-3, 4e-3, 12e-3):
        answer = touch(site=(5e-3, -10e-3), direction=(0.0, 0.0, -1.0), depth=depth)
        assert answer.force_interval is not None
        assert answer.radius is not None
        widths.append(math.log(answer.force_interval[1] / answer.force))
        radii.append(float((answer.radius / np.linalg.norm(answer.displacement, axis=1)).min()))
    assert (np.diff(widths) > 0).all()
    assert widths[-1] == pytest.approx(FORCE_UNKNOWN, abs=0.01)
    assert radii[-1] > 0.99


@pytest.mark.parametrize(
    ("tip", "gap"),
    [
        ((0.0005, 0.0005, -0.004), 8.0),  # above the top of the inclusion
        ((0.0165, 0.0005, -0.020), 7.0),  # beside its wall, deeper than its top
        ((0.0135, 0.0005, -0.009), 5.0),  # off its edge: 4 mm aside and 3 mm above
        ((0.0055, 0.0005, -0.020), 0.0),  # in it
        ((0.0405, 0.0005, -0.025), 5.0),  # above the base
        ((0.0405, 0.0005, -0.004), 16.0),  # far from all
    ],
)
def test_the_gap_is_the_distance_from_the_tip_to_what_is_rigid(
    tip: tuple[float, float, float], gap: float
) -> None:
    """A block 30 mm high, columns 1 mm wide, and a box with a wall at x = 9.5 mm, its top 12 mm deep."""
    x, y = np.meshgrid(np.arange(-49, 50) * 1e-3 + 5e-4, np.arange(-19, 20) * 1e-3 + 5e-4)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    soft = np.where(np.abs(points[:, 0]) < 0.0100, 0.012, 0.030)
    setup: Any = SimpleNamespace(points=points)
    assert gap_mm(setup, Interior(soft, 20.0, 18.0, 15.0), np.array(tip)) == pytest.approx(gap, abs=1e-9)


def test_intervals_are_wider_near_what_is_rigid(predictor: Predictor) -> None:
    """Of two depths of one contact, the interval of the force is the wider the smaller the gap is."""
    angle = sum(predictor.domain.ranges["angle_deg"]) / 2 if predictor.domain else 0.0
    touch, push = (
        predictor.real_time({**INTERIOR, "shape": predictor.run.groups["train"][0]}),
        _way(angle, 40),
    )
    gaps = []
    for depth in (1.2e-3, 1.8e-3):
        answer = touch(site=(5e-3, -10e-3), direction=push, depth=depth)
        assert answer.inside
        assert answer.force_interval is not None
        tip = touch._setup.first_touch((5e-3, -10e-3), push) + depth * push
        gap = gap_mm(touch._setup, touch._interior, tip)
        gaps.append((gap, math.log(answer.force_interval[1] / answer.force)))
    (far, narrow), (near, wide) = gaps
    assert near < far <= 16.0
    assert math.log(wide / narrow) == pytest.approx(-0.02 * (near - far), rel=0.02)


def test_an_answer_in_real_time_says_how_far_outside_it_is(predictor: Predictor) -> None:
    """In the words of the file's prediction, and of its checks."""
    touch = predictor.real_time(INTERIOR)
    for depth in (1.5, 2.5, 4.0):
        scene = {"site_mm": [5, -10], "depth_mm": depth, **INTERIOR}
        answer = touch(site=(5e-3, -10e-3), direction=(0.0, 0.0, -1.0), depth=depth * 1e-3)
        assert answer.verdict == predictor.predict(scene).verdict
        assert answer.distance == pytest.approx(predictor.predict(scene).distance)
    assert "depth (4 mm; trained: 1 to 2 mm; beyond by" in answer.verdict
    air = touch(site=(5e-3, -10e-3), direction=(0.0, 0.0, -1.0), depth=-1e-3)
    assert air.verdict == "No contact: nothing moves."
    touch._domain = None
    answer = touch(site=(5e-3, -10e-3), direction=(0.0, 0.0, -1.0), depth=1.5e-3)
    assert "trained ranges are not known" in answer.verdict


def test_it_shows_what_it_is_of(predictor: Predictor) -> None:
    lump = {"kind": "sphere", "radius_mm": 8, "centre_mm": [0, 0, 17]}
    touch = predictor.real_time({"inclusion": lump, "shear_modulus_kPa": 12})
    assert repr(touch).splitlines()[:6] == [
        "RealTime(",
        "  network: run, invariant-gnn-small",
        "  inclusion: sphere, radius_mm 8, centre_mm (0, 0, 17)",
        "  block: 100 x 100 x 32 mm, 1024 points on top",
        "  shear modulus: 12 kPa",
        "  intervals: 90 %, calibrated on 20 indentations",
    ]
    assert "  trained: depth 1 to 2 mm, angle " in repr(touch)
    assert "  threads: 1 of torch" in repr(touch)
    named = predictor.real_time(INTERIOR)
    named._domain = named._intervals = None
    shown = repr(named)
    for line in ("inclusion: shape-1", "intervals: none", "trained: not known"):
        assert f"  {line}\n" in shown
    none = predictor.real_time({"inclusion": {"kind": "none"}, "softness": "S0"})
    assert "  inclusion: no inclusion\n" in repr(none)


def test_another_law_is_marked_and_widens(predictor: Predictor) -> None:
    """The model's prediction is the same, since it knows one law."""
    assert predictor.domain is not None
    angle = sum(predictor.domain.ranges["angle_deg"]) / 2
    interior = {**INTERIOR, "shape": predictor.run.groups["train"][0]}
    poke = {"site": (5e-3, -10e-3), "direction": _way(angle, 40), "depth": 1.5e-3}
    scene = {**interior, "site_mm": [5, -10], "depth_mm": 1.5, "angle_deg": angle, "heading_deg": 40}
    mine, other = (predictor.predict({**scene, "law": law}) for law in (predictor.store.law, "mooney-rivlin"))
    silent = predictor.predict(scene)
    assert [check.inside for check in (mine.checks[-1], other.checks[-1])] == [True, False]
    assert "law" not in [check.key for check in silent.checks]
    assert "material law (mooney-rivlin; trained: " in other.verdict
    assert "; counted as 10 % of a range). The force may be wrong" in other.verdict
    assert mine.inside is silent.inside is True
    assert mine.force == other.force == silent.force
    assert other.force_interval is not None
    assert mine.force_interval == silent.force_interval
    assert mine.force_interval is not None
    assert other.force_interval[1] > mine.force_interval[1]
    here = predictor.real_time(interior)(**poke)  # type: ignore[arg-type]
    there = predictor.real_time({**interior, "law": "mooney-rivlin"})(**poke)  # type: ignore[arg-type]
    assert (here.inside, there.inside) == (True, False)
    assert there.force_interval == pytest.approx(other.force_interval, rel=1e-4)
    assert there.force == here.force


def test_a_rod_that_does_not_touch_has_no_force(touch: RealTime) -> None:
    for site, depth in (((0.0, 0.0), 0.0), ((0.0, 0.0), -1e-3), ((0.2, 0.0), -1e-3)):  # the last beside it
        answer = touch(site=site, direction=(0.0, 0.0, -1.0), depth=depth)
        assert answer.force == 0.0
        assert not answer.displacement.any()
        assert answer.force_interval is None
        assert (answer.inside, answer.distance) == (True, 0.0)  # this is exact, whatever was trained


def test_just_after_contact_an_error_is_no_larger_than_the_travel(predictor: Predictor) -> None:
    """The fitted error is extrapolated there, by a polynomial in ln(depth) that rises without bound."""
    steep = replace(WIDTHS, scale=[-3.0, -0.5, 0.0, 0.0, 0.3, 0.3, 0.0, 0.1, 0.0])
    touch = predictor.real_time(INTERIOR)
    touch._intervals = steep
    for depth in (1e-9, 1e-30):
        answer = touch(site=(0.0, 0.0), direction=(0.0, 0.0, -1.0), depth=depth)
        size = np.linalg.norm(answer.displacement, axis=1)
        assert answer.radius is not None
        np.testing.assert_allclose(answer.radius, size + depth, rtol=1e-5)
    deep = touch(site=(0.0, 0.0), direction=(0.0, 0.0, -1.0), depth=2e-3)
    assert deep.radius is not None
    assert (deep.radius < 2e-3).all()  # not the bound


@pytest.mark.parametrize(
    ("poke", "words"),
    [
        ({"direction": (0.0, 0.0, -2.0)}, "direction: expected a unit vector"),
        ({"direction": (0.0, 0.0, 1.0)}, "direction: expected a unit vector"),
        ({"direction": (0.0, math.nan, -1.0)}, "direction: expected a unit vector"),
        ({"depth": math.nan}, "finite site and depth"),
        ({"site": (math.inf, 0.0)}, "finite site and depth"),
        ({"site": (0.0, 0.0, 0.032)}, r"site: expected \(x, y\), got"),
        ({"direction": (0.0, -1.0)}, "direction: expected a unit vector"),
        ({"direction": ((0.0, 0.0, -1.0),)}, "direction: expected a unit vector"),
    ],
)
def test_nonsense_is_refused(touch: RealTime, poke: dict[str, object], words: str) -> None:
    plain: dict[str, object] = {"site": (0.0, 0.0), "direction": (0.0, 0.0, -1.0), "depth": 1e-3}
    with pytest.raises(InputError, match=words) as refused:
        touch(**{**plain, **poke})  # type: ignore[arg-type]
    assert not isinstance(refused.value, ImpossiblePokeError)


@pytest.mark.parametrize(
    ("poke", "reason", "words"),
    [
        (
            {"site": (0.0, 0.048)},
            "site",
            r"site: expected x within -0.0475 to 0.0475 m and y .*got \(0, 0.048\) m",
        ),
        ({"site": (-0.048, 0.0)}, "site", "site: expected x within"),
        ({"site": (5.0, -10.0), "depth": 4.0}, "site", r"site: expected .*got \(5, -10\) m"),  # millimetres
        ({"depth": 4.0}, "depth", "depth: expected less than the block's height of 0.032 m, got 4 m"),
        ({"direction": _way(46, 30)}, "angle", "at most 45 degrees from the vertical, got 46$"),
        ({"depth": 0.015}, "inclusion", "within the rigid .* under 0.0103 m of cover there, got 0.015 m"),
    ],
)
def test_poses_that_no_poke_can_have_are_refused_with_their_reason(
    predictor: Predictor, poke: dict[str, object], reason: str, words: str
) -> None:
    lump = {"kind": "sphere", "radius_mm": 8, "centre_mm": [0, 0, 14]}
    touch = predictor.real_time({"inclusion": lump, "softness": "S1"})
    plain: dict[str, object] = {"site": (0.0, 0.0), "direction": (0.0, 0.0, -1.0), "depth": 1e-3}
    with pytest.raises(ImpossiblePokeError, match=words) as refused:
        touch(**{**plain, **poke})  # type: ignore[arg-type]
    assert refused.value.reason == reason
    assert touch(**plain).force > 0.0  # type: ignore[arg-type]  # it answers the next


@pytest.mark.parametrize(
    ("x", "angle", "free"),
    [
        (0.0, 0.0, 10.0),  # onto the top of the sphere
        (-4.0, 0.0, 11.1),  # onto its flank
        (-12.0, 0.0, None),  # beside it
        (-12.0, 45.0, 16.4),  # from the side into its flank: beyond it, the tip would have passed through it
        (6.0, 45.0, None),  # away from it
    ],
)
def test_no_tip_goes_into_an_inclusion_nor_through_it(
    predictor: Predictor, x: float, angle: float, free: float | None
) -> None:
    """The same depths [mm] are refused in real time and in files; `free` by geometry, to 1 mm."""
    sphere = {"kind": "sphere", "radius_mm": 8, "centre_mm": [12, -9, 14]}
    interior = {"inclusion": sphere, "softness": "S1"}
    touch, push = predictor.real_time(interior), _way(angle, 0)
    touches, goes_in = (8.0, 20.0, 28.0), ()
    if free is not None:
        touches, goes_in = (free - 2.0, free - 1.0), (free + 1.0, 20.0, 28.0)
    for depth in (*touches, *goes_in):
        scene = {**interior, "site_mm": [12 + x, -9], "depth_mm": depth, "angle_deg": angle}
        site = ((12 + x) * 1e-3, -9e-3)
        if depth in touches:
            predictor.predict(scene)
            touch(site=site, direction=push, depth=depth * 1e-3)
            continue
        with pytest.raises(InputError, match=r"key depth_mm: .* within the rigid inclusion"):
            predictor.predict(scene)
        with pytest.raises(ImpossiblePokeError, match=r"depth: .* within the rigid inclusion"):
            touch(site=site, direction=push, depth=depth * 1e-3)
    touch(site=(-0.030, 0.030), direction=push, depth=0.020)  # elsewhere nothing is in the way


@pytest.mark.parametrize("modulus", [0.0, -1e3, math.nan, math.inf])
def test_a_modulus_that_is_none_is_refused(predictor: Predictor, modulus: float) -> None:
    touch = predictor.real_time(INTERIOR)
    touch.modulus = modulus
    with pytest.raises(InputError, match="modulus: expected a shear modulus above 0 Pa"):
        touch(site=(0.0, 0.0), direction=(0.0, 0.0, -1.0), depth=1e-3)


def test_an_interior_has_no_poke_and_no_unknown_keys(predictor: Predictor) -> None:
    with pytest.raises(InputError, match="unexpected key depth_mm"):
        predictor.real_time({**INTERIOR, "depth_mm": 3})
    with pytest.raises(InputError, match="unexpected key time_s: the model was trained without time"):
        predictor.real_time({**INTERIOR, "time_s": 1.0})
    with pytest.raises(InputError, match="key shape"):
        predictor.real_time({**INTERIOR, "shape": "shape-9"})
