"""A program that is run on its export: the beam expected of it, its end, and the files that it leaves."""

from __future__ import annotations

import os
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from typer.testing import CliRunner

import calibration.export as export
import tisim
from calibration.export import Form, Job, Target, Written
from calibration.export.command import app
from calibration.export.targets import calculix

ROOT = Path(__file__).resolve().parents[2]
CARDS = ROOT / "datasets" / "materials"
CLEAN = ROOT / "datasets" / "measured" / "bench" / "clean"
CHAINS = {"mu": 12e3, "locking": 1.02, "bulk": 5e5}  # stiffens early: an Ogden term does not follow it
SHORT = ["--experiment", str(CLEAN), "--trial", "S0-cantilever-050", "--refinement", "0.4"]


def card(folder: Path, **changes: object) -> Path:
    """The paper's S0 with other keys."""
    content = yaml.safe_load((CARDS / "S0.yaml").read_text(encoding="utf-8")) | changes
    path = folder / "S0.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    return path


def ends(words: list[str], code: int) -> tuple[str, str]:
    """Output of the command on one line, and the sentence on stderr."""
    done = CliRunner().invoke(app, words)
    assert done.exit_code == code, done.output
    return " ".join(done.stdout.split()), " ".join(done.stderr.split())


@pytest.fixture
def exact_program() -> Iterator[Callable[[str], str]]:
    """A program with Ogden bodies of one term on quadratic elements, which solves its beam as tisim does."""
    jobs: list[Job] = []

    def write(job: Job, folder: Path) -> Written:
        jobs.append(job)
        path = folder / "beam.txt"
        path.write_text("the beam")
        return Written(files={path: "the beam"})

    def solve(folder: Path) -> NDArray[np.float64]:  # noqa: ARG001 - the scene is that of the job
        scene, form = jobs[-1].scene, jobs[-1].form
        assert scene is not None
        parameters = {"mu": form.mu, "alpha": form.alpha, "bulk": form.bulk}
        soft = replace(scene.beam.material, law="ogden", parameters=parameters)
        (result,) = tisim.simulate([replace(scene.beam, material=soft, mesh=scene.mesh)], workers=1)
        return np.asarray(result.positions[-1] - scene.mesh.nodes)

    def made(volume: str) -> str:
        def writes(form: Form, material: tisim.Material) -> Form | None:  # noqa: ARG001
            one = form.kind == "ogden" and len(form.mu) == 1
            return replace(form, volume=volume) if one else None  # type: ignore[arg-type]

        return export.register(
            Target(
                name="exact", title="Exact 1", writes=writes, keeps=lambda *_: set(), write=write, check=solve
            )
        ).name

    yield made
    export.unregister("exact")


def test_the_expected_beam_is_that_of_the_law_which_the_program_was_given(
    exact_program: Callable[[str], str], tmp_path: Path
) -> None:
    """The card's eight chains move 3 % less than the Ogden law that stands for them; the program is right."""
    name = exact_program("linear")
    chains = card(tmp_path, law="eight-chain", laws={"eight-chain": CHAINS})
    words = [str(chains), "--to", name, *SHORT]
    out, _ = ends([*words, "--out", str(tmp_path / "out"), "--check"], 0)
    assert "as stated (at most 0.5 %)" in out
    assert "by tisim with the Ogden that stands for the card's eight-chain, on the same mesh" in out
    done = export.export_card(
        chains, to=name, out=tmp_path / "again", experiment=CLEAN, trial="S0-cantilever-050",
        refinement=0.4, check=True,
    )  # fmt: skip
    assert done.checked is not None
    assert done.checked.from_expected < 1e-6
    assert done.checked.from_reference > 0.01  # beyond the limit, which the card's own beam would not keep
    assert done.job.prediction is not None
    assert done.job.prediction.error == pytest.approx(done.checked.from_reference)


