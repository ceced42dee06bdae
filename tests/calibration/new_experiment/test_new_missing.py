"""`calibration.new --yes`: all keys that the answers lack in one sentence, none that may not be needed."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
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


def refused(folder: Path, *trials: dict[str, Any], whole: bool = False) -> str:
    """What the command says of answers with these trials, which it refuses; whole: with the file's path."""
    (folder / "plain.csv").write_text(TABLE, encoding="utf-8")
    shutil.copyfile(OUTLINE, folder / "outline.csv")
    path = folder / "answers.yaml"
    path.write_text(yaml.safe_dump({"name": "x", "trials": list(trials)}), encoding="utf-8")
    done = CliRunner().invoke(app, ["--yes", str(path), "--out", str(folder / "lab")])
    assert done.exit_code == 2, (done.output, done.exception)
    assert not (folder / "lab").exists()
    (sentence,) = done.stderr.strip().splitlines()
    if whole:
        return sentence
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


def test_a_stretch_that_depends_on_missing_answers_is_refused_after_them(tmp_path: Path) -> None:
    """By the length that stands in, 1 mm, the specimen would be squeezed through itself."""
    by = {"columns": {"displacement": "displacement", "force": "load"}}
    own = {
        **COUPON,
        **by,
        "units": {"displacement": "mm", "load": "N"},
        "displacement_positive": "compression",
    }
    assert refused(tmp_path, {"id": "a", **own, "mode": "uniaxial"}) == (
        f"missing keys a.rest_length_mm ({LENGTH}), a.area_mm2 ({AREA})"
    )


TRUE = "stretch,true stress (kPa)\n0,0\n0.5,1\n1,2\n"


@pytest.mark.parametrize(
    ("table", "keys", "said"),
    [
        # the stretch of a row divides its true stress
        (TRUE, {}, "answers.yaml: missing key a.units.stretch: expected the unit"),
        (
            TRUE,
            {"units": {"stretch": "1"}},
            "plain.csv: line 2: column stretch: expected a stretch above 0, got 0;",
        ),
        (
            TRUE.replace("true ", ""),
            {"units": {"stretch": "1"}, "accept": ["strain"]},
            "plain.csv: line 2: column stretch: expected a stretch above 0, got 0;",
        ),
        # percents that were taken for shares
        (
            "true strain,true stress (kPa)\n0,0\n500,1\n1000,2\n",
            {"units": {"true strain": "1"}},
            "plain.csv: line 3: column true strain: expected at most 10, got 500; is the strain in %?",
        ),
        # rows that were left out are counted
        (
            "time,stretch,stress (kPa)\n0,1,0\n2,1.1,1\n"
            + "".join(f"{k / 2 + 1},1.{k},{k}\n" for k in range(1, 30))
            + "20,0,9\n",
            {"units": {"time": "s", "stretch": "1"}, "leave_out_rows": True},
            "plain.csv: line 33: column stretch: expected a stretch above 0, got 0;",
        ),
    ],
)
def test_an_impossible_stretch_is_one_sentence(
    table: str, keys: dict[str, Any], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{__name__}.TABLE", table)
    with np.errstate(all="raise"):  # what NumPy warns of, it would print before the sentence
        assert said in refused(tmp_path, {"id": "a", **COUPON, "mode": "uniaxial", **keys}, whole=True)


POKE = {"id": "a", "kind": "poke", "material": "gel"}


@pytest.mark.parametrize(
    ("trials", "said"),
    [
        # a key that the schema asks for stands in one sentence with those that are asked for
        (
            [{"id": "a", "kind": "coupon", "material": "gel"}],
            f"missing keys a.file (expected the file with the machine's record), a.mode ({MODE})",
        ),
        (
            [{**POKE, "rod": {"tip": "flat"}, "surfaces": [{"time_s": 1.0}]}],
            "missing keys a.file (expected the file with the machine's record), a.rod.radius_mm (expected a"
            " value), a.surfaces[#1].points (expected the file with the scan), a.block_mm (expected sides of"
            " the block along x, y, z [mm]), a.surfaces[#1].point_sd_mm (expected standard deviation of a"
            " scanned point [mm])",
        ),
        (
            [{"kind": "coupon", "file": "plain.csv", "material": "gel", "columns": {"strain": "strain 2"}}],
            f"missing keys trials[#1].id (expected name of the trial), trials[#1].mode ({MODE}),"
            " trials[#1].units.load (expected the unit of the column load (N), the file states none),"
            f" trials[#1].area_mm2 ({AREA})",
        ),
        # of a trial without a kind nothing else is known
        (
            [{"id": "a"}, {"id": "b", "kind": "beam", "material": "gel", "captures": [{"time_s": 1.0}]}],
            "missing keys a.kind (expected beam, poke or coupon), b.captures[#1].outline (expected an"
            " outline or a photo), b.section (expected section of the beam: circle or rectangle),"
            " b.free_length_mm (expected free length of the beam, outside the clamps [mm]), b.grip_length_mm"
            " (expected length held inside a clamp [mm]), b.supports"
            " (expected supports of the beam: clamped-free or clamped-clamped),"
            " materials.gel.density_kg_m3 (expected density of the material [kg/m3])",
        ),
        # a key that is misspelt explains the one that is missing
        (
            [{"id": "a", "kind": "coupon", "flie": "plain.csv"}, {"id": "b", "kind": "coupon"}],
            "unknown key trials[a].flie: expected file; also missing: trials[b].file",
        ),
        # an error beside them may be of what stands in, and waits
        (
            [{**COUPON, "id": "a"}, {"kind": "coupon", "area_mm2": 1.0, "width_mm": 1.0}],
            "missing keys trials[#2].id (expected name of the trial), trials[#2].file (expected the file with"
            " the machine's record)",
        ),
    ],
)
def test_keys_that_the_schema_asks_for_are_named_with_the_others(
    trials: list[dict[str, Any]], said: str, tmp_path: Path
) -> None:
    assert refused(tmp_path, *trials) == said


def test_a_beam_without_anything_seen_lacks_captures(tmp_path: Path) -> None:
    said = refused(tmp_path, {"id": "a", "kind": "beam", "material": "gel", "free_length_mm": 100.0})
    assert said.startswith("missing keys a.captures (expected captures or markers), a.section (")
    assert "time_s" not in said
