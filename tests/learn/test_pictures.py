"""Figures are drawn without pyplot: a notebook keeps its backend and shows a figure once."""

from __future__ import annotations

import base64
import runpy

import matplotlib
import pytest

from learn.evaluation import pictures


def test_a_notebooks_backend_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(matplotlib.rcParams, "backend", "svg")
    module = runpy.run_path(str(pictures.__file__))
    figure = module["draw_learning"]({"run": [{"epoch": 0, "train_loss": 1.0}]})
    assert base64.b64decode(module["encoded"](figure)).startswith(b"\x89PNG")
    assert matplotlib.rcParams["backend"] == "svg"
    assert not hasattr(figure, "number")  # pyplot numbers the figures that it shows
