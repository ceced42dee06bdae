"""Fits on disk: damage gives one sentence, never a traceback, and no loss."""

from __future__ import annotations

import linecache
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment

from calibration.errors import InputError
from calibration.experiment import read
from calibration.inference import Generation, Problem
from calibration.parameters import parametrisation
from calibration.study import Calibration, stopped, tasks_for
from calibration.study._store import FitStore, locked, remove_fits
from calibration.study.run import fit_task
from tisim.laws import _registry

HEADER = {"format": 2, "seed": 1}


def store(folder: Path) -> FitStore:
    return FitStore(folder, "S0-neo-hookean", HEADER)


def generation(index: int) -> Generation:
    return Generation(
        restart=0,
        index=index,
        candidates=np.array([[1.0, 2.0], [3.0, 4.0]]),
        costs=np.array([5.0, np.inf]),
        replayed=False,
    )


def test_what_is_written_is_read(tmp_path: Path) -> None:
    for index in range(3):
        store(tmp_path).append(generation(index))
    found = store(tmp_path).history()
    assert [g.index for g in found] == [0, 1, 2]
    assert found[0].costs.tolist() == [5.0, np.inf]


GOOD = '{"format": 2, "seed": 1}\n'
LINE = '{"restart": 0, "index": 0, "candidates": [[1.0, 2.0]], "costs": [3.0]}\n'


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("garbage\n", 1),
        ("[]\n", None),
        ("null\n", None),
        (GOOD + "garbage\n", 2),
        (GOOD + LINE + "{}\n", 3),
        (GOOD + "[1, 2]\n", 2),
        (GOOD + LINE.replace("[3.0]", "[3.0, 4.0]"), 2),
        (GOOD + LINE.replace("[3.0]", '["three"]'), 2),
        (GOOD + LINE.replace("[3.0]", "[NaN]"), 2),
        (GOOD + LINE.replace("[[1.0, 2.0]]", "[[1.0], [2.0, 3.0]]"), 2),
        (GOOD + LINE.replace("[[1.0, 2.0]]", "7"), 2),
        (GOOD + LINE.replace("2.0", "Infinity"), 2),
        (GOOD + "[" * 100_000 + "\n", 2),
    ],
)
def test_a_damaged_history_is_refused_and_kept(tmp_path: Path, text: str, line: int | None) -> None:
    path = store(tmp_path).history_path
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        store(tmp_path).history()
    assert str(caught.value).startswith(f"{path}: " + (f"line {line}: damaged" if line else "damaged"))
    assert "--overwrite" in str(caught.value)
    assert path.read_text() == text


def test_bytes_that_are_no_text(tmp_path: Path) -> None:
    store(tmp_path).history_path.write_bytes(b"\xff\xfe\x00garbage\n")
    store(tmp_path).result_path.write_bytes(b"\xff\xfe\x00garbage\n")
    with pytest.raises(InputError, match="damaged"):
        store(tmp_path).history()
    with pytest.raises(InputError, match="damaged"):
        store(tmp_path).result()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "garbage",
        "null",
        "[]",
        "{}",
        '{"header": {}, "calibration": 7}',
        '{"header": 3, "calibration": {}}',
        "[" * 100_000,
    ],
)
def test_a_damaged_result_is_refused(tmp_path: Path, text: str) -> None:
    store(tmp_path).result_path.write_text(text)
    with pytest.raises(InputError, match=r"damaged, expected a fit that calibration\.fit wrote"):
        store(tmp_path).result()


def test_a_line_cut_short_by_a_kill_is_dropped(tmp_path: Path) -> None:
    path = store(tmp_path).history_path
    path.write_text(GOOD + LINE + '{"restart": 0, "ind')
    assert len(store(tmp_path).history()) == 1
    assert path.read_text() == GOOD + LINE


