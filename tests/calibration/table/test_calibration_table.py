"""The table of calibration results, from a prepared experiment and prepared fits."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from table_cases import displaced, fit_file, on_a_faulty_rig, rig_file
from typer.testing import CliRunner

import tisim
from calibration.diagnosis.rig import read_rig
from calibration.errors import InputError
from calibration.experiment import read
from calibration.study.paper_table import printed
from calibration.table import app

RUNNER = CliRunner()
SHIFTS = {"S0": (0.5,), "S1": (1.0, 2.0)}


def parameters(law):
    found = tisim.laws.get(law).from_moduli(20e3, 6e6)
    return {k: list(v) if isinstance(v, tuple) else v for k, v in found.items()}


@pytest.fixture
def experiment(tmp_path):
    return displaced(tmp_path / "bench", SHIFTS)


@pytest.fixture
def fits(tmp_path, experiment):
    return prepared(tmp_path / "made" / "fits", experiment)


def prepared(folder, experiment):
    """Neo-Hookean fits of both mixtures, a failed Ogden fit of one, and no other laws."""
    digest = read(experiment).digest
    for material in SHIFTS:
        fit_file(folder, digest=digest, material=material, law="neo-hookean",
                 parameters=parameters("neo-hookean"))  # fmt: skip
    fit_file(folder, digest=digest, material="S0", law="ogden", parameters={}, status="no equilibrium",
             message="no shear modulus has an answer", shear_modulus=None)  # fmt: skip
    return folder


@pytest.fixture(scope="module")
def whole_table(tmp_path_factory):
    """One run over all laws: its exit code, and the experiment, fits and output that it was given."""
    folder = tmp_path_factory.mktemp("table")
    experiment = displaced(folder / "bench", SHIFTS)
    fits, out = prepared(folder / "made" / "fits", experiment), folder / "out"
    found = RUNNER.invoke(app, [str(experiment), "--fits", str(fits), "--no-run", "--out", str(out)])
    return found.exit_code, experiment, fits, out


def table(path):
    with path.open(encoding="utf-8", newline="") as file:
        return {(r["law"], r["mixture"]): r for r in csv.DictReader(file)}


def shared_part(shift_mm):
    """Dice of two circles of radius 10 mm at a distance `shift_mm`."""
    half = shift_mm / 20
    return 2 / np.pi * (np.arccos(half) - half * np.sqrt(1 - half**2))


def test_figures_of_displaced_cylinders_beside_the_printed_ones(tmp_path, experiment, fits):
    out = tmp_path / "out"
    arguments = [str(experiment), "--fits", str(fits.parent), "--no-run", "--out", str(out),
                 "--model", "neo-hookean,ogden,arruda-boyce"]  # fmt: skip
    found = RUNNER.invoke(app, arguments)
    assert found.exit_code == 1, found.output  # the table is written although some laws have no results
    rows = table(out / "table.csv")
    assert len(rows) == 6 + 1  # with the average of neo-Hookean
    wanted = {"S0": shared_part(0.5), "S1": (shared_part(1.0) + shared_part(2.0)) / 2}
    for mixture, dice in wanted.items():
        row = rows["neo-hookean", mixture]
        shift = np.mean(SHIFTS[mixture])
        assert float(row["dice"]) == pytest.approx(dice, abs=0.002)
        # the sides are 2 d / pi apart, the end faces stay in their planes
        assert float(row["surface_distance_mm"]) == pytest.approx(2 * shift / np.pi * 50 / 60, rel=0.03)
        assert float(row["hd95_mm"]) == pytest.approx(shift, rel=0.03)
        assert float(row["volume_difference_percent"]) < 0.2
        assert float(row["node_distance_mm"]) > 1.0  # bias of volume nodes used as a surface
        assert float(row["node_hd95_mm"]) > 3.0
        assert float(row["candidate_core_s"]) == pytest.approx(5.0 / 50)
        assert (float(row["fit_core_s"]), float(row["fit_wall_s"])) == (7.0, 9.0)
        assert float(row["shear_modulus_kPa"]) == pytest.approx(20.0)
    average = rows["neo-hookean", "average"]
    assert float(average["dice"]) == pytest.approx((wanted["S0"] + wanted["S1"]) / 2, abs=0.002)
    assert float(average["paper_dice"]) == pytest.approx((0.957 + 0.891) / 2)  # average of the same mixtures


def test_paper_stands_beside(whole_table):
    _, experiment, fits, out = whole_table
    rows = table(out / "table.csv")
    assert rows["ogden", "S1"]["paper_dice"] == "0.926"
    assert rows["st-venant-kirchhoff", "S0"]["paper_volume_difference_percent"] == "0.948"
    assert rows["neo-hookean", "S1"]["paper_time_s"] == "26.89"
    assert len(printed()) == 18
    text = (out / "table.md").read_text(encoding="utf-8")
    assert f"`python -m calibration.table {experiment} --fits {fits} --out {out} --no-run`" in text
    assert "(0.957)" in text


def test_law_without_a_fit_has_a_row_that_says_so(whole_table):
    exit_code, _, _, out = whole_table
    assert exit_code == 1
    rows = table(out / "table.csv")
    assert rows["ogden", "S0"]["status"] == "no equilibrium"
    assert rows["ogden", "S0"]["message"] == "no shear modulus has an answer"
    assert rows["mooney-rivlin", "S1"]["status"] == "no fit"
    assert rows["mooney-rivlin", "S1"]["dice"] == ""
    text = (out / "table.md").read_text(encoding="utf-8")
    assert "no equilibrium: no shear modulus has an answer" in text
    assert ("ogden", "average") not in rows


def broken(path):
    path.write_text("{", encoding="utf-8")


def no_calibration(path):
    path.write_text("{}", encoding="utf-8")


def a_list(path):
    path.write_text("[1, 2]", encoding="utf-8")


def other_data(path):
    whole = json.loads(path.read_text(encoding="utf-8"))
    whole["header"]["data"] = "0" * 64
    path.write_text(json.dumps(whole), encoding="utf-8")


def other_law(path):
    whole = json.loads(path.read_text(encoding="utf-8"))
    whole["calibration"]["label"] = "ogden-2"
    path.write_text(json.dumps(whole), encoding="utf-8")


def bad_parameters(path):
    whole = json.loads(path.read_text(encoding="utf-8"))
    whole["calibration"]["parameters"] = {"nonsense": 1.0}
    path.write_text(json.dumps(whole), encoding="utf-8")


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (broken, "S0-neo-hookean.json: expected a fit"),
        (no_calibration, "S0-neo-hookean.json: expected a fit"),
        (a_list, "S0-neo-hookean.json: expected a fit"),
        (other_data, "header.data: expected a fit of"),
        (other_law, "expected neo-hookean of S0, it holds ogden-2 of S0"),
        (bad_parameters, "S0-neo-hookean.json: expected a fit"),
    ],
)
def test_spoilt_fit_is_refused_and_nothing_written(tmp_path, experiment, fits, spoil, says):
    spoil(fits / "S0-neo-hookean.json")
    out = tmp_path / "out"
    found = RUNNER.invoke(app, [str(experiment), "--fits", str(fits), "--no-run", "--out", str(out)])
    assert found.exit_code == 2
    assert says in found.output
    assert len(found.output.strip().splitlines()) == 1
    assert not out.exists()


FAULTS = {
    "clamp_tilt": ("rig", "angle_deg", 3.0),
    "grip_length": ("rig", "depth_mm", 4.0),
    "image_scale": ("camera", "excess", 0.03),
}


@pytest.fixture
def faulty(tmp_path):
    """A tilted beam that is held behind the clamp's face, enlarged, and its rig.yaml."""
    folder = on_a_faulty_rig(tmp_path / "faulty", tilt_deg=3.0, depth_mm=4.0, scale=0.03)
    return folder, rig_file(tmp_path / "rig.yaml", **FAULTS)


