"""Stores with time: arrays of the frames, and the commands with the real simulator."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import zarr

import factory
from factory.build import app as build_app
from factory.inspect import app as inspect_app
from factory.plan import Plan
from factory.recipe.course import PHASES
from factory.store.files import write_manifest
from factory.store.schema import COURSE_SPECS, SPECS
from factory.verify import app as verify_app
from tests.factory.conftest import Builder, build_here, digest, environment, run_app
from tests.factory.timed_cases import SMALL, card, recipe


@pytest.fixture(scope="module")
def timed(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    """Four pokes."""
    return factory.make_plan(recipe(tmp_path_factory.mktemp("timed")), "ogden")


@pytest.fixture(scope="module")
def timed_store(timed: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store, built once; tests that change it use a copy."""
    folder = tmp_path_factory.mktemp("timed-store")
    build_here(timed, folder / "a.zarr")
    return folder / "a.zarr"


def test_frames_carry_the_course(timed: Plan, timed_store: Path) -> None:
    data = factory.open_dataset(timed_store)
    assert set(COURSE_SPECS) | set(SPECS) == set(data.specs) == set(data.group.array_keys())
    for poke in timed.pokes:
        found, course = data.poke(poke.index), poke.scene.course
        assert course is not None
        assert found.time is not None
        assert found.rod_speed is not None
        np.testing.assert_array_equal(found.time, course.frames)
        # load to 10, 20, 30 mm; hold; retract to 20, 10; reload to 20; retract to 10, 0; rest
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
    assert factory.verify_dataset(timed_store).total == 0
    attributes = data.array("phase").attrs
    assert tuple(str(attributes["flag_meanings"]).split()) == PHASES


def test_an_interrupted_build_ends_in_the_same_bytes(
    timed: Plan,
    timed_store: Path,
    standin_build: Builder,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    code = f"{round(timed.pokes[2].scene.site[0] * 1e6)}"
    monkeypatch.setenv("STANDIN_FAIL", code)
    assert standin_build(timed, tmp_path / "b.zarr").errors
    monkeypatch.delenv("STANDIN_FAIL")
    assert not standin_build(timed, tmp_path / "b.zarr").errors
    assert digest(timed_store) == digest(tmp_path / "b.zarr")


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
    change: Callable[[Path], None], sentence: str, timed_store: Path, tmp_path: Path
) -> None:
    store = Path(shutil.copytree(timed_store, tmp_path / "a.zarr"))
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
    """A store of one viscous indentation, built by the command in another working folder."""
    folder = tmp_path_factory.mktemp("elsewhere")
    (folder / "small.yaml").write_text(SMALL)
    words = ("--model", "neo-hookean", "--recipe", "small.yaml", "--workers", "1")
    done = run(folder, "factory.build", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "datasets" / "small-neo-hookean.zarr"


def test_a_built_one_is_verified_and_inspected(real: Path) -> None:
    done = run_app(verify_app, real)
    assert done.exit_code == 0, done.output
    assert "1 poke, 10 frames: no fault" in done.stdout
    done = run_app(inspect_app, real, "--poke", "0", "--picture", real.parent / "poke.png")
    assert done.exit_code == 0, done.output
    for words in ("to 1 mm at", "10 s: 4 frames", "to 0 mm at 2 mm/s", "5 s: 2 frames", "energy dissipated"):
        assert words in done.stdout
    assert (real.parent / "poke.png").stat().st_size > 10_000
    done = run_app(inspect_app, real, "--arrays")
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
    held = force[1:6]  # end of loading, then the hold
    assert (np.diff(held) < 0).all()
    # 5 % of the long-time modulus per decade, from about 0.15 s to 10 s
    assert 0.05 < 1.0 - held[-1] / held[0] < 0.12
    assert force[phase == "rest"].max() < 1e-6  # no adhesion to the indenter
    assert data.attributes["parts"][0]["viscosity"]["kind"] == "prony"


def test_the_dry_run_knows_the_course() -> None:
    done = run_app(build_app, "--model", "ogden", "--recipe", "timed", "--dry-run")
    assert done.exit_code == 0, done.stderr
    assert "to 6 mm at 1 to 20 mm/s, hold 10 s, to 0 mm at 5 mm/s, hold 5 s" in done.stdout
    assert "prony: fractions = 0.025" in done.stdout
    done = run_app(build_app, "--model", "ogden", "--recipe", "quick", "--levels", "S1-viscous")
    assert done.exit_code == 2
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


def test_a_part_from_outside_is_read_and_built_by_its_name(
    command: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    """The stand-in's workers must load the part; `tests/tisim` solves scenes with such a part."""
    (tmp_path / "log_time.py").write_text(LOG_TIME)
    (tmp_path / "small.yaml").write_text(SMALL.replace("S1-viscous", "S1").replace("hold_s: 10", "hold_s: 2"))
    cards = card(tmp_path, "viscosity: {kind: log-time, part: 0.05, first_s: 0.1}")
    small, own = tmp_path / "small.yaml", tmp_path / "own.zarr"
    words = (
        "--model",
        "neo-hookean",
        "--recipe",
        small,
        "--materials",
        cards,
        "--out",
        own,
        "--workers",
        "1",
    )
    with_part = {"TISIM_EXTENSIONS": str(tmp_path / "log_time.py")}
    build = command(*map(str, words), **with_part)
    _, errors = build.communicate(timeout=600)
    assert build.returncode == 0, errors
    data = factory.open_dataset(own)
    assert data.attributes["identity"]["materials"]["S1"]["viscosity"] == {
        "kind": "log-time",
        "part": 0.05,
        "first": 0.1,
        "last": 10.0,
    }
    assert data.poke(0).dissipated_energy[-1] > 0  # type: ignore[index]
    card(tmp_path, "viscosity: {kind: log-time, part: 0.05, first_s: 20}")
    done = run(tmp_path, "factory.build", *words, **with_part)
    assert done.returncode == 2
    assert "key viscosity.first_s: expected a time above 0 and below last, got 20" in done.stderr
    plain = run_app(build_app, *words)
    assert plain.exit_code == 2
    assert "key viscosity.kind: expected one of prony, got 'log-time'" in plain.stderr