def test_a_result_of_an_earlier_version_is_assessed() -> None:
    """The file states no lack of fit, but its reduced chi-square shows one."""
    old = Calibration(
        material="S0",
        law="neo-hookean",
        label="neo-hookean",
        status="converged",
        message="",
        density=None,
        u=(10.0, 5.7),
        parameters={"mu": 2e4, "lam": 6e6},
        shear_modulus=2e4,
        points=100,
        chi2=12_600.0,
        reduced_chi2=126.0,
    )
    data = old.to_json()
    del data["lacking"], data["unsettled"]
    found = Calibration.from_json(data)
    assert found.status == "lack of fit"
    assert "reduced chi-square 126" in found.message
    assert "calibration.diagnose" in found.message
    again = Calibration.from_json(found.to_json())
    assert again.to_json() == found.to_json()


def test_one_process_at_a_time(tmp_path: Path) -> None:
    store(tmp_path).append(generation(0))
    with locked(tmp_path):
        with pytest.raises(InputError, match="another calibration is at work here"), locked(tmp_path):
            pass
        with pytest.raises(InputError, match="another calibration is at work here"):
            remove_fits(tmp_path, {"S0-neo-hookean"})
    assert len(store(tmp_path).history()) == 1
    remove_fits(tmp_path, {"S0-neo-hookean"})
    assert not store(tmp_path).history_path.exists()
    with locked(tmp_path):
        pass


def test_overwriting_removes_fits_alone(tmp_path: Path) -> None:
    """Whole, unfinished and damaged fits of this plan go; others, and what a lab keeps beside them, stay."""
    store(tmp_path).append(generation(0))
    (tmp_path / "S1-ogden.json").write_text('{"header": {}, "calibration": {}}')
    (tmp_path / "S2-ogden.json").write_text('{"header": ')
    (tmp_path / "S2-ogden.json.part").write_text("")
    (tmp_path / "S3-ogden.json").write_text('{"header": {}, "calibration": {}}')
    kept = ["S3-ogden.json", "notes.txt", "raw.csv", "settings.json", "thesis"]
    (tmp_path / "notes.txt").write_text("x")
    (tmp_path / "raw.csv").write_text("1,2")
    (tmp_path / "settings.json").write_text('{"camera": 1}')
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.tex").write_text("x")
    remove_fits(tmp_path, {"S0-neo-hookean", "S1-ogden", "S2-ogden"})
    assert sorted(p.name for p in tmp_path.iterdir() if p.name != ".lock") == kept
    assert (tmp_path / "thesis" / "chapter.tex").exists()


def test_an_option_that_is_left_out_now_is_another_fit(tmp_path: Path) -> None:
    FitStore(tmp_path, "S0-neo-hookean", HEADER | {"free_bulk_ratio": True}).append(generation(0))
    with pytest.raises(InputError, match="made with another free_bulk_ratio; expected the same to go on"):
        store(tmp_path).history()
    moved = FitStore(tmp_path, "S1-neo-hookean", HEADER | {"rig": "abc", "rig_file": "rig.yaml"})
    moved.append(generation(0))
    again = FitStore(tmp_path, "S1-neo-hookean", HEADER | {"rig": "abc", "rig_file": "copy/rig.yaml"})
    assert len(again.history()) == 1
    begun = HEADER | {"card": {"viscosity": {"kind": "prony", "fractions": [0.3], "times_s": [2.0]}}}
    FitStore(tmp_path, "S2-neo-hookean", begun | {"start": "/a/S2.yaml"}).append(generation(0))
    assert len(FitStore(tmp_path, "S2-neo-hookean", begun | {"start": "/b/S2.yaml"}).history()) == 1
    with pytest.raises(InputError, match="made with another card;"):
        FitStore(tmp_path, "S2-neo-hookean", HEADER | {"card": {}, "start": "/a/S2.yaml"}).history()


