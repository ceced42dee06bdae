"""Time before any build: recipes with a loading course, cards with parts beside the law."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import factory
from factory.errors import InputError
from factory.recipe.course import PHASES, states_at
from tests.factory.conftest import TINY
from tests.factory.timed_cases import FIBRES, SOFTENING, TIMED, VISCOUS, card, recipe
from tisim import parts
from tisim.parallel.extensions import digest_of_code


def test_a_card_s_parts_are_those_of_the_material_under_any_law(tmp_path: Path) -> None:
    cards = card(tmp_path, "\n".join((VISCOUS, SOFTENING, FIBRES)))
    for law in ("ogden", "eight-chain"):
        material = factory.material_of(factory.load_card("S1", cards), law)
        assert material.law == law
        assert material.viscosity is not None
        assert material.viscosity.spectrum().instantaneous == pytest.approx(1.3)
        assert (material.softening.r, material.softening.m) == (2, 500)  # type: ignore[union-attr]
        assert material.fibres.k1 == 5000  # type: ignore[union-attr]


def test_a_part_is_written_as_it_is_read(tmp_path: Path) -> None:
    cards = card(tmp_path, "\n".join((VISCOUS, SOFTENING, FIBRES)))
    found = parts.of(factory.load_card("S1", cards))
    lines = [f"{field}: {parts.encode(part)}" for field, part in found.items()]
    again = parts.of(factory.load_card("S1", card(tmp_path, "\n".join(lines))))
    assert list(again) == ["viscosity", "softening", "fibres"]
    assert again == found


def test_an_effect_that_changes_the_law_keeps_the_parts(tmp_path: Path) -> None:
    effect = """
effects:
  - effect: strain-stiffening
    belongs_to: specimen
    applies_to: material
    scope: all
    base_law: neo-hookean
    parameters: {c2_over_c1: {value: 0.3, sd: 0.1}}
    experiment_sha256: "%s"
