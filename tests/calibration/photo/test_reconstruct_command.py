"""`python -m calibration.reconstruct` on an experiment of rendered photographs."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import photo_cases as cases
import pytest
import trimesh
import yaml
from typer.testing import CliRunner, Result

from benchmarks.blind.camera import Lens, Setting, Tube, View, photograph
from calibration.errors import InputError
from calibration.experiment import BeamTrial, PhotoSettings, read
from calibration.experiment.model import Registration
from calibration.photo import reconstruction
from calibration.photo._image import read_photograph
from calibration.reconstruct import app

AXIS = cases.hanging()


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("photographs") / "lab"
    (folder / "photos").mkdir(parents=True)
    lens = Lens(size=(800, 600), focal=1860.0, centre=(400.0, 298.0), k1=-0.2)
    for name, view in (("first", View(yaw=12.0)), ("second", View(yaw=3.0, pitch=-12.0))):
        setting = Setting(tubes=(Tube(axis=AXIS, radius=10.0),), blur=0.8)
        cv2.imwrite(str(folder / "photos" / f"{name}.png"), photograph(setting, lens, view))
    captures = [
        {
            "time_s": time,
            "photo": f"photos/{name}.png",
            "photo_checkerboard": {"squares": [9, 6], "square_mm": 8.0},
        }
        for name, time in (("first", 10.0), ("second", 100.0))
    ]
    captures[1]["registration_sd"] = {"shift_mm": 0.3, "roll_deg": 0.4, "scale": 0.0}
    rows = []
    for side, sign in (("upper", 1), ("lower", -1)):
        rows += [f"{side},{x:.4f},{z:.4f}" for x, z in cases.edge(AXIS, sign)[20:-20:40]]
    (folder / "traced.csv").write_text("side,x_mm,z_mm\n" + "\n".join(rows) + "\n")
    captures.append(
        {
            "time_s": 1000.0,
            "outline": "traced.csv",
            "outline_sd_mm": 0.1,
            "outline_correlation_mm": 5.0,
            "registration_sd": {"shift_mm": 0.1, "roll_deg": 0.1, "scale": 0.001},
        }
    )
    trial = {
        "id": "hang",
        "kind": "beam",
        "material": "S",
        "section": {"circle": {"radius_mm": 10.0, "radius_sd_mm": 0.05}},
        "free_length_mm": 100.0,
        "grip_length_mm": 20.0,
        "supports": "clamped-free",
        "gravity_m_s2": [0.0, 0.0, -9.81],
        "captures": captures,
    }
    # a file that experiment.yaml does not name, with the name of an outline that is traced
    (folder / "outlines").mkdir(exist_ok=True)
    (folder / "outlines" / "hang-1.csv").write_text("side,x_mm,z_mm\nan old one\n")
    raw = {"format": 1, "name": "lab", "materials": {"S": {}}, "trials": [trial]}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(raw))
    return folder


def command(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.fixture(scope="module")
def done(lab: Path) -> Path:
    out = lab.parent / "out"
    result = command(lab, "--out", out)
    assert result.exit_code == 0, result.output
    return out


def files(out: Path) -> dict[str, tuple[int, bytes]]:
    return {
        str(path.relative_to(out)): (path.stat().st_mtime_ns, path.read_bytes())
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


def test_what_it_writes_is_an_experiment(done: Path) -> None:
    experiment = read(done)
    assert experiment.notes == "outlines traced from the photographs of lab"
    (trial,) = experiment.trials
    assert isinstance(trial, BeamTrial)
    assert len(trial.captures) == 3
    for capture in trial.captures:
        assert capture.outline is not None
        assert capture.photo is None
        for side, line in ((1, capture.outline.upper), (-1, capture.outline.lower)):
            off = cases.normal_error(line * 1e3, cases.edge(AXIS, side))
            assert np.sqrt(np.mean(off**2)) < 0.1
    first, second, traced = (capture.outline for capture in trial.captures)
    # for waves longer than 10 mm, where both kernels have the same meaning
    slow, given = (o.sd * np.sqrt(o.correlation / 0.010) for o in (first, traced))
    assert slow < 0.03e-3 < given
    assert (traced.sd, traced.correlation) == pytest.approx((0.1e-3, 5e-3))
    assert first.shared.scale == pytest.approx(second.shared.scale, rel=0.5)
    assert first.shared.scale > 0.0 == traced.shared.scale
    assert second.registration.shift > 0.3e-3 > first.registration.shift
    assert second.registration.roll > np.radians(0.4) > first.registration.roll


def test_bodies_lines_and_pictures(done: Path) -> None:
    for number in (1, 2, 3):
        body = trimesh.load(done / "meshes" / f"hang-{number}.stl")
        assert body.is_watertight
        assert body.volume == pytest.approx(np.pi * 10.0**2 * 100.0, rel=0.01)
        table = np.genfromtxt(done / "centrelines" / f"hang-{number}.csv", delimiter=",", names=True)
        line = np.column_stack([table["x_mm"], table["z_mm"]])
        assert np.abs(cases.normal_error(line, AXIS)).max() < 0.25
    for number in (1, 2):
        assert cv2.imread(str(done / "pictures" / f"hang-{number}.png")).shape[1] > 1500


def test_second_run_keeps_all(lab: Path, done: Path) -> None:
    before = files(done)
    result = command(lab, "--out", done)
    assert result.exit_code == 0
    assert result.output.count("kept") == 3
    after = files(done)
    assert {k: v[1] for k, v in after.items()} == {k: v[1] for k, v in before.items()}
    traced = [
        name for name in before if name.split("/")[0] in ("outlines", "meshes", "pictures", "centrelines")
    ]
    assert [after[name] for name in traced] == [before[name] for name in traced]


def test_lost_file_is_made_again(lab: Path, done: Path) -> None:
    before = files(done)
    (done / "meshes" / "hang-3.stl").unlink()
    result = command(lab, "--out", done)
    assert result.output.count("kept") == 2
    assert {k: v[1] for k, v in files(done).items()} == {k: v[1] for k, v in before.items()}


def test_bad_photograph(lab: Path, tmp_path: Path) -> None:
    folder, out = tmp_path / "lab", tmp_path / "out"
    shutil.copytree(lab, folder)
    bad = np.full((600, 800), 180, np.uint8)
    cv2.imwrite(str(folder / "photos" / "first.png"), bad)
    result = command(folder, "--out", out)
    assert result.exit_code == 2
    assert "hang-1 (first.png): no board of 9 x 6 squares was found" in result.output
    shown = f"(pictures of what was found in {out / 'problems'})"
    assert f"1 of 3 captures cannot be used {shown}; 2 are traced" in result.output
    assert not (out / "experiment.yaml").exists()
    assert (out / "problems" / "hang-1.png").exists()
    result = command(folder, "--out", out, "--skip-bad")
    assert result.exit_code == 0
    assert result.output.count("kept") == 2
    (trial,) = read(out).trials
    assert [capture.time for capture in trial.captures] == [100.0, 1000.0]


def test_no_photograph_that_can_be_used(lab: Path, tmp_path: Path) -> None:
    """Each has its own sentence, with --skip-bad too."""
    folder = tmp_path / "lab"
    shutil.copytree(lab, folder)
    raw = yaml.safe_load((folder / "experiment.yaml").read_text())
    del raw["trials"][0]["captures"][2]
    (folder / "experiment.yaml").write_text(yaml.safe_dump(raw))
    for name in ("first", "second"):
        cv2.imwrite(str(folder / "photos" / f"{name}.png"), np.full((600, 800), 180, np.uint8))
    result = command(folder, "--out", tmp_path / "out", "--skip-bad")
    assert result.exit_code == 2
    assert "no photograph can be used" in result.output
    for name in ("hang-1 (first.png)", "hang-2 (second.png)"):
        assert f"{name}: no board of 9 x 6 squares was found" in result.output


def test_a_board_that_no_lens_fits_leaves_the_outlines(
    lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bent(_boards: object) -> None:
        raise InputError("camera: the board's corners miss a flat board by 9 pixels; is it bent?")

    monkeypatch.setattr(reconstruction, "calibrate", bent)
    result = command(lab, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "hang-1 (first.png): camera: the board's corners miss" in result.output
    assert "2 of 3 captures cannot be used; 1 are traced" in result.output  # no picture shows a lens
    assert command(lab, "--out", tmp_path / "out", "--skip-bad").exit_code == 0


def test_a_board_photographed_at_another_size_is_refused(lab: Path, tmp_path: Path) -> None:
    folder = tmp_path / "lab"
    shutil.copytree(lab, folder)
    lens = Lens(size=(1000, 750), focal=2325.0, centre=(500.0, 372.0), k1=-0.2)
    setting = Setting(tubes=(), clamps=(), blur=0.8)
    cv2.imwrite(str(folder / "board.png"), photograph(setting, lens, View()))
    (folder / "photographs.yaml").write_text("calibration_photos: [board.png]")
    result = command(folder, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "board.png: expected a photograph of 800 x 600 pixels" in result.output
    assert "it is 1000 x 750" in result.output


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_grey_values_of_more_bits(tmp_path: Path, bits: int) -> None:
    """Cameras write 10 or 12 bits into 16."""
    grey = np.random.default_rng(1).integers(0, 256, (420, 500)).astype(np.uint8)
    grey[0, 0] = 255
    path = tmp_path / "a.tif"
    cv2.imwrite(str(path), grey.astype(np.uint16) << (bits - 8))
    np.testing.assert_array_equal(read_photograph(path), grey)
    cv2.imwrite(str(tmp_path / "b.tif"), grey.astype(np.float32))
    with pytest.raises(InputError, match="expected grey values of 8 or 16 bits"):
        read_photograph(tmp_path / "b.tif")


def test_stopped_in_between(lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    run, names = reconstruction.run, []

    def stop_at_second(target: Path, job: reconstruction.Job, *rest: object) -> object:
        names.append(job.name)
        if len(names) == 2:
            raise KeyboardInterrupt
        return run(target, job, *rest)

    monkeypatch.setattr(reconstruction, "run", stop_at_second)
    result = command(lab, "--out", out)
    assert result.exit_code == 130
    assert not (out / "experiment.yaml").exists()
    monkeypatch.undo()
    result = command(lab, "--out", out)
    assert result.exit_code == 0
    assert result.output.count("kept") == 1


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("board_corner: [1, 2]", "photographs.yaml: unknown key board_corner: expected board_corner_mm"),
        ("square_sd: .nan", "photographs.yaml: key square_sd"),
        ("clamp_front_mm: 3", "photographs.yaml: key clamp_front_mm"),
        ("- 1", "expected keys and values at the top level"),
        ("calibration_photos: [none.png]", "none.png: no such photograph"),
    ],
)
def test_bad_settings(lab: Path, tmp_path: Path, text: str, sentence: str) -> None:
    folder, out = tmp_path / "lab", tmp_path / "out"
    shutil.copytree(lab, folder)
    (folder / "photographs.yaml").write_text(text)
    result = command(folder, "--out", out)
    assert result.exit_code == 2
    assert sentence in result.output
    assert not out.exists()


@pytest.mark.parametrize("name", ["outlines/hang-1.csv", "./outlines//hang-1.csv", "outlines/Hang-1.csv"])
def test_a_given_outline_is_not_taken_for_a_traced_one(lab: Path, tmp_path: Path, name: str) -> None:
    """It was copied over the outline that was traced from another photograph."""
    folder, out = tmp_path / "lab", tmp_path / "out"
    shutil.copytree(lab, folder)
    (folder / "outlines").mkdir(exist_ok=True)
    (folder / "traced.csv").rename(folder / name)
    main = folder / "experiment.yaml"
    main.write_text(main.read_text().replace("traced.csv", name))
    result = command(folder, "--out", out)
    assert result.exit_code == 2
    sentence = f"{main}: {name}: expected another name of this file, it is that of the outline traced from"
    assert f"{sentence} hang-1\n" in result.output
    assert not out.exists()


def test_what_is_known_of_a_given_outline_is_kept_with_it(lab: Path) -> None:
    """The registration in reconstruct.json stayed that of an earlier experiment.yaml."""
    (trial,) = read(lab).trials
    assert isinstance(trial, BeamTrial)
    capture = trial.captures[2]
    assert capture.outline is not None
    keys = set()
    for error in (capture.outline.registration, Registration(shift=5e-4)):
        for shared in (capture.outline.shared, Registration(scale=0.01)):
            changed = replace(capture, outline=replace(capture.outline, registration=error, shared=shared))
            job = reconstruction.Job(name="hang-3", trial=trial, number=2, capture=changed)
            keys.add(reconstruction.digest(job, None, None, PhotoSettings()))
    assert len(keys) == 4


def test_targets_it_refuses(lab: Path, tmp_path: Path) -> None:
    assert "other than the experiment's own" in command(lab, "--out", lab).output
    (tmp_path / "file").write_text("")
    assert "it is a file" in command(lab, "--out", tmp_path / "file").output
    shutil.copytree(lab, tmp_path / "other")
    result = command(lab, "--out", tmp_path / "other")
    assert result.exit_code == 2
    assert "did not write" in result.output


def test_the_traced_experiment_of_another_is_not_replaced(lab: Path, done: Path, tmp_path: Path) -> None:
    """Experiments of two days, in folders of one name; one that was moved goes on."""
    out, other = tmp_path / "out", tmp_path / "lab"
    shutil.copytree(done, out)
    before = files(out)
    shutil.copytree(lab, other)
    raw = yaml.safe_load((lab / "experiment.yaml").read_text())
    (trial,) = raw["trials"]
    trial |= {"id": "bar", "captures": trial["captures"][2:]}  # no photograph
    (other / "experiment.yaml").write_text(yaml.safe_dump(raw))
    result = command(other, "--out", out)
    assert result.exit_code == 2
    assert f"error: --out {out}: holds the traced experiment 'lab' of {lab}: " in result.output
    assert "add --overwrite" in result.output
    assert files(out) == before
    noted = out / ".reconstruct" / "experiment.json"
    for source in ({"name": "lab", "folder": str(tmp_path / "moved")}, {"name": "old", "folder": str(other)}):
        noted.write_text(json.dumps(source))
        assert reconstruction.other_source(out, other, "lab") is None
    noted.unlink()  # as an earlier version left it
    assert reconstruction.other_source(out, other, "lab") is None
    assert reconstruction.other_source(out, tmp_path / "tuesday", "lab") == "of a folder lab"
    result = command(other, "--out", out, "--overwrite")
    assert result.exit_code == 0, result.output
    assert [t.id for t in read(out).trials] == ["bar"]


def test_files_whose_names_differ_in_case_alone(lab: Path, tmp_path: Path) -> None:
    folder, out = tmp_path / "lab", tmp_path / "out"
    shutil.copytree(lab, folder)
    main = folder / "experiment.yaml"
    raw = yaml.safe_load(main.read_text())
    captures = raw["trials"][0]["captures"]
    captures.append(captures[2] | {"time_s": 2e3, "outline": "Traced.csv"})
    shutil.copyfile(folder / "traced.csv", folder / "Traced.csv")
    main.write_text(yaml.safe_dump(raw))
    result = command(folder, "--out", out)
    assert result.exit_code == 2
    sentence = "traced.csv: expected a name that differs in more than letter case from that of Traced.csv"
    assert f"error: {main}: {sentence}\n" in result.output
    assert not out.exists()