LAW = """
from dataclasses import replace
from tisim import laws

def pack(p):
    return [FACTOR * p["mu"], p["stiffening"]]

laws.register(replace(laws.get("yeoh"), name="yeoh-of-ones-own", pack=pack))
"""


def test_a_law_of_ones_own_that_has_changed_is_another_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_registry, "_ADDED", {})
    table = {"stretch": np.linspace(1.0, 1.5, 8), "nominal_stress_kPa": np.linspace(0.0, 9.0, 8)}
    own = read(write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table}))
    (material,) = {t.material for t in own.trials}
    codes = []
    for folder, factor in (("a", 1.0), ("b", 1.0), ("b", 2.0)):
        path = tmp_path / folder / "own.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(LAW.replace("FACTOR", str(factor)))
        linecache.checkcache()
        runpy.run_path(str(path))
        (task,) = tasks_for(
            own, law_names=["yeoh-of-ones-own"], materials=[material], folder=tmp_path / "fits"
        )
        codes.append(task.store().header["code"])
    assert codes[0] == codes[1] != codes[2]
    (task,) = tasks_for(own, law_names=["ogden"], materials=[material], folder=tmp_path / "fits")
    assert "code" not in task.store().header


def test_a_choice_that_was_stopped_is_not_made(tmp_path: Path) -> None:
    """Of the numbers of Prony terms one has ended: it is the best so far, and no fit."""
    table = {
        "time_s": np.linspace(0.0, 60.0, 40),
        "stretch": np.interp(np.linspace(0.0, 60.0, 40), [0.0, 2.0, 60.0], [1.0, 1.2, 1.2]),
        "nominal_stress_kPa": np.linspace(0.0, 9.0, 40),
    }
    own = read(write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table}))
    (task,) = tasks_for(
        own, law_names=["neo-hookean"], materials=["S0"], folder=tmp_path / "fits", specs=("prony",)
    )
    (tmp_path / "fits").mkdir()
    one, *others = task.alternatives
    ended = Calibration(
        material="S0", law="neo-hookean", label=one.label, status="converged", message="", density=None,
        u=(10.0, 5.7, -1.0, 1.0), parameters={"mu": 2e4, "lam": 6e6}, shear_modulus=2e4,
        points=40, chi2=30.0, reduced_chi2=0.8, parts=one.parts,
    )  # fmt: skip
    one.store().finish(ended)
    (found,) = stopped([task], own)
    assert found.status == "stopped"
    assert found.message == f"the best so far: {', '.join(o.label for o in others)} had not ended"
    for other in others:
        other.store().finish(replace(ended, label=other.label, chi2=31.0, parts=other.parts))
    (found,) = stopped([task], own)
    assert (found.status, found.label) == ("converged", one.label)
    # what was asked for is kept beside what the data chose
    assert (found.parts, found.asked) == (one.parts, ("prony",))
    assert fit_task(task, workers=1).asked == ("prony",)
    kept = task.store().result()
    assert kept is not None
    assert (kept.parts, kept.asked) == (one.parts, ("prony",))


def test_a_stopped_search_whose_best_has_no_answer_any_more_tells_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C wrote a traceback and no report of the other fits."""
    table = {"stretch": np.linspace(1.0, 1.5, 8), "nominal_stress_kPa": np.linspace(0.0, 9.0, 8)}
    own = read(write_experiment(tmp_path / "data", [coupon_entry("pull", "a.csv")], tables={"a.csv": table}))
    (task,) = tasks_for(own, law_names=["neo-hookean"], materials=["S0"], folder=tmp_path / "fits")
    (tmp_path / "fits").mkdir()
    law = parametrisation("neo-hookean")
    middle = law.bounds.mean(axis=1)
    task.store().append(replace(generation(0), candidates=np.stack([middle, middle])))
    (found,) = stopped([task], own)
    assert found.status == "stopped"
    monkeypatch.setattr(Problem, "linearise", lambda *_, **__: False)
    assert stopped([task], own) == []
