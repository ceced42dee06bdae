"""A user's metric, registered from outside the package: one object, one call."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import trimesh

from calibration import metrics
from calibration.study.paper_table import Measures, Row, averages
from calibration.study.paper_table_files import write_csv, write_markdown

SHIFT = metrics.Metric(
    name="centroid_shift",
    title="shift of the centroid",
    unit="m",
    higher_is_better=False,
    compute=lambda a, b: float(np.linalg.norm(a.centroid - b.centroid)),
)


@pytest.fixture(autouse=True)
def _registered() -> Iterator[None]:
    metrics.register(SHIFT)
    yield
    metrics.unregister(SHIFT.name)


def test_compare_computes_it() -> None:
    box = trimesh.creation.box((0.02, 0.02, 0.10))
    found = metrics.compare(box, box.copy().apply_translation((0.003, 0.004, 0.0)))
    assert list(found) == ["surface_distance", "hd95", "dice", "volume_difference", "centroid_shift"]
    assert found["centroid_shift"] == pytest.approx(0.005)
    assert metrics.METRICS["centroid_shift"] is SHIFT


def row(material: str, shift: float) -> Row:
    measures = Measures(
        surface_distance=1e-3,
        hd95=2e-3,
        dice=0.9,
        volume_difference=0.01,
        node_distance=3e-3,
        node_hd95=4e-3,
        beam_seconds=1.0,
        further={"centroid_shift": shift},
    )
    return Row(
        law="ogden",
        material=material,
        mixture=material,
        status="converged",
        message="",
        measures=measures,
        paper=None,
    )


def test_the_table_has_a_column_of_it(tmp_path: Path) -> None:
    rows = [row("S0", 0.001), row("S1", 0.003)]
    rows += averages(rows)
    write_csv(tmp_path / "t.csv", rows)
    write_markdown(tmp_path / "t.md", rows, command="x", source="y")
    read = list(csv.DictReader((tmp_path / "t.csv").read_text().splitlines()))
    assert [float(r["centroid_shift"]) for r in read] == [0.001, 0.003, pytest.approx(0.002)]
    assert "| shift of the centroid / m |" in (tmp_path / "t.md").read_text()


def test_a_name_is_taken_once() -> None:
    with pytest.raises(ValueError, match="centroid_shift' is registered already"):
        metrics.register(SHIFT)
    with pytest.raises(ValueError, match="Python name"):
        metrics.register(
            metrics.Metric(name="a b", title="", unit="1", higher_is_better=True, compute=metrics.dice)
        )
    with pytest.raises(TypeError):
        metrics.METRICS["mine"] = SHIFT  # type: ignore[index]
