"""The loaders' benchmark runs and has a row for every layout; latencies of a run are timed."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest
import torch

from learn import benchmark
from learn.benchmark import latencies
from learn.data import open_store
from learn.data._format import RIGID
from learn.training import Recipe, Trainer, load_run
from tests.learn.small_store import leave_out, write_store

SCRIPT = Path(__file__).parent.parent.parent / "benchmarks" / "loader_throughput.py"


def test_the_loaders_benchmark_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), "--frames", "300"])
    names = [layout[0] for layout in runpy.run_path(str(SCRIPT), run_name="__main__")["LAYOUTS"]]
    shown = capsys.readouterr().out
    assert [name for name in names if name not in shown] == []


def test_latencies_of_a_run_on_a_part_of_a_dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first level of the store of a stopped build may have no poke."""
    folder = write_store(tmp_path / "s.zarr", shapes=4, sites=1, frames=2)
    leave_out(folder, [0, 2, 4, 6])
    store = open_store(folder)
    recipe = Recipe(name="tiny", model="invariant-gnn-small", epochs=1, batch=8, point_dropout=0.0)
    Trainer(store, recipe, tmp_path / "run").train()
    before = torch.get_num_threads()
    found = latencies(load_run(tmp_path / "run"), store, 3)
    assert [name for name, threads, *_ in found if threads == "1"] == [
        "invariant-gnn-small, one at a time",
        "invariant-gnn-small, in real time with intervals",
        "invariant-gnn-small, in real time with intervals, first of a contact",
        "invariant-gnn-small, as a batch of one",
        "invariant-gnn-small, 8 at once, each",
    ]
    assert all(0.0 < best <= median for *_, median, best in found)
    assert torch.get_num_threads() == before
    monkeypatch.setattr(benchmark, "THREADS", (1,))
    monkeypatch.setattr(benchmark, "DEEPEST", 0.03)
    store.profile[..., 2:] = RIGID  # half a millimetre of cover: the timed pokes do not go into the inclusion
    assert len(latencies(load_run(tmp_path / "run"), store, 3)) == len(found) / 2
