"""Common errors in experiments: separators, units, missing keys, malicious files. Each is named."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
import yaml
from _folders import beam_entry, coupon_entry, poke_entry, write_experiment

from calibration.errors import InputError
from calibration.experiment import CouponTrial, load, read

TIME = np.linspace(0.0, 10.0, 40)
RECORD = {"time_s": TIME, "depth_mm": 0.3 * TIME, "force_N": 0.05 * TIME}


def block(folder: Path, **more: object) -> Path:
    return write_experiment(folder, [poke_entry("p1", "p1.csv", **more)], tables={"p1.csv": RECORD})


def refusal(folder: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(folder)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(("mark", "name"), [(";", "semicolons"), ("\t", "tabs"), ("|", "bars")])
def test_other_separators_are_named(tmp_path: Path, mark: str, name: str) -> None:
    folder = block(tmp_path)
    table = folder / "p1.csv"
    table.write_text(table.read_text().replace(",", mark))
    said = refusal(folder)
    assert said.startswith(f"{table}: line 1: its columns are separated by {name}, expected commas")
    assert "time_s,depth_mm,force_N" in said


def test_decimal_commas_are_named(tmp_path: Path) -> None:
    folder = block(tmp_path)
    (folder / "p1.csv").write_text("time_s,depth_mm,force_N\n0,0,0,0,0,0\n1,5,0,3,0,1\n")
    assert "are its decimals written with commas? expected points" in refusal(folder)
    (folder / "p1.csv").write_text('time_s,depth_mm,force_N\n"0,5","0,1","0,2"\n')
    assert "expected a finite number (decimals with points, not commas), got '0,5'" in refusal(folder)


def test_metres_under_millimetres(tmp_path: Path) -> None:
    folder = write_experiment(
        tmp_path,
        [poke_entry("p1", "p1.csv")],
        tables={"p1.csv": {**RECORD, "depth_mm": 0.3e-3 * TIME}},
    )
    said = refusal(folder)
    assert said.startswith(f"{folder / 'p1.csv'}: column depth_mm: expected a depth in mm")
    assert "the deepest is 0.003; is the column in metres?" in said


def test_a_shallow_record_in_millimetres_is_read(tmp_path: Path) -> None:
    folder = write_experiment(
        tmp_path,
        [poke_entry("p1", "p1.csv")],
        tables={"p1.csv": {**RECORD, "depth_mm": 0.005 * TIME}},
    )
    assert len(read(folder).trials) == 1


def test_every_missing_key_is_named(tmp_path: Path) -> None:
    folder = block(tmp_path)
    whole = yaml.safe_load((folder / "experiment.yaml").read_text())
    for key in ("block_mm", "rod", "start_mm", "direction", "record"):
        del whole["trials"][0][key]
    (folder / "experiment.yaml").write_text(yaml.safe_dump(whole))
    said = refusal(folder)
    for key in ("block_mm", "rod", "start_mm", "direction", "record"):
        assert f"trials[p1].{key}" in said
    assert "more" not in said


def test_unknown_keys_are_named_with_what_they_stand_for(tmp_path: Path) -> None:
    folder = block(tmp_path)
    whole = yaml.safe_load((folder / "experiment.yaml").read_text())
    trial = whole["trials"][0]
    trial["start"] = trial.pop("start_mm")
    trial["block_m"] = trial.pop("block_mm")
    trial["colour"] = "blue"
    del trial["record"]
    (folder / "experiment.yaml").write_text(yaml.safe_dump(whole))
    said = refusal(folder)
    for words in ("start", "expected start_mm", "block_m", "block_mm", "colour", "record"):
        assert words in said


def bomb() -> str:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 12)]
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (bomb(), "its aliases stand for more"),
        ("a: &a\n  b: *a\n", "without aliases of themselves"),
        ("a: &a {<<: *a}\n", "without aliases of themselves"),
        ("a: " + "[" * 5_000 + "]" * 5_000 + "\n", "nested 50 deep at most"),
        ("a: " + "{b: " * 200 + "1" + "}" * 200 + "\n", "nested 50 deep at most"),
        ("a: !!timestamp 2024-13-45\n", "expected plain YAML values"),
        (f"a: {'9' * 6000}\n", "expected a number of usual size"),
        (f"a: 0x{'f' * 6000}\n", "unknown key a"),  # text, as YAML 1.2 has it
        ("a: 1\nb: 2\na: 3\n", "key a stands there twice"),
        ("? [1, 2]\n: 3\n? {a: b}\n: 4\n", "expected"),
    ],
    ids=["bomb", "cycle", "merge", "deep", "deep-map", "date", "integer", "hex", "twice", "keys"],
)
def test_yaml_that_means_harm_ends_in_a_sentence(tmp_path: Path, text: str, words: str) -> None:
    begun = time.process_time()
    path = tmp_path / "experiment.yaml"
    path.write_text(text)
    said = refusal(tmp_path)
    assert said.startswith(f"{path}: ")
    assert words in said
    assert len(said) < len(str(tmp_path)) + 400
    assert time.process_time() - begun < 10.0


def test_a_date_is_text(tmp_path: Path) -> None:
    assert load(b"day: 2024-13-45\n", tmp_path / "x.yaml") == {"day": "2024-13-45"}


def test_aliases_that_are_few_are_read(tmp_path: Path) -> None:
    assert load(b"a: &a [1, 2]\nb: *a\n", tmp_path / "x.yaml") == {"a": [1, 2], "b": [1, 2]}


def test_a_file_of_many_megabytes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected at most 20 MB, got 2[0-9] MB"):
        load(b"a: 1 " + b" " * 21_000_000, tmp_path / "x.yaml")


@pytest.mark.parametrize("squares", [[40, 25], [1000, 1000], [61, 5]])
def test_a_board_that_no_memory_holds(tmp_path: Path, squares: list[int]) -> None:
    capture = {
        "time_s": 1.0,
        "photo": "a.png",
        "photo_checkerboard": {"squares": squares, "square_mm": 5.0},
    }
    (tmp_path / "a.png").write_bytes(b"")
    folder = write_experiment(tmp_path, [beam_entry("b", captures=[capture])])
    said = refusal(folder)
    assert "trials[b].captures[#1].photo_checkerboard.squares" in said
    assert "expected at most" in said


def test_a_long_record_is_averaged_in_bins(tmp_path: Path) -> None:
    """200,000 samples of a noisy straight line become 4,000 points, each the mean of 50 samples."""
    rng = np.random.default_rng(3)
    n = 200_000
    stretch = np.linspace(1.0, 2.0, n)
    stress = 100.0 * (stretch - 1.0) + rng.normal(0.0, 1.0, n)
    lines = [
        "stretch,nominal_stress_kPa",
        *(f"{a:.7f},{b:.4f}" for a, b in zip(stretch, stress, strict=True)),
    ]
    folder = write_experiment(tmp_path, [coupon_entry("pull", "pull.csv")])
    (folder / "pull.csv").write_text("\n".join(lines) + "\n")
    (trial,) = read(folder).trials
    assert isinstance(trial, CouponTrial)
    assert trial.samples is not None
    assert trial.samples.sum() == n
    assert len(trial.stretch) == len(trial.stress) == len(trial.samples) <= 4000
    assert np.median(trial.samples) == 50.0
    first = int(trial.samples[0])
    assert trial.stretch[0] == pytest.approx(stretch[:first].mean(), abs=1e-7)
    error = (trial.stress - 1e5 * (trial.stretch - 1.0)) * np.sqrt(trial.samples)
    assert np.std(error) == pytest.approx(1e3, rel=0.05)


def test_a_record_of_usual_length_is_kept_as_it_is(tmp_path: Path) -> None:
    stretch = np.linspace(1.0, 2.0, 4000)
    folder = write_experiment(
        tmp_path,
        [coupon_entry("pull", "pull.csv")],
        tables={"pull.csv": {"stretch": stretch, "nominal_stress_kPa": 100.0 * stretch}},
    )
    (trial,) = read(folder).trials
    assert isinstance(trial, CouponTrial)
    assert trial.samples is None
    assert (trial.stretch == stretch).all()
