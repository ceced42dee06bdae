"""A program that is run on its export: the beam expected of it, its end, and the files that it leaves."""

from __future__ import annotations

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
