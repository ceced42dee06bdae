"""`calibration.new`: experiments from files of machines, with answers or questions; the printed board."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from calibration.cli import VERBS
from calibration.errors import InputError
from calibration.experiment import BeamTrial, CouponTrial, PhotoSettings, PokeTrial, read, read_photo_settings
from calibration.experiment.model import Checkerboard
from calibration.new import app
from calibration.new._answers import BoardAnswers
from calibration.new._board import board_pdf
from calibration.new._plausible import Curve, young
from calibration.photo import find_board

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "datasets" / "lab-files"
HEAVY = ("cma", "cv2", "matplotlib", "scipy.stats", "pyvista", "torch", "trimesh", "jinja2", "yaml")
MU = 25e3  # Pa, of the synthetic files


def new(*words: str | Path, typed: str | None = None) -> tuple[int, str, str]:
    done = CliRunner().invoke(app, [str(w) for w in words], input=typed)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.stdout, done.stderr


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("made") / "deep" / "lab"
    code, shown, said = new("--yes", SAMPLES / "answers.yaml", "--out", out)
    assert code == 0, said
    assert f"{out}: 4 coupons, 1 poke, 1 beam; next: python -m calibration.fit {out}" in shown
    return out


def test_every_record_holds_the_material_that_it_was_made_of(made: Path) -> None:
    """Units, signs, areas, lengths and zeros of five machines, checked by the resulting modulus."""
    trials = {t.id: t for t in read(made).trials}
    modes = {"pull": "uniaxial", "squeeze": "uniaxial", "shear": "simple-shear", "strip": "uniaxial"}
    reach = {"pull": 2.0, "squeeze": 0.7, "shear": 1.5, "strip": 1.6}
    for name, mode in modes.items():
        trial = trials[name]
        assert isinstance(trial, CouponTrial)
        curve = Curve(mode=mode, stretch=trial.stretch, stress=trial.stress, time=trial.time)
        assert young(curve) == pytest.approx(3 * MU, rel=0.01), name
        assert trial.stretch[-1] == pytest.approx(reach[name], abs=1e-6)
        assert trial.stretch[0] == pytest.approx(1.0, abs=1e-9)
    poke = trials["push"]
    assert isinstance(poke, PokeTrial)
    assert poke.record.depth[[0, -1]] == pytest.approx([0.0, 2e-3])
    assert poke.record.force[-1] == pytest.approx(8 * MU * 3e-3 * 2e-3, rel=0.01)
    beam = trials["beam"]
    assert isinstance(beam, BeamTrial)
    assert beam.captures[0].outline is not None


def test_what_was_taken_by_default_is_written_and_said(made: Path) -> None:
    text = (made / "experiment.yaml").read_text(encoding="utf-8")
    for line in (
        "# - pull.rest_length_mm 50 (read from the header of instron.csv)",
        "# - pull.stretch_sd 0.002 (proposed, not measured: 0.1 mm of 50 mm)",
        "# - push.displacement_zero_mm -12.5 (the record's first row)",
        "# - beam.captures[#1].outline_sd_mm 0.2 (proposed, not measured: of an outline traced by hand)",
    ):
        assert line in text
    assert "pull.stretch_sd" in read(made).notes
    assert "shear.stretch_sd" not in text  # the lab stated this one


def test_a_folder_makes_itself_again(made: Path, tmp_path: Path) -> None:
    """Its answers name the files by their paths in the folder."""
    again = tmp_path / "again"
    assert new("--yes", made / "answers.yaml", "--out", again)[0] == 0
    for path in filter(Path.is_file, made.rglob("*")):
        assert path.read_bytes() == (again / path.relative_to(made)).read_bytes(), path.name


def test_a_full_folder_and_missing_arguments_are_refused(made: Path) -> None:
    before = (made / "experiment.yaml").read_bytes()
    code, _, said = new("--yes", SAMPLES / "answers.yaml", "--out", made)
    assert (code, said) == (2, f"error: --out {made}: expected an empty folder, or none yet\n")
    assert (made / "experiment.yaml").read_bytes() == before
    assert new("a.csv")[::2] == (2, "error: --out: missing, expected the folder to write\n")
    assert new("--out", made / "x")[0] == 2
    assert new("a.csv", "--yes", "b", "--out", made / "x")[0] == 2
    assert new("--board", made / "x.pdf", "--squares", "9")[0] == 2
    assert new("--board", made / "x.pdf", "--square-mm", "40")[0] == 2
    assert not (made / "x.pdf").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--yes", "none.yaml"], "none.yaml: expected a file with answers (No such file or directory)"),
        (
            ["--yes", str(SAMPLES / "answers.yaml"), "--page", "a5"],
            "--page a5: expected 'a4', 'a3' or 'letter'",
        ),
        (["--page", "a5"], "--page a5: expected 'a4', 'a3' or 'letter'"),
        (["--square-mm", "nan"], "--square-mm nan: expected a finite number"),
        (["--square-mm", "0.5"], "--square-mm 0.5: expected 1 or more"),
        (
            ["--square-mm", "60"],
            "--square-mm: a board of 9 x 6 squares of 60 mm does not fit on a4: expected",
        ),
        (["--squares", "2x6"], "--squares 2x6: expected 3 or more"),
        (
            ["--board", "none/board.pdf"],
            "--board none/board.pdf: expected a file in a folder that is there and",
        ),
    ],
)
def test_a_command_that_fails_writes_no_board(
    words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    code, _, sentence = new("--board", "board.pdf", "--out", "lab", *words)
    assert code == 2
    assert sentence.startswith(f"error: {said}")
    assert not list(tmp_path.iterdir())


def test_a_board_and_an_experiment_at_once(tmp_path: Path) -> None:
    """The board may lie in the folder, which has to be empty before."""
    out = tmp_path / "lab"
    out.mkdir()
    code, shown, _ = new("--board", out / "b.pdf", "--yes", SAMPLES / "answers.yaml", "--out", out)
    assert code == 0
    assert f"{out / 'b.pdf'}: 9 x 6 squares of 10 mm on a4; print at 100 %" in shown
    assert {"b.pdf", "experiment.yaml"} <= {p.name for p in out.iterdir()}


def test_show_says_what_a_file_holds() -> None:
    code, shown, _ = new("--show", SAMPLES / "zwick.txt")
    assert code == 0
    assert "zwick.txt: zwick, 2 tests" in shown
    assert "Standardkraft (N): force" in shown


def test_a_terminal_is_asked_for_what_is_missing(tmp_path: Path) -> None:
    """A strip without units: explanations, repeated questions after errors, defaults, and saved answers."""
    record = tmp_path / "my strip.csv"
    text = (SAMPLES / "plain.csv").read_text(encoding="utf-8").replace("strain %", "strain")
    record.write_text(text, encoding="utf-8")
    typed = ["", "coupon", "", "gel", "bogus", "uniaxial", "N", "%", ""]
    out = tmp_path / "lab"
    code, shown, said = new(record, "--out", out, typed="\n".join(typed) + "\n")
    assert code == 0, (shown, said)
    assert "expected one of uniaxial, equibiaxial, planar, simple-shear, got 'bogus'" in shown
    assert "expected a unit of ratio, got 'N'" in shown
    assert "A standard deviation (sd) says how far a repeated measurement falls from its mean" in shown
    answers = yaml.safe_load((out / "answers.yaml").read_text(encoding="utf-8"))
    (trial,) = answers["trials"]
    assert trial == {
        "id": "my strip",
        "kind": "coupon",
        "material": "gel",
        "file": "source/my strip.csv",
        "mode": "uniaxial",
        "units": {"strain": "%"},
    }
    assert new("--yes", out / "answers.yaml", "--out", tmp_path / "again")[0] == 0
    first, second = ((f / "experiment.yaml").read_bytes() for f in (out, tmp_path / "again"))
    assert first == second


@pytest.mark.parametrize(("reply", "code"), [("n", 2), ("y", 0)])
def test_a_terminal_is_asked_about_the_implausible(reply: str, code: int, tmp_path: Path) -> None:
    """A silicone of 75 MPa stretched to 1.6: the stress is in kPa, not in MPa."""
    record = tmp_path / "strip.csv"
    text = (SAMPLES / "plain.csv").read_text(encoding="utf-8").replace("kPa", "MPa")
    record.write_text(text, encoding="utf-8")
    out = tmp_path / "lab"
    typed = ["", "coupon", "", "gel", "uniaxial", "", reply]
    got, shown, said = new(record, "--out", out, typed="\n".join(typed) + "\n")
    assert got == code, (shown, said)
    assert "a Young's modulus of 74.9 MPa" in shown
    assert out.exists() == (code == 0)
    if code == 0:
        answers = yaml.safe_load((out / "answers.yaml").read_text(encoding="utf-8"))
        assert answers["trials"][0]["accept"] == ["modulus"]


def test_photographs_become_captures_of_one_beam(tmp_path: Path) -> None:
    photos = ROOT / "datasets" / "measured" / "photographs" / "photos"
    first, second = photos / "cantilever-060.jpg", photos / "cantilever-100.jpg"
    typed = ["two", "bar", "silicone", "bar"]  # name, id, material; the second one is of the same beam
    typed += ["circle", "10", "", "100", "", "20", "clamped-free", ""]
    typed += ["60", "9 6", "8", "120", "9x6", "8", "1000", "5"]
    typed += ["", "12 26"]  # the beam's back lies on the board; position of the corner of its squares
    out = tmp_path / "lab"
    code, shown, said = new(first, second, "--out", out, typed="\n".join(typed) + "\n")
    assert code == 0, (shown, said)
    assert f"next: python -m calibration.reconstruct {out}" in shown
    (beam,) = read(out).trials
    assert isinstance(beam, BeamTrial)
    assert [c.time for c in beam.captures] == [60.0, 120.0]
    assert beam.captures[1].photo == out / "photos" / "cantilever-100.jpg"
    assert beam.captures[1].photo.read_bytes() == second.read_bytes()
    assert read_photo_settings(out) == PhotoSettings(board_corner_mm=(12.0, 26.0))
    assert "photographs.board_distance_mm touches" in (out / "experiment.yaml").read_text(encoding="utf-8")
    assert new("--yes", out / "answers.yaml", "--out", tmp_path / "again")[0] == 0
    assert read_photo_settings(tmp_path / "again") == read_photo_settings(out)


def test_further_photographs_of_the_board_come_along(tmp_path: Path) -> None:
    photos = ROOT / "datasets" / "measured" / "photographs" / "photos"
    capture = {"time_s": 60.0, "photo": str(photos / "cantilever-060.jpg")}
    capture["photo_checkerboard"] = {"squares": [9, 6], "square_mm": 8.0}
    beam = {"id": "bar", "kind": "beam", "material": "gel", "section": {"circle": {"radius_mm": 10.0}}}
    beam |= {
        "free_length_mm": 60.0,
        "grip_length_mm": 20.0,
        "supports": "clamped-free",
        "captures": [capture],
    }
    boards = {"calibration_photos": [str(photos / "cantilever-100.jpg")], "board_distance_mm": 12.0}
    answers = {"name": "one", "materials": {"gel": {"density_kg_m3": 1000.0}}, "photographs": boards}
    path = tmp_path / "answers.yaml"
    path.write_text(yaml.safe_dump(answers | {"trials": [beam]}), encoding="utf-8")
    out = tmp_path / "lab"
    code, _, said = new("--yes", path, "--out", out)
    assert code == 0, said
    settings = read_photo_settings(out)
    assert settings == PhotoSettings(
        board_distance_mm=12.0, calibration_photos=("photos/cantilever-100.jpg",)
    )
    assert (out / settings.calibration_photos[0]).read_bytes() == (photos / "cantilever-100.jpg").read_bytes()
    path.write_text(
        yaml.safe_dump(answers | {"photographs": {"board_distance_mm": -1.0}, "trials": [beam]}),
        encoding="utf-8",
    )
    code, _, said = new("--yes", path, "--out", tmp_path / "bad")
    assert code == 2
    assert "photographs.board_distance_mm" in said


def test_the_printed_board_is_found_at_its_true_size() -> None:
    """Its squares, rendered at 4 dots per millimetre and found as in the reconstruction of photographs."""
    text = board_pdf(BoardAnswers(squares=(9, 6), square_mm=12.5, page="a4")).decode("latin-1")
    page = [float(v) for v in re.search(r"MediaBox \[(.*?)\]", text)[1].split()]  # type: ignore[index]
    assert page[2:] == pytest.approx([297 / 25.4 * 72, 210 / 25.4 * 72], abs=1e-2)
    dots = 4 * 25.4 / 72
    image = np.full((round(page[3] * dots), round(page[2] * dots)), 255, np.uint8)
    for box in re.findall(r"([\d.]+) ([\d.]+) ([\d.]+) ([\d.]+) re f", text):
        x, y, width, height = (float(v) * dots for v in box)
        top = image.shape[0] - y
        image[round(top - height) : round(top), round(x) : round(x + width)] = 0
    board = find_board(image, Checkerboard(squares=(9, 6), square=12.5e-3))
    assert board.corners.shape == (5, 8, 2)
    steps = np.linalg.norm(np.diff(board.corners, axis=1), axis=-1) / 4.0
    assert steps == pytest.approx(np.full((5, 7), 12.5), abs=0.06)
    assert text.startswith("%PDF-1.4")
    assert text.endswith("%%EOF\n")
    assert text[int(text.split()[-2]) :].startswith("xref")


@pytest.mark.parametrize("page", ["a4", "a3", "letter"])
@pytest.mark.parametrize("squares", [(9, 6), (5, 12), (60, 60)])
@pytest.mark.parametrize("asked", [60.0, 150.0])
def test_a_board_too_large_for_its_page_is_refused(page: str, squares: tuple[int, int], asked: float) -> None:
    """The side that is said to fit is the largest, whatever was asked for: it was -3.67 mm for one of 100."""
    with pytest.raises(InputError, match=f"does not fit on {page}: expected at most") as refused:
        board_pdf(BoardAnswers(squares=squares, square_mm=asked, page=page))  # type: ignore[arg-type]
    side = float(str(refused.value).split()[-2])
    assert board_pdf(BoardAnswers(squares=squares, square_mm=side, page=page))  # type: ignore[arg-type]
    with pytest.raises(InputError, match=f"expected at most {side:g} mm"):
        board_pdf(BoardAnswers(squares=squares, square_mm=side + 0.1, page=page))  # type: ignore[arg-type]


def test_the_next_command_can_be_typed_as_it_is_shown(tmp_path: Path) -> None:
    out = tmp_path / "our lab"
    code, shown, _ = new("--yes", SAMPLES / "answers.yaml", "--out", out)
    assert code == 0
    assert shown.rstrip().endswith(f"next: python -m calibration.fit '{out}'")


def test_the_command_starts_light_and_is_listed() -> None:
    assert "new" in VERBS
    code = (
        "import sys; from typer.testing import CliRunner; from calibration.new import app\n"
        "assert CliRunner().invoke(app, ['--help']).exit_code == 0\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "[]", done.stderr


def test_what_was_typed_is_shown_where_it_cannot_be_used(tmp_path: Path) -> None:
    """A section that contradicts the outline is found at the end; the end of input stops the command."""
    outline = ROOT / "datasets/measured/bench/clean/beams/S0.5-cantilever-100-t100.csv"
    typed = [
        "",
        "",
        "gel",
        "circle",
        "10",
        "",
        "20",
        "",
        "20",
        "clamped-free",
        "",
        "60",
        *[""] * 5,
        "1000",
        "",
        "y",
    ]
    out = tmp_path / "lab"
    code, shown, said = new(outline, "--out", out, typed="\n".join(typed) + "\n")
    assert code == 2
    assert said.startswith(f"error: {outline}: line "), said
    assert "free_length_mm: 20.0" in shown
    code, _, said = new(outline, "--out", out, typed="\n".join(typed[:5]) + "\n")
    assert (code, said.strip()) == (130, "Stopped: nothing was written.")
    assert not out.exists()


def test_a_position_begins_anywhere_and_a_clock_may_slip(tmp_path: Path) -> None:
    """A cylinder of 20 mm, compressed by 4 mm from a position of 112 mm downwards; two rows are late."""
    time = [0.0, 1.0, 2.0, 1.5, 3.0, 4.0, 3.9, 5.0, 6.0, 7.0, 8.0]
    rows = "".join(f"{t},{112 - 0.5 * t:.3f},{0.8 * t:.3f}\n" for t in time)
    (tmp_path / "a.csv").write_text("Time/s,Position (mm),Load (N)\n" + rows)
    answers = {
        "name": "cylinder",
        "trials": [
            {
                "id": "press",
                "kind": "coupon",
                "material": "gel",
                "file": "a.csv",
                "mode": "uniaxial",
                "displacement_positive": "tension",
                "rest_length_mm": 20.0,
                "diameter_mm": 20.0,
                "leave_out_rows": True,
            }
        ],
    }
    (tmp_path / "answers.yaml").write_text(yaml.safe_dump(answers))
    out = tmp_path / "lab"
    code, _, said = new("--yes", tmp_path / "answers.yaml", "--out", out)
    assert code == 0, said
    experiment = read(out)
    (trial,) = experiment.trials
    assert isinstance(trial, CouponTrial)
    assert trial.time is not None
    assert trial.time.tolist() == [0.0, 1.0, 1.5, 3.0, 3.9, 5.0, 6.0, 7.0, 8.0]
    assert trial.stretch == pytest.approx(1.0 - 0.025 * trial.time)
    assert trial.stress == pytest.approx(-0.8 * trial.time / (np.pi * 0.01**2))
    assert "press: the clock runs backwards in lines 4, 7, left out" in experiment.notes
    assert "press.displacement_zero_mm" in experiment.notes


def test_an_indentation_is_asked_for_what_its_file_does_not_say(tmp_path: Path) -> None:
    typed = [
        "",
        "poke",
        "dent",
        "gel",
        "60 60 20",
        "3",
        "flat",
        "Move Relative",
        "tension",
        "",
        "",
        "",
        "0.05",
    ]
    out = tmp_path / "lab"
    code, shown, said = new(SAMPLES / "mach-1.txt", "--out", out, typed="\n".join(typed) + "\n")
    assert code == 0, (shown, said)
    assert "what positive values of the column Position (z) mean" in shown
    (poke,) = read(out).trials
    assert isinstance(poke, PokeTrial)
    assert (poke.rod_radius, *poke.start, poke.depth_sd) == pytest.approx((3e-3, 0.0, 0.0, 0.02, 5e-5))
    assert poke.record.depth[-1] == pytest.approx(2e-3)
    again = tmp_path / "again"
    assert new("--yes", out / "answers.yaml", "--out", again)[0] == 0
    assert (again / "experiment.yaml").read_bytes() == (out / "experiment.yaml").read_bytes()