""" % ("0" * 64)
    found = factory.material_of(factory.load_card("S1", card(tmp_path, VISCOUS + effect)))
    assert (found.law, found.viscosity is not None) == ("yeoh", True)
    plan = factory.make_plan(
        recipe(tmp_path, TIMED.replace("[S0, S1]", "[S1, V]")),
        "neo-hookean",
        card(tmp_path, VISCOUS, "V"),
    )
    assert [m.law for m in plan.materials] == ["yeoh", "yeoh"]
    assert all(m.viscosity is not None for m in plan.materials)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (VISCOUS.replace("30", "-30"), "viscosity.times_s: expected one or more relaxation times above 0 s"),
        (
            VISCOUS.replace("30", "1"),
            "viscosity.times_s: expected relaxation times of which no two are alike",
        ),
        (
            VISCOUS.replace("0.2", "0.95").replace("long-time", "instantaneous"),
            "viscosity.fractions: expected parts of the instantaneous modulus that sum to less than 1",
        ),
        (VISCOUS.replace("prony", "pronny"), "viscosity.kind: expected one of prony, got 'pronny'"),
        (VISCOUS.replace("times_s", "time_s"), "viscosity.times: this key is missing; key viscosity.time_s"),
        (VISCOUS.replace("times_s", "times_ms"), "viscosity.times_ms: unknown key"),
        (VISCOUS.replace("modulus", "times: [1, 2], modulus"), "times: states the same as times_s"),
        ("viscosity: 3", "viscosity: expected the key kind and the parameters of that kind, got 3"),
        (SOFTENING.replace("r: 2", "r: 0.5"), "softening.r: expected a number of 1 or more, got 0.5"),
        (SOFTENING.replace("500", "0"), "softening.m_J_per_m3: expected an energy above 0 J/m3, got 0"),
        (
            SOFTENING.replace("500", "many"),
            "softening.m_J_per_m3: expected an energy above 0 J/m3, got 'many'",
        ),
        (FIBRES.replace("1, 0, 0", "0, 0, 0"), "fibres.direction: expected a direction other than (0, 0, 0)"),
        (FIBRES.replace("fibres", "softening"), "softening.kind: expected one of ogden-roxburgh"),
    ],
)
def test_bad_parts_of_a_card_in_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    cards = card(tmp_path, text)
    with pytest.raises(InputError) as caught:
        factory.load_card("S1", cards)
    assert str(caught.value).startswith(f"{cards / 'S1.yaml'}: key ")
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


# recipes


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("to_mm: 30, speed_mm_per_s: [1, 20]", "to_mm: 30, speed_mm_per_s: -1", "course.0.speed_mm_per_s"),
        ("[1, 20]", "[20, 1]", "course.0.speed_mm_per_s: expected speeds that rise, got 20, 1"),
        ("{hold_s: 8,", "{hold_s: 0,", "course.1.hold_s"),
        ("{hold_s: 8,", "{hold: 8,", "course.1.hold: unknown key"),
        ("- {to_mm: 30, speed_mm_per_s: [1, 20]}\n", "- {hold_s: 2}\n", "course.0: expected a ramp"),
        ("{to_mm: 20, ", "{to_mm: 10, ", "course.3.to_mm: expected another depth than 10"),
        ("depth_mm: 30", "depth_mm: 25", "depth_mm: expected the course's largest depth of 30, got 25"),
        (
            "frame_spacing_mm: 10",
            "frame_spacing_mm: 1e-9",
            "frame_spacing_mm: expected at least 0.008, which",
        ),
        ("- {hold_s: 8, frames: 3}", "- 8", "course.1: expected the keys to_mm and speed_mm_per_s"),
    ],
)
def test_bad_courses_in_one_sentence(old: str, new: str, sentence: str, tmp_path: Path) -> None:
    assert old in TIMED
    with pytest.raises(InputError) as caught:
        recipe(tmp_path, TIMED.replace(old, new))
    assert sentence in str(caught.value)
    assert "protocol" in str(caught.value)


def test_frames_just_after_a_corner_are_of_the_piece_that_begins_there(tmp_path: Path) -> None:
    """The first frame of a hold, 1e-6 s after it begins, is in it however long another hold is."""
    long = TIMED.replace("{hold_s: 8, frames: 3}", "{hold_s: 8, frames: 24}").replace(
        "{hold_s: 4, frames: 2}", "{hold_s: 86400, frames: 2}"
    )
    assert long.count("86400") == 1
    for poke in factory.make_plan(recipe(tmp_path, long), "ogden").pokes:
        course = poke.scene.course
        assert course is not None
        assert course.frames is not None
        times, frames = np.array(course.times), np.array(course.frames)
        states = states_at(times, np.array(course.values), frames)
        held = (frames > times[0]) & (frames <= times[1])
        assert held.sum() == 24
        assert set(states["phase"][held]) == {PHASES.index("hold")}
        assert not states["rod_speed"][held].any()
        assert PHASES[states["phase"][np.flatnonzero(held)[0] - 1]] == "load"


def test_frames_that_a_course_cannot_tell_apart_are_refused_before_the_build(tmp_path: Path) -> None:
    many = recipe(tmp_path, TIMED.replace("{hold_s: 8, frames: 3}", "{hold_s: 8, frames: 50}"))
    with pytest.raises(InputError, match=r"poke 0: Poke\.course\.frames: expected times that rise") as caught:
        factory.make_plan(many, "ogden")
    assert len(str(caught.value)) < 250


def test_a_parts_own_code_is_part_of_the_identity(tmp_path: Path) -> None:
    @dataclass(frozen=True, kw_only=True)
    class Own(parts.Prony):
        name = "own"

    plain = factory.make_plan(recipe(tmp_path), "ogden", card(tmp_path, VISCOUS), levels=["S1"])
    parts.register(Own)
    try:
        folder = card(tmp_path, VISCOUS.replace("prony", "own"))
        own = factory.make_plan(recipe(tmp_path), "ogden", folder, levels=["S1"])
    finally:
        parts.unregister("own")
    assert "extensions" not in plain.identity
    assert own.identity["extensions"] == {"part own": digest_of_code(Own)}


def test_speeds_are_drawn_for_each_poke_and_common_to_the_levels(tmp_path: Path) -> None:
    plan = factory.make_plan(recipe(tmp_path), "ogden")
    speeds = [poke.scene.course.values[0] / poke.scene.course.times[0] for poke in plan.pokes]  # type: ignore[union-attr]
    assert all(1e-3 <= speed <= 20e-3 for speed in speeds)
    assert speeds[0] == speeds[2]  # the shared contact point
    assert len(set(speeds)) == 3
    again = factory.make_plan(recipe(tmp_path), "ogden")
    assert again.identity == plan.identity
    assert [p.scene.course for p in again.pokes] == [p.scene.course for p in plan.pokes]


def test_contact_points_are_those_of_the_recipe_without_a_course(tmp_path: Path) -> None:
    timed, plain = (
        factory.make_plan(recipe(tmp_path), "ogden"),
        factory.make_plan(
            recipe(tmp_path, TINY.replace("shared_sites: 0, own_sites: 2", "shared_sites: 1, own_sites: 1")),
            "ogden",
        ),
    )
    for one, two in zip(timed.pokes, plain.pokes, strict=True):
        assert (one.scene.site, one.scene.direction) == (two.scene.site, two.scene.direction)


def test_a_viscous_card_needs_a_course(tmp_path: Path) -> None:
    cards = card(tmp_path, VISCOUS)
    with pytest.raises(
        InputError, match=r"expected key protocol\.course, .* since .*S1\.yaml has key viscosity"
    ):
        factory.make_plan(recipe(tmp_path, TINY), "ogden", cards, levels=["S1"])
    assert (
        factory.make_plan(recipe(tmp_path), "ogden", cards, levels=["S1"]).materials[0].viscosity is not None
    )


def test_without_time_the_identity_is_what_it_was() -> None:
    """Names and checksums of earlier datasets depend on these keys alone."""
    plan = factory.make_plan(factory.load_recipe("quick"), "ogden")
    assert set(plan.identity["recipe"]["protocol"]) == {
        "shared_sites",
        "own_sites",
        "margin_mm",
        "max_angle_deg",
        "depth_mm",
        "frame_spacing_mm",
    }
    assert set(plan.identity["materials"]["S0"]) == {"law", "parameters", "density", "stiffness"}