def on_rig(folder, faulty, rig=None):
    header = {} if rig is None else {"rig": read_rig(rig).digest, "rig_file": str(rig)}
    return fit_file(folder / "fits", digest=read(faulty).digest, material="S0", law="neo-hookean",
                    parameters=parameters("neo-hookean"), header=header)  # fmt: skip


def test_beams_of_a_fit_on_a_known_rig_are_simulated_on_it(tmp_path, faulty):
    """They were simulated as the lab states the rig, with no more than the fit's note that it differs."""
    experiment, rig = faulty
    found = {}
    for name, options in (("on", ["--rig", str(rig)]), ("off", [])):
        out = tmp_path / name
        on_rig(out, experiment, rig if options else None)
        ended = RUNNER.invoke(app, [str(experiment), "--fits", str(out), "--no-run", "--model", "neo-hookean",
                                    *options])  # fmt: skip
        assert ended.exit_code == 0, ended.output
        (found[name],) = table(out / "table.csv").values()
    assert float(found["on"]["dice"]) > 0.998 > 0.9 > float(found["off"]["dice"])
    assert float(found["on"]["hd95_mm"]) < 0.05 < 2.0 < float(found["off"]["hd95_mm"])
    assert float(found["on"]["node_hd95_mm"]) < float(found["off"]["node_hd95_mm"])
    # neither what the grip hides of the longer beam, 8 % of it, nor a section that is enlarged too
    assert float(found["on"]["volume_difference_percent"]) < 0.2
    text = (tmp_path / "on" / "table.md").read_text(encoding="utf-8")
    assert "corrected for what the rig is known to do: clamp-tilt" in text
    assert f"--rig {rig}" in text
    assert "as the lab states them" not in text
    assert "as the lab states them" in (tmp_path / "off" / "table.md").read_text(encoding="utf-8")


