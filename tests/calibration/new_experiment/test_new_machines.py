"""Records of one known curve, as machines name and arrange them: what is read is that curve, or it is asked.

A neo-Hookean strip of 50 mm x 20 mm2 and mu = 25 kPa is pulled to a stretch of 1.5 (26.389 kPa), a cylinder
of it is pressed to 0.7, and a block is poked to 3 mm with 0.2 N/mm.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from calibration.experiment import CouponTrial, PokeTrial, read
from calibration.new import app

MU = 25e3
TIME = np.linspace(0.0, 30.0, 31)
PULLED, PRESSED = 1.0 + TIME / 60.0, 1.0 - TIME / 100.0
BLOCK: dict[str, Any] = {"kind": "poke", "block_mm": [60, 60, 20], "rod": {"radius_mm": 3, "tip": "flat"}}
DEPTH = TIME / 10.0


def stress(stretch: np.ndarray) -> np.ndarray:
    return MU * (stretch - stretch**-2)


def table(head: str, *columns: np.ndarray, separator: str = ",", form: str = ".5f") -> str:
    rows = [separator.join(f"{v:{form}}" for v in row) for row in zip(*columns, strict=True)]
    return "\n".join([head, *rows]) + "\n"


def made(folder: Path, text: str, **keys: Any) -> tuple[Any, str]:
    """The trial that `calibration.new` makes of a file; None and its sentence if it is refused."""
    folder.mkdir(exist_ok=True)
    (folder / "record.csv").write_text(text, encoding="utf-8")
    kind = {"kind": "coupon", "mode": "uniaxial"} if "kind" not in keys else {}
    trial = {"id": "t", "material": "m", "file": "record.csv", **kind, **keys}
    answers = folder / "answers.yaml"
    answers.write_text(yaml.safe_dump({"name": "x", "trials": [trial]}), encoding="utf-8")
    done = CliRunner().invoke(app, ["--yes", str(answers), "--out", str(folder / "out")])
    if done.exit_code:
        assert done.exit_code == 2, done.exception
        return None, done.stderr
    return read(folder / "out").trials[0], done.stdout


def pulled(trial: Any) -> None:
    assert isinstance(trial, CouponTrial)
    assert trial.stretch[[0, -1]] == pytest.approx([1.0, 1.5], abs=1e-5)
    assert trial.stress[[0, -1]] == pytest.approx([0.0, stress(PULLED)[-1]], abs=2.0)


STRIP: dict[str, Any] = {"rest_length_mm": 50, "area_mm2": 20, "displacement_positive": "tension"}


@pytest.mark.parametrize(
    ("head", "keys"),
    [
        ("Time s,Dehnung mm/mm,Spannung N/mm²", {}),
        ("Time/s,Elongation in/in,Stress/N/mm²", {}),
        ("Crosshead mm,Strain mm/mm,Stress N/mm2", {"displacement_positive": "tension"}),
    ],
)
def test_units_with_a_slash(head: str, keys: dict[str, Any], tmp_path: Path) -> None:
    first = TIME if "Time" in head else (PULLED - 1) * 60  # the crosshead slips
    text = table(head, first, PULLED - 1, stress(PULLED) / 1e6, form=".8f")
    pulled(made(tmp_path, text, **keys)[0])


@pytest.mark.parametrize(
    "line", ["Extension rate;5;mm/min", "Pretension;0.1;N", "Comment;sample of intensity 3"]
)
def test_a_compression_test_is_no_tension_for_a_word(line: str, tmp_path: Path) -> None:
    """Strain and stress that are positive when pressed, in a test whose header says compression."""
    rows = table(
        "Time;Strain;Stress\n(s);(%);(kPa)", TIME, 100 * (1 - PRESSED), -stress(PRESSED) / 1e3, separator=";"
    )
    text = f"Instron Bluehill\nTest method;Compression of cylinder\n{line}\n\n{rows}"
    trial, said = made(tmp_path / "a", text)
    assert trial is None
    assert "missing key t.displacement_positive" in said
    trial, _ = made(tmp_path / "b", text, displacement_positive="compression")
    assert trial.stretch[-1] == pytest.approx(0.7)
    assert trial.stress[-1] == pytest.approx(stress(PRESSED)[-1], rel=1e-4)


def test_dimensions_of_the_machine_are_not_the_specimens(tmp_path: Path) -> None:
    lines = "Overall length;150;mm\nGauge length;50;mm\nJaw width;25;mm\nWidth;10;mm\nThickness;2;mm\n"
    rows = table(
        "Time;Extension;Load\n(s);(mm);(N)",
        TIME,
        (PULLED - 1) * 50,
        stress(PULLED) * 20e-6,
        separator=";",
        form=".8f",
    )
    text = f"Instron Bluehill\n{lines}\n{rows}"
    pulled(made(tmp_path / "a", text)[0])
    twice = text.replace("Width;10;mm", "Width;10;mm\nWidth at the waist;8;mm")
    trial, said = made(tmp_path / "b", twice)
    assert trial is None
    assert "missing key t.area_mm2" in said


@pytest.mark.parametrize(
    ("head", "force"),
    [
        ("Time (s),Depth (mm),Indentation force (N)", None),
        ("Time (s),Compression (mm),Compression load (N)", None),
        ("Time (s),Depth (mm),Indentation force (N),Fx (N)", "Indentation force"),
        ("Time (s),Depth (mm),Calibrated load (N),Load (N)", "Calibrated load"),
    ],
)
def test_forces_by_their_full_name(head: str, force: str | None, tmp_path: Path) -> None:
    columns: Sequence[np.ndarray] = [TIME, DEPTH, 0.2 * DEPTH, 0.01 * DEPTH][: head.count(",") + 1]
    trial, said = made(tmp_path / "a", table(head, *columns), **BLOCK)
    if force is not None:
        assert trial is None
        assert "missing key t.columns.force: expected which column holds the force" in said
        trial, said = made(tmp_path / "b", table(head, *columns), **BLOCK, columns={"force": force})
    assert isinstance(trial, PokeTrial), said
    assert trial.record.force[-1] == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("force_zero_N", 0.1, "expected only where the stress comes from a force"),
        ("displacement_zero_mm", 2.5, "expected only where the stretch comes from a displacement"),
    ],
)
def test_a_zero_that_would_not_be_used_is_refused(
    key: str, value: float, sentence: str, tmp_path: Path
) -> None:
    text = table(
        "Strain (%),Stress (kPa),Force (N)", 100 * (PULLED - 1), stress(PULLED) / 1e3, stress(PULLED) * 2e-5
    )
    trial, said = made(tmp_path, text, displacement_positive="tension", **{key: value})
    assert trial is None
    assert f"{key}: {sentence}" in said


def test_a_column_is_named_with_its_unit(tmp_path: Path) -> None:
    text = table(
        "Strain (%),Strain (mm/mm),Stress (kPa)",
        120 * (PULLED - 1),
        PULLED - 1,
        stress(PULLED) / 1e3,
        form=".8f",
    )
    trial, said = made(tmp_path / "a", text)
    assert trial is None
    assert "expected which column holds the strain: Strain (%) | Strain (mm/mm)" in said
    pulled(made(tmp_path / "b", text, columns={"strain": "Strain (mm/mm)"})[0])
    din = table(
        "Zeit / s;Weg / mm;Kraft / N",
        TIME,
        (PULLED - 1) * 50,
        stress(PULLED) * 20e-6,
        separator=";",
        form=".8f",
    )
    for keys in ({"columns": {"force": "Kraft"}}, {"units": {"Kraft": "N"}}):
        pulled(made(tmp_path / next(iter(keys)), din, **STRIP, **keys)[0])


def test_a_clock_that_has_run_for_days(tmp_path: Path) -> None:
    ticks = 1_234_567_000.0 + np.arange(31.0)
    text = table("Time (ms),Strain (mm/mm),Stress (kPa)", ticks, PULLED - 1, stress(PULLED) / 1e3, form=".6f")
    trial, said = made(tmp_path, text, accept=["duration"])
    assert trial is not None, said
    assert np.diff(trial.time) == pytest.approx(1e-3, abs=1e-5)
