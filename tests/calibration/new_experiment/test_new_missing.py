"""`calibration.new --yes`: all keys that the answers lack in one sentence, none that may not be needed."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from typer.testing import CliRunner

from calibration.new import app

TABLE = "displacement,strain 1 %,strain 2 %,load\n0,0,0,0\n1,5,6,4\n2,10,11,7\n"
COUPON = {"kind": "coupon", "material": "gel", "file": "plain.csv"}
OUTLINE = (
    Path(__file__).resolve().parents[3] / "datasets/measured/bench/clean/beams/S0.5-cantilever-100-t100.csv"
)
MODE = "expected the mode of the test: uniaxial, equibiaxial, planar, simple-shear"
WHICH = "expected tension or compression: what positive values of the column displacement mean"
LENGTH = "expected length at rest that is stretched: between the grips, or a cylinder's height [mm]"
AREA = (
    "expected the area of the specimen's section at rest [mm2] (or diameter_mm, or width_mm and thickness_mm)"
)


def refused(folder: Path, *trials: dict[str, Any]) -> str:
    """What the command says of answers with these trials, which it refuses."""
    (folder / "plain.csv").write_text(TABLE, encoding="utf-8")
    shutil.copyfile(OUTLINE, folder / "outline.csv")
    path = folder / "answers.yaml"
    path.write_text(yaml.safe_dump({"name": "x", "trials": list(trials)}), encoding="utf-8")
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(folder / "lab")])
    assert done.exit_code == 2, (done.output, done.exception)
    assert not (folder / "lab").exists()
    (sentence,) = done.stderr.strip().splitlines()
    assert sentence.startswith(f"error: {path}: ")
    return sentence.removeprefix(f"error: {path}: ")


def test_all_missing_keys_of_all_trials_are_named(tmp_path: Path) -> None:
    by = {"columns": {"displacement": "displacement", "force": "load"}}
    own = {**COUPON, **by, "units": {"displacement": "mm", "load": "N"}}
    assert refused(tmp_path, {"id": "a", **own}, {"id": "b", **own, "mode": "uniaxial"}) == (
        f"missing keys a.mode ({MODE}), a.displacement_positive, b.displacement_positive ({WHICH}),"
        f" a.rest_length_mm, b.rest_length_mm ({LENGTH}), a.area_mm2, b.area_mm2 ({AREA})"
    )


def test_one_key_that_several_trials_lack(tmp_path: Path) -> None:
    own = {
        **COUPON,
        "columns": {"strain": "strain 2", "force": "load"},
        "units": {"load": "N"},
        "area_mm2": 50.0,
    }
    said = refused(tmp_path, {"id": "a", **own}, {"id": "b", **own})
    assert said == f"missing keys a.mode, b.mode: {MODE}"


@pytest.mark.parametrize(
    ("trial", "said"),
    [
        # the unit of a column is asked for once it is known which
        (
            {**COUPON, "columns": {"force": "load"}, "area_mm2": 50.0},
            [f"missing keys a.mode ({MODE})", "a.columns.strain (", "a.units.load ("],
        ),
        # and the sides of a section, and the density of a material
        (
            {"kind": "beam", "captures": [{"outline": "outline.csv"}], "grip_length_mm": 20.0},
            [
                "missing keys a.material (expected name of the material)",
                "a.section (expected section of the beam: circle or rectangle)",
                "a.free_length_mm (",
                "a.supports (",
                "a.captures[#1].time_s (",
            ],
        ),
        # of a material that is known, the density is
        (
            {
                "kind": "beam",
                "material": "gel",
                "section": {"circle": {"radius_mm": 10.0}},
                "free_length_mm": 100.0,
                "supports": "clamped-free",
                "captures": [{"outline": "outline.csv", "time_s": 1.0}],
            },
            ["missing keys a.grip_length_mm (", "materials.gel.density_kg_m3 ("],
        ),
    ],
)
def test_what_hangs_on_a_missing_answer_is_not_asked(
    trial: dict[str, Any], said: list[str], tmp_path: Path
) -> None:
    sentence = refused(tmp_path, {"id": "a", **trial})
    assert all(part in sentence for part in said), sentence
    assert sentence.count("(expected ") == len(said), sentence


def test_an_error_elsewhere_waits_for_the_missing_keys(tmp_path: Path) -> None:
    """What stands in for a missing answer may itself be the error, so that only the key is named."""
    own = {"id": "a", **COUPON, "columns": {"strain": "strain 1", "force": "load"}, "area_mm2": 50.0}
    gone = {"id": "b", **COUPON, "file": "gone.csv", "mode": "uniaxial"}
    assert refused(tmp_path, own, gone).startswith("missing keys a.mode (")