def test_what_both_grips_hide_of_a_beam_is_not_compared(tmp_path):
    experiment = on_a_faulty_rig(
        tmp_path / "held", tilt_deg=0.0, depth_mm=4.0, scale=0.0, supports="clamped-clamped"
    )
    rig = rig_file(tmp_path / "rig.yaml", grip_length=("rig", "depth_mm", 4.0))
    on_rig(tmp_path, experiment, rig)
    ended = RUNNER.invoke(app, [str(experiment), "--fits", str(tmp_path), "--no-run", "--model",
                                "neo-hookean", "--rig", str(rig)])  # fmt: skip
    assert ended.exit_code == 0, ended.output
    (row,) = table(tmp_path / "table.csv").values()
    assert float(row["dice"]) > 0.998
    assert float(row["volume_difference_percent"]) < 0.2


def test_a_fit_and_a_rig_that_are_not_of_each_other_are_refused(tmp_path, faulty):
    experiment, rig = faulty
    other = rig_file(tmp_path / "other.yaml", clamp_tilt=("rig", "angle_deg", 1.0))
    for made, given, says in (
        (rig, None, f"header.rig: expected the same --rig that it was made with, {rig}"),
        (rig, other, f"header.rig: expected the same --rig that it was made with, {rig}"),
        (None, rig, "header.rig: expected no --rig, since this fit was made without one"),
    ):
        on_rig(tmp_path / "fits", experiment, made)
        options = ["--rig", str(given)] if given else []
        ended = RUNNER.invoke(app, [str(experiment), "--fits", str(tmp_path / "fits"), "--no-run",
                                    "--model", "neo-hookean", *options])  # fmt: skip
        assert ended.exit_code == 2
        assert says in ended.output
        assert len(ended.output.strip().splitlines()) == 1
    missing = RUNNER.invoke(app, [str(experiment), "--rig", str(tmp_path / "none.yaml")])
    assert missing.exit_code == 2
    assert "none.yaml" in missing.output


def test_missing_fits_are_made_on_the_rig(tmp_path, faulty, monkeypatch):
    experiment, rig = faulty
    asked = []

    def run(tasks, **_):
        asked.extend(tasks)
        raise InputError("no fit here")

    monkeypatch.setattr("calibration.study.run", run)
    monkeypatch.chdir(tmp_path)
    RUNNER.invoke(app, [str(experiment), "--rig", str(rig), "--model", "neo-hookean"])
    (task,) = asked
    assert task.store().header["rig"] == read_rig(rig).digest
    assert task.store().header["rig_file"] == str(rig)


def test_folder_that_holds_no_fits_is_refused(tmp_path, experiment):
    empty, file = tmp_path / "empty", tmp_path / "file"
    empty.mkdir()
    file.write_text("no folder", encoding="utf-8")
    for wrong in (empty, file, tmp_path / "nowhere"):
        found = RUNNER.invoke(app, [str(experiment), "--fits", str(wrong), "--out", str(tmp_path / "out")])
        assert found.exit_code == 2
        assert f"--fits {wrong}: expected a folder that calibration.fit wrote" in found.output
    assert not (tmp_path / "out").exists()
    assert not list(empty.iterdir())


def test_a_target_that_is_a_file_is_refused_before_anything_is_computed(
    tmp_path, experiment, fits, monkeypatch
):
    monkeypatch.setattr("calibration.study.paper_table.row", None)
    (tmp_path / "out").write_text("mine")
    arguments = [str(experiment), "--fits", str(fits.parent), "--no-run", "--out", str(tmp_path / "out")]
    found = RUNNER.invoke(app, arguments)
    assert found.exit_code == 2
    assert found.stderr == f"error: --out {tmp_path / 'out'}: expected a folder, found a file\n"
    found = RUNNER.invoke(app, [str(experiment), "--fits", str(tmp_path / "out"), "--no-run"])
    assert found.stderr.startswith(f"error: --fits {tmp_path / 'out'}: expected a folder that")


def test_unknown_law_is_refused(experiment):
    found = RUNNER.invoke(app, [str(experiment), "--model", "hooke"])
    assert found.exit_code == 2
    assert "--model hooke: expected all or some of" in found.output


@pytest.mark.slow
def test_missing_fits_are_made(tmp_path, monkeypatch):
    """A beam with a negligible deflection: any stiff material fits it."""
    monkeypatch.chdir(tmp_path)
    folder = displaced(tmp_path / "bench", {"S0": (0.2,)}, gravity=-9.81)
    found = RUNNER.invoke(app, [str(folder), "--model", "neo-hookean", "--workers", "1"])
    assert found.exit_code == 0, found.output
    assert (tmp_path / "calibrations" / "bench" / "fits" / "S0-neo-hookean.json").exists()
    (row,) = table(tmp_path / "calibrations" / "bench" / "table.csv").values()
    assert row["status"] in ("converged", "not converged")
    assert float(row["dice"]) > 0.95
    again = RUNNER.invoke(app, [str(folder), "--model", "neo-hookean", "--no-run"])
    assert again.exit_code == 0, again.output
