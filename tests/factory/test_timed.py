"""Datasets with a clock: recipes with a course, cards with time, and what a store says of its frames."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import zarr

import factory
from factory._course import PHASES
from factory._input import InputError
from factory._parts import part_entry
from factory._schema import COURSE_SPECS, SPECS
from factory._store import write_manifest
from factory.plan import Plan
from tests.factory.conftest import ROOT, TINY, Builder, digest, environment

COURSE = """
  course:
    - {to_mm: 1, speed_mm_per_s: [1, 5]}
    - {hold_s: 10, frames: 4}
    - {to_mm: 0, speed_mm_per_s: 2}
    - {hold_s: 5, frames: 2}
"""
# what a real simulator solves in seconds
SMALL = f"""
name: small
description: one indentation of a small viscous block
seed: 3
block_mm: [60, 60, 20]
rod: {{radius_mm: 2.5, length_mm: 40}}
friction: 0.6
protocol:
  shared_sites: 0
  own_sites: 1
  margin_mm: 20
  max_angle_deg: 10
  depth_mm: 1
  frame_spacing_mm: 0.5{COURSE}
softness: [S1-viscous]
border_mm: 5
cover_mm: 6
refinement: 0.6
shapes:
  - {{kind: sphere, id: ball, radius_mm: 5}}
"""
PROTOCOL = """
protocol:
  shared_sites: 1
  own_sites: 1
  margin_mm: 20
  max_angle_deg: 45
  depth_mm: 30
  frame_spacing_mm: 10
  course:
    - {to_mm: 30, speed_mm_per_s: [1, 20]}
    - {hold_s: 8, frames: 3}
    - {to_mm: 10, speed_mm_per_s: 5}
    - {to_mm: 20, speed_mm_per_s: 5}
    - {to_mm: 0, speed_mm_per_s: 5}
    - {hold_s: 4, frames: 2}
