"""The loaders' benchmark runs and has a row for every layout."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parent.parent.parent / "benchmarks" / "loader_throughput.py"


def test_the_loaders_benchmark_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), "--frames", "300"])
    names = [layout[0] for layout in runpy.run_path(str(SCRIPT), run_name="__main__")["LAYOUTS"]]
    shown = capsys.readouterr().out
    assert [name for name in names if name not in shown] == []