def test_a_beam_that_was_not_expected_is_not_beyond(
    monkeypatch: pytest.MonkeyPatch, exact_program: Callable[[str], str], tmp_path: Path
) -> None:
    """Where tisim finds no equilibrium with the program's law, nothing is compared: exit code 1."""
    from calibration.export import _export

    found = _export.predict

    def none(*arguments: object, **named: object) -> export.Prediction:
        return replace(found(*arguments, **named), expected=None)  # type: ignore[arg-type]

    monkeypatch.setattr(_export, "predict", none)
    words = [str(CARDS / "S0.yaml"), "--to", exact_program("log"), "--law", "ogden", *SHORT]
    out, _ = ends([*words, "--out", str(tmp_path / "out"), "--check"], 1)
    assert "BEYOND" not in out
    assert "not compared with an expected one, which tisim did not find, but is" in out


def stand_in(folder: Path, script: str) -> str:
    """A PATH on which `ccx` is a script."""
    folder.mkdir()
    program = folder / "ccx"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    return f"{folder}{os.pathsep}{os.environ['PATH']}"


def test_a_program_that_does_not_end_is_stopped_with_a_sentence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", stand_in(tmp_path / "bin", "echo increment 1; exec sleep 60"))
    monkeypatch.setattr(calculix, "SECONDS", 1.0)
    out = tmp_path / "out"
    words = [str(CARDS / "S0.yaml"), "--to", "calculix", "--out", str(out), *SHORT, "--check"]
    _, sentence = ends(words, 2)
    log = out / "ccx.log"
    assert sentence == f"error: --check: ccx did not solve the beam within 1 s and was stopped: see {log}"
    assert log.read_text() == "increment 1\n"


def test_a_new_export_leaves_no_file_of_an_earlier_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Another program's files, the beam that is not asked for again, and results of its run; others stay."""
    results = " ".join(shlex.quote(x) for x in calculix.TARGET.results if x != "ccx.log")
    monkeypatch.setenv("PATH", stand_in(tmp_path / "bin", f"touch {results}; exit 1"))
    out, mine = tmp_path / "out", tmp_path / "out" / "mine.txt"
    first = [str(CARDS / "S0.yaml"), "--out", str(out)]
    ends([*first, "--to", "calculix", *SHORT, "--check"], 2)
    mine.write_text("mine")
    names = {"README.md", "material.inp", "beam.inp", "mine.txt", *calculix.TARGET.results}
    assert {p.name for p in out.iterdir()} == names
    ends([*first, "--to", "calculix", "--no-scene", "--overwrite"], 0)
    assert {p.name for p in out.iterdir()} == {"README.md", "material.inp", "mine.txt"}
    ends([*first, "--to", "febio", "--no-scene", "--overwrite"], 0)
    assert {p.name for p in out.iterdir()} == {"README.md", "material.feb", "mine.txt"}
    (out / "README.md").write_text("- `mine.txt`: a page of my own\n")
    ends([*first, "--to", "sofa", "--no-scene", "--overwrite"], 0)
    assert {p.name for p in out.iterdir()} == {"README.md", "material.feb", "material.json", "mine.txt"}


@pytest.mark.parametrize(("r", "kept"), [(1.0, False), (1.0 + 1e-12, False), (1.5, True)])
def test_abaqus_takes_softening_by_r_above_one(r: float, kept: bool, tmp_path: Path) -> None:
    """tisim also has r = 1, with which unloaded tissue has no stress at all; as it would be written."""
    softening = {"kind": "ogden-roxburgh", "r": r, "m_J_per_m3": 500.0}
    words = [str(card(tmp_path, softening=softening)), "--to", "abaqus", "--no-scene"]
    out, _ = ends([*words, "--out", str(tmp_path / "a")], 0)
    deck = (tmp_path / "a" / "material.inp").read_text()
    assert ("*MULLINS EFFECT\n1.5, 500, 0" in deck) == kept
    assert ("*MULLINS" in deck) == kept
    assert ("Ogden-Roxburgh softening is left out" in out) != kept
    assert ("Abaqus takes an r of Ogden-Roxburgh softening above 1 only" in out) != kept