"""
TIMED = re.sub(r"\nprotocol: .*\n", PROTOCOL, TINY)


def recipe(folder: Path, text: str = TIMED) -> factory.Recipe:
    path = folder / "recipe.yaml"
    path.write_text(text)
    return factory.load_recipe(path)


def card(folder: Path, text: str, name: str = "S1") -> Path:
    """The folder of a card that has these keys besides those of S1."""
    cards = folder / "cards"
    cards.mkdir(exist_ok=True)
    plain = (ROOT / "datasets" / "materials" / "S1.yaml").read_text()
    (cards / f"{name}.yaml").write_text(plain.replace("material: S1", f"material: {name}") + text + "\n")
    return cards


VISCOUS = "viscosity: {kind: prony, fractions: [0.2, 0.1], times_s: [1, 30], modulus: long-time}"
SOFTENING = "softening: {kind: ogden-roxburgh, r: 2, m_J_per_m3: 500, beta: 0.1}"
FIBRES = "fibres: {kind: holzapfel-gasser-ogden, direction: [1, 0, 0], k1_Pa: 5000, k2: 1}"


# cards


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
    found = factory.load_card("S1", cards)
    assert part_entry(found.viscosity) == {  # type: ignore[arg-type]
        "kind": "prony",
        "fractions": [0.2, 0.1],
        "times_s": [1.0, 30.0],
        "modulus": "long-time",
    }
    lines = [f"{n}: {part_entry(getattr(found, n))}" for n in ("viscosity", "softening", "fibres")]
    again = factory.load_card("S1", card(tmp_path, "\n".join(lines)))
    assert part_entry(again.viscosity) == part_entry(found.viscosity)  # type: ignore[arg-type]
    assert part_entry(again.softening) == part_entry(found.softening)  # type: ignore[arg-type]
    assert part_entry(again.fibres) == part_entry(found.fibres)  # type: ignore[arg-type]


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
        ("- {hold_s: 8, frames: 3}", "- 8", "course.1: expected the keys to_mm and speed_mm_per_s"),
    ],
)
def test_bad_courses_in_one_sentence(old: str, new: str, sentence: str, tmp_path: Path) -> None:
    assert old in TIMED
    with pytest.raises(InputError) as caught:
        recipe(tmp_path, TIMED.replace(old, new))
    assert sentence in str(caught.value)
    assert "protocol" in str(caught.value)


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
        factory.make_plan(recipe(tmp_path, TINY), "ogden"),
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
    """Names and sums of datasets from before depend on these keys alone."""
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


# stores


@pytest.fixture
def timed(tmp_path: Path) -> Plan:
    """Four pokes."""
    return factory.make_plan(recipe(tmp_path), "ogden")


def test_frames_carry_the_course(timed: Plan, standin_build: Builder, tmp_path: Path) -> None:
    data = factory.open_dataset(standin_build(timed, tmp_path / "a.zarr").store)
    assert set(COURSE_SPECS) | set(SPECS) == set(data.specs) == set(data.group.array_keys())
    for poke in timed.pokes:
        found, course = data.poke(poke.index), poke.scene.course
        assert course is not None
        assert found.time is not None
        assert found.rod_speed is not None
        np.testing.assert_array_equal(found.time, course.frames)
        # load 10 20 30, hold, down 20 10, up 20, down 10 0, rest
        words = ["load"] * 3 + ["hold"] * 3 + ["retract"] * 2 + ["reload"] + ["retract"] * 2 + ["rest"] * 2
        assert list(found.phase or ()) == words
        np.testing.assert_allclose(
            found.depth * 1e3, [10, 20, 30, 30, 30, 30, 20, 10, 20, 10, 0, 0, 0], atol=1e-9
        )
        ends = np.flatnonzero(np.isin(found.time, course.times))
        assert len(ends) == 6
        np.testing.assert_allclose(found.rod_speed[6:11] * 1e3, [-5, -5, 5, -5, -5])
        np.testing.assert_allclose(found.rod_speed[:3], 0.03 / course.times[0])
        assert (found.rod_speed[3:6] == 0).all()
        assert data.table["depth_asked"][poke.index] == pytest.approx(0.03)
    hold = np.diff(data.poke(0).time[2:6])  # type: ignore[index]
    np.testing.assert_allclose(hold, [2, 2, 4])
    assert factory.verify_dataset(tmp_path / "a.zarr").total == 0
    attributes = data.array("phase").attrs
    assert tuple(str(attributes["flag_meanings"]).split()) == PHASES


def test_an_interrupted_build_ends_in_the_same_bytes(
    timed: Plan, standin_build: Builder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = standin_build(timed, tmp_path / "a.zarr").store
    code = f"{round(timed.pokes[2].scene.site[0] * 1e6)}"
    monkeypatch.setenv("STANDIN_FAIL", code)
    assert standin_build(timed, tmp_path / "b.zarr").errors
    monkeypatch.delenv("STANDIN_FAIL")
    assert not standin_build(timed, tmp_path / "b.zarr").errors
    assert digest(whole) == digest(tmp_path / "b.zarr")


def _add(name: str, row: int, value: float) -> Callable[[Path], None]:
    def change(store: Path) -> None:
        array = zarr.open_group(store, mode="r+")[name]
        array[row] = array[row] + value  # type: ignore[index, operator]

    return change


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (_add("time", 4, -5.0), "not later than the frame before in 1 frames (first: frame 4)"),
        (_add("phase", 1, 1), "phase is not that of the rod's course in 1 frames (first: frame 1)"),
        (_add("depth", 4, 1e-4), "depth is not that of the rod's course in 1 frames (first: frame 4)"),
        (_add("rod_speed", 4, 1e-4), "rod_speed is not that of the rod's course"),
        (_add("dissipated_energy", 3, 1.0), "energy dissipated before has come back in 1 frames"),
    ],
)
def test_verify_finds_what_cannot_be(
    change: Callable[[Path], None], sentence: str, timed: Plan, standin_build: Builder, tmp_path: Path
) -> None:
    store = standin_build(timed, tmp_path / "a.zarr").store
    change(store)
    write_manifest(store)
    faults = factory.verify_dataset(store).faults["time, phase and energy"]
    assert any(fault.startswith("poke 0: ") and sentence in fault for fault in faults), faults


# commands, with the real simulator


def run(folder: Path, *words: object, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *map(str, words)],
        cwd=folder,
        env=environment(COLUMNS="300", **variables),
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One viscous indentation, built from another folder by the command."""
    folder = tmp_path_factory.mktemp("elsewhere")
    (folder / "small.yaml").write_text(SMALL)
    words = ("--model", "neo-hookean", "--recipe", "small.yaml", "--workers", "1")
    done = run(folder, "factory.build", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "datasets" / "small-neo-hookean.zarr"


def test_a_built_one_is_verified_and_inspected(real: Path) -> None:
    done = run(real.parent, "factory.verify", real.name)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 poke, 10 frames: no fault" in done.stdout
    done = run(real.parent, "factory.inspect", real.name, "--poke", "0", "--picture", "poke.png")
    assert done.returncode == 0, done.stdout + done.stderr
    for words in ("to 1 mm at", "10 s: 4 frames", "to 0 mm at 2 mm/s", "5 s: 2 frames", "energy dissipated"):
        assert words in done.stdout
    assert (real.parent / "poke.png").stat().st_size > 10_000
    done = run(real.parent, "factory.inspect", real.name, "--arrays")
    assert "dissipated_energy" in done.stdout


def test_force_relaxes_and_energy_is_lost(real: Path) -> None:
    data = factory.open_dataset(real)
    poke = data.poke(0)
    assert poke.status == "converged"
    assert poke.time is not None
    assert poke.phase is not None
    assert poke.dissipated_energy is not None
    assert (np.diff(poke.time) > 0).all()
    assert np.diff(poke.dissipated_energy, prepend=0.0).min() > 0
    force, phase = np.linalg.norm(poke.rod_force, axis=1), np.array(poke.phase)
    assert phase.tolist() == ["load"] * 2 + ["hold"] * 4 + ["retract"] * 2 + ["rest"] * 2
    held = force[1:6]  # the end of the load, and the hold
    assert (np.diff(held) < 0).all()
    # 5 % of the long-time modulus a decade, from 0.15 s or so to 10 s
    assert 0.05 < 1.0 - held[-1] / held[0] < 0.12
    assert force[phase == "rest"].max() < 1e-6  # the surface does not pull at the rod
    assert data.attributes["parts"][0]["viscosity"]["kind"] == "prony"


def test_the_dry_run_knows_the_course(tmp_path: Path) -> None:
    done = run(tmp_path, "factory.build", "--model", "ogden", "--recipe", "timed", "--dry-run")
    assert done.returncode == 0, done.stderr
    assert "to 6 mm at 1 to 20 mm/s, hold 10 s, to 0 mm at 5 mm/s, hold 5 s" in done.stdout
    assert "prony: fractions = 0.025" in done.stdout
    done = run(tmp_path, "factory.build", "--model", "ogden", "--recipe", "quick", "--levels", "S1-viscous")
    assert done.returncode == 2
    assert done.stderr.startswith("error: recipe quick: expected key protocol.course")


LOG_TIME = """
from dataclasses import dataclass
import numpy as np
from tisim import parts

@dataclass(frozen=True, kw_only=True)
class LogTime(parts.Viscosity):
    name = "log-time"
    title = "Log-time relaxation"
    part: float
    first: float = 0.1
    last: float = 10.0

    def check(self):
        if not 0.0 < self.first < self.last:
            raise ValueError(f"first: expected a time above 0 and below last, got {self.first!r}")

    def spectrum(self):
        times = 10.0 ** np.arange(np.log10(self.first), np.log10(self.last) + 0.25, 0.5)
        return parts.Spectrum(equilibrium=1.0, strengths=np.full(len(times), self.part / 2), times=times)

parts.register(LogTime)
"""


def test_a_part_from_outside_is_read_and_built_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "log_time.py").write_text(LOG_TIME)
    (tmp_path / "small.yaml").write_text(SMALL.replace("S1-viscous", "S1").replace("hold_s: 10", "hold_s: 2"))
    cards = card(tmp_path, "viscosity: {kind: log-time, part: 0.05, first_s: 0.1}")
    words = ("--recipe", "small.yaml", "--materials", cards, "--out", "own.zarr", "--workers", "1")
    with_part = {"TISIM_EXTENSIONS": str(tmp_path / "log_time.py")}
    done = run(tmp_path, "factory.build", "--model", "neo-hookean", *words, **with_part)
    assert done.returncode == 0, done.stdout + done.stderr
    data = factory.open_dataset(tmp_path / "own.zarr")
    assert data.attributes["identity"]["materials"]["S1"]["viscosity"] == {
        "kind": "log-time",
        "part": 0.05,
        "first": 0.1,
        "last": 10.0,
    }
    assert data.poke(0).dissipated_energy[-1] > 0  # type: ignore[index]
    card(tmp_path, "viscosity: {kind: log-time, part: 0.05, first_s: 20}")
    done = run(tmp_path, "factory.build", "--model", "neo-hookean", *words, **with_part)
    assert done.returncode == 2
    assert "key viscosity.first_s: expected a time above 0 and below last, got 20" in done.stderr
    done = run(tmp_path, "factory.build", "--model", "neo-hookean", *words)
    assert done.returncode == 2
    assert "key viscosity.kind: expected one of prony, got 'log-time'" in done.stderr
