"""The runner of beams with an invented diagnosis: its calls per case, and continuation after failures."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import yaml

from benchmarks.blind.beams import run as run_beams
from benchmarks.blind.beams.store import SURVEY, load_truth
from benchmarks.blind.under_test import Diagnoser, NotDiagnosedError, catalogue

TRUTH = load_truth(SURVEY)["cases"]
LARGE = next(k for k, c in TRUTH.items() if c["category"] == "single" and c["sigma"]["total"] >= 10)
EFFECT = TRUTH[LARGE]["hidden"][0]["effect"]
ALL = ["--given-cause", "--advice", "--control", "without-truth", "--control", "shuffled"]


class MadeUp:
    """Diagnosis that names the truth of LARGE, and an alternative that weighing refutes."""

    asked: list[tuple[tuple[str, ...], bool, bool]]  # without, gain, True if the beams were weighed
    broken = False

    def __init__(self, **_: Any) -> None:
        pass

    def __call__(self, folder: Path, *, without: Iterable[str] = (), gain: bool = False) -> dict[str, Any]:
        if MadeUp.broken:
            raise NotDiagnosedError("exit code 1: broken")
        materials = yaml.safe_load((folder / "experiment.yaml").read_text())["materials"]
        weighed = materials["S0"]["density_sd_kg_m3"] == 2.0
        MadeUp.asked.append((tuple(without), gain, weighed))
        names = [n for n in (EFFECT, "added-mass") if n not in tuple(without)]
        causes: list[dict[str, Any]] = [
            {"effect": name, "scope": "all", "parameters": {}} for name in names[:1]
        ]
        return {
            "verdict": ("unexplained", "found", "ambiguous")[len(names)],
            "causes": causes,
            "alternatives": [[n] for n in names],
            "next_experiment": "weigh the specimens: they part there by 9 standard deviations",
            "gain": {"rms_mm_before": 0.2, "rms_mm_after": 0.1, "rms_mm_noise": 0.08} if gain else None,
            "seconds": 1.0,
        }


@pytest.fixture(autouse=True)
def _made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    MadeUp.asked, MadeUp.broken = [], False
    monkeypatch.setattr(run_beams, "Diagnoser", MadeUp)


def run(out: Path, *options: str) -> int:
    return run_beams.main(["--cases", str(SURVEY), "--out", str(out), "--only", LARGE, *options])


def test_each_question_is_asked_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, *ALL) == 0
    others = tuple(n for n in catalogue() if n != EFFECT)
    verdict, true_cause, advised, without, shuffled = MadeUp.asked
    assert verdict == ((), True, False)
    assert true_cause == (others, True, False)
    assert advised == (("added-mass", "density"), False, True)  # refuted, and added to the experiment
    assert without == ((EFFECT,), False, False)
    assert shuffled == ((), False, False)
    assert run(tmp_path, *ALL) == 0
    assert len(MadeUp.asked) == 5
    rows = [line for line in capsys.readouterr().out.splitlines() if "advised experiment made" in line]
    assert all("1 of    1" in row for row in rows)


def test_gain_can_be_left_away(tmp_path: Path) -> None:
    run(tmp_path / "a", "--no-gain")
    run(tmp_path / "b", "--gain-from", "1000")
    assert [gain for _, gain, _ in MadeUp.asked] == [False, False]


def test_several_cases_at_once_fail_by_themselves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each case runs in its own process, here with a command that fails at once without a message."""
    monkeypatch.setattr(run_beams, "Diagnoser", partial(Diagnoser, command=(sys.executable, "-c", "exit(1)")))
    assert run(tmp_path, "--jobs", "2", "--only", "0,1") == 1
    assert "2 not diagnosed: 000 (verdicts), 001 (verdicts)" in capsys.readouterr().out


def test_what_failed_is_said_and_asked_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    MadeUp.broken = True
    assert run(tmp_path) == 1
    assert "1 not diagnosed" in capsys.readouterr().out
    MadeUp.broken = False
    assert run(tmp_path) == 0
    assert len(MadeUp.asked) == 1


def test_a_case_that_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_beams.main(["--cases", str(SURVEY), "--out", str(tmp_path), "--only", "999"]) == 2
    assert "no case 999" in capsys.readouterr().err
