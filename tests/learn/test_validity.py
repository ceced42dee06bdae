"""The distance of a poke from the trained ranges, and the sentences that state it."""

from __future__ import annotations

import math

import pytest

from learn.validity import OTHER_LAW, Domain
from learn.verdict import distance_of, verdict


def test_distance_is_in_units_of_the_trained_ranges() -> None:
    domain = Domain(
        ranges={"depth_mm": (1.0, 21.0), "rod_radius_mm": (2.5, 2.5), "site_to_side_mm": (20.0, 50.0)},
        kinds=("cube",), law="ogden", proportional=("shear_modulus_kPa",),
    )  # fmt: skip
    plain = {"depth_mm": 5.0, "rod_radius_mm": 2.5, "site_to_side_mm": 60.0, "shear_modulus_kPa": 1e4}

    def distance(**changes: float) -> float:
        return domain.distance({**plain, **changes})

    assert distance() == 0.0
    assert distance(depth_mm=31.0) == pytest.approx(0.5, abs=5e-3)
    assert distance(rod_radius_mm=4.0) == pytest.approx(0.6, abs=5e-3)
    assert distance(site_to_side_mm=5.0) == pytest.approx(0.5, abs=0.01)
    assert distance(depth_mm=31.0, rod_radius_mm=4.0) == pytest.approx(math.hypot(0.5, 0.6), abs=5e-3)
    assert [domain.knows(kind) for kind in ("cube", None, "sphere")] == [True, True, False]
    assert all(check.inside for check in domain.check(plain, "cube"))
    upright = Domain(ranges={"angle_deg": (0.0, 0.0)}, kinds=("cube",), law="ogden")  # vertical pokes alone
    assert upright.distance({"angle_deg": 0.05}) == 0.0
    assert upright.distance({"angle_deg": 40.1}) == pytest.approx(4.0)
    assert domain.distance(plain, "ogden") == 0.0
    assert domain.distance({**plain, "depth_mm": 31.0}, "yeoh") == pytest.approx(
        math.hypot(0.5, OTHER_LAW), abs=5e-3
    )


@pytest.mark.parametrize(
    ("changes", "kind", "places", "follows"),
    [
        (
            {"angle_deg": 45.2},
            "cube",
            "Just outside the trained ranges: angle (45.2 degrees; trained: 0 to 44.8 degrees; "
            "beyond by 0.6 % of the range). ",
            "Errors may be larger than inside; the intervals are little wider, ",
        ),
        (
            {"depth_mm": 23.0},
            "cube",
            "Outside the trained ranges: depth (23 mm; trained: 1 to 21 mm; beyond by 9.8 % of the range). ",
            "The force may be wrong by a factor; the intervals are wider, ",
        ),
        (
            {"depth_mm": 33.0, "rod_radius_mm": 4.0},
            "cube",
            "Far outside the trained ranges: "
            "depth (33 mm; trained: 1 to 21 mm; beyond by 60 % of the range), "
            "indenter radius (4 mm; trained: 2.5 mm; beyond by 60 % of the trained value). ",
            "The force may be wrong by a factor; the intervals are nearly as wide as without a prediction, ",
        ),
        (
            {"inclusion_height_mm": 15.0},
            "cube",
            "Outside the trained ranges: "
            "inclusion's height (15 mm; trained: 0 mm; beyond by 49 % of 30 mm). ",
            "The force may be wrong by a factor; the intervals are wider, ",
        ),
        (
            {"rod_radius_mm": 100.0},
            "cube",
            "ranges: indenter radius (100 mm; trained: 2.5 mm; beyond by 39 times the trained value). ",
            "The force may be wrong by a factor; the intervals are nearly as wide as without a prediction, ",
        ),
        (
            {},
            "sphere",
            "Outside the trained ranges: inclusion (sphere; trained: cube). ",
            "Errors may be larger than inside; the intervals are not wider, ",
        ),
    ],
)
def test_a_verdict_says_how_far_outside_a_poke_is(
    changes: dict[str, float], kind: str, places: str, follows: str
) -> None:
    plain = {"depth_mm": 5.0, "angle_deg": 44.9, "rod_radius_mm": 2.5, "inclusion_height_mm": 0.0}
    domain = Domain(
        ranges={
            "depth_mm": (1.0, 21.0), "angle_deg": (0.0, 44.8), "rod_radius_mm": (2.5, 2.5),
            "inclusion_height_mm": (0.0, 0.0),
        },
        kinds=("cube",), law="ogden",
    )  # fmt: skip
    assert verdict(domain.check(plain, "cube"), intervals=True) == "Inside the trained ranges."
    values = {**plain, **changes}
    checks = domain.check(values, kind)
    assert f"{places}{follows}and not calibrated there." in verdict(checks, intervals=True)
    assert "intervals" not in verdict(checks, intervals=False)
    assert distance_of(checks) == pytest.approx(domain.distance(values))
