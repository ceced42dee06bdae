"""Predictions at own points of the top face: placed in the grid, read from a file, written beside it."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import torch

import learn
import learn.predict
from learn.data import Setup
from learn.errors import InputError
from learn.models import Pokes, Response, Scene
from learn.models.at_points import place, respond_at
from learn.points_file import load_points
from learn.predictor import Predictor
from tests.learn.commands import call, refused, train_small
from tests.learn.small_store import write_store
from tests.learn.test_real_time import WIDTHS

POKE = {"site_mm": [5, -10], "depth_mm": 1.5, "shape": "shape-1", "softness": "S1"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("at-points")
    store = write_store(folder / "s.zarr", shapes=3, sites=3, frames=3)
    return train_small(store, folder / "run", "--epochs", 1)


@pytest.fixture(scope="module")
def predictor(run: Path) -> Predictor:
    found = learn.load(run)
    found.intervals = WIDTHS
    return found


def _anywhere(setup: Setup, count: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    half = np.array(setup.block_size[:2]) / 2
    xy = setup.middle + np.random.default_rng(3).uniform(-half, half, (count, 2))
    xy[:4] = setup.middle + half * [[1, 1], [-1, 1], [1, -1], [-1, -1]]  # the corners of the face
    return np.column_stack([xy, np.full(count, setup.top)])


def test_each_point_takes_the_place_of_the_grids_point_of_its_cell(predictor: Predictor) -> None:
    setup = predictor.store.setup
    points = np.concatenate([_anywhere(setup, 3000), setup.points[[7, 500]]])
    placed = place(setup, points)
    np.testing.assert_array_equal(placed.pick([c[None] for c in placed.clouds])[0], points)
    assert (placed.cloud[-2:] == 0).all()
    cell = np.array(setup.block_size[:2]) / 32
    for k, cloud in enumerate(placed.clouds):
        assert cloud.shape == setup.points.shape
        assert (np.abs(cloud - setup.points)[:, :2] <= cell / 2 + 1e-12).all()
        moved = np.flatnonzero((cloud != setup.points).any(axis=1))
        assert sorted(placed.index[placed.cloud == k]) == (moved.tolist() if k else [7, 500])
    fullest = np.unique(placed.index[placed.cloud > 0], return_counts=True)[1].max()
    assert len(placed.clouds) == 1 + fullest > 5


def test_points_of_the_grid_are_answered_as_the_grid(predictor: Predictor) -> None:
    some = [40, 3, 700]
    answer = predictor.predict(POKE, points=predictor.store.setup.points[some, :2])
    assert answer.asked is not None
    np.testing.assert_array_equal(answer.asked.displacement, answer.displacement[some])
    np.testing.assert_allclose(answer.asked.radius, answer.radius[some], rtol=1e-12)
    plain = predictor.predict(POKE)
    assert (plain.asked, plain.force) == (None, answer.force)
    marked, unmarked = (
        [line for line in one.picture().axes[1].lines if line.get_label() == "points asked for"]
        for one in (answer, plain)
    )
    np.testing.assert_allclose(
        marked[0].get_xydata(), 1e3 * predictor.store.setup.points[some, :2], atol=1e-12
    )
    assert not unmarked


def test_several_points_of_a_cell_are_answered_one_by_one(predictor: Predictor) -> None:
    """The answer at a point is that of a cloud in which it alone of its cell replaces the grid's."""
    setup = predictor.store.setup
    near = setup.points[300, :2] + 1e-3 * np.array([[0.4, 0.3], [-0.5, 0.2], [0.1, -0.6]])
    together = predictor.predict(POKE, points=near)
    assert together.asked is not None
    for k in range(3):
        alone = predictor.predict(POKE, points=near[k : k + 1])
        assert alone.asked is not None
        np.testing.assert_allclose(alone.asked.displacement[0], together.asked.displacement[k], atol=1e-9)
    assert np.ptp(together.asked.displacement, axis=0).max() > 1e-6


class _Field(torch.nn.Module):
    """In place of a network: a field that is known anywhere."""

    def forward(self, scene: Scene, pokes: Pokes) -> Response:
        u = torch.stack([scene.points[:, 1], scene.points[:, 0] ** 2, scene.area], dim=1)
        return Response(displacement=u.float()[None] * pokes.depth[0], force=pokes.depth)


def test_displacements_are_those_of_the_points_themselves(predictor: Predictor) -> None:
    setup, answer = predictor.store.setup, predictor.predict(POKE)
    points = _anywhere(setup, 200)
    found = respond_at(_Field(), setup, answer.scene, answer.pokes, points)  # type: ignore[arg-type]
    u = found.displacement[0].numpy() / 1.5e-3
    np.testing.assert_allclose(u[:, 0], points[:, 1], atol=1e-8)
    np.testing.assert_allclose(u[:, 1], points[:, 0] ** 2, atol=1e-8)
    # clouds remain as dense as the grid around each of its points
    assert (np.abs(u[4:, 2] - 1) < 0.5).mean() > 0.8


@pytest.mark.usefixtures("unrendered")
def test_a_file_of_markers_gives_a_file_of_their_displacement(run: Path, tmp_path: Path) -> None:
    scene, out = tmp_path / "poke.yaml", tmp_path / "out"
    scene.write_text("site_mm: [5, -10]\ndepth_mm: 1.5\nshape: shape-1\nsoftness: S1\n")
    markers = tmp_path / "markers.csv"
    markers.write_text('\ufeffid,x_mm,y_mm\n"left, upper",-12.5,10\nb,3,-9.25\n\n')
    done = call(learn.predict.app, run, scene, "--points", markers, "--out", out)
    assert done.exit_code == 0, done.output
    assert "points.csv" in done.output
    with (out / "points.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["id"] for row in rows] == ["left, upper", "b"]
    assert [float(row["x_mm"]) for row in rows] == [-12.5, 3.0]
    asked = learn.load(run).predict(scene, points=np.array([[-12.5e-3, 10e-3], [3e-3, -9.25e-3]])).asked
    assert asked is not None
    for row, u in zip(rows, asked.displacement, strict=True):
        assert [float(row[f"u{c}_mm"]) for c in "xyz"] == pytest.approx(1e3 * u, rel=1e-4, abs=1e-9)
    # a prediction without points leaves none of an earlier one
    assert call(learn.predict.app, run, scene, "--out", out).exit_code == 0
    assert not (out / "points.csv").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x_mm,z_mm\n1,2\n", ("columns x_mm, y_mm", "got x_mm, z_mm")),
        ("", ("got nothing",)),
        ("x_mm,y_mm\n", ("one point or more",)),
        ("x_mm;y_mm\n1;2\n", ("separated by commas",)),
        ("x_mm,y_mm\n1,2\n1,2,3\n", ("line 3", "expected 2 columns, got 3")),
        ("x_mm,y_mm\n1,nan\n", ("line 2", "column y_mm", "'nan'")),
        ("x_mm,y_mm,x_mm\n1,2,3\n", ("columns x_mm, y_mm",)),
        ("id,x_mm,y_mm\na,1,2\nb,2,2\na,3,2\n", ("line 4", "column id", "another name", "'a' twice")),
        ("id,x_mm,y_mm\na,1,2\n,2,2\n", ("line 3", "column id: expected a name, got none")),
        ("id,x_mm,y_mm\nfar,0.1,51\n", ("point far", "top face, x -50 to 50 mm", "(0.1, 51) mm")),
    ],
)
def test_a_wrong_file_of_points_is_one_sentence(
    run: Path, tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    scene, file = tmp_path / "poke.yaml", tmp_path / "points.csv"
    scene.write_text("site_mm: [5, -10]\ndepth_mm: 1.5\nshape: shape-1\nsoftness: S1\n")
    file.write_text(text)
    done = call(learn.predict.app, run, scene, "--points", file, "--out", tmp_path / "out")
    refused(done, "points.csv", *words)
    assert not (tmp_path / "out").exists()


def test_wrong_arrays_and_missing_files_are_one_sentence(predictor: Predictor, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"shape \(n, 2\), got \(3,\)"):
        predictor.predict(POKE, points=np.zeros(3))
    with pytest.raises(InputError, match="point 2: expected on the top face"):
        predictor.predict(POKE, points=np.array([[0.0, 0.0], [np.nan, 0.0]]))
    with pytest.raises(InputError, match="expected a CSV file of points, this is a folder"):
        load_points(tmp_path)
    with pytest.raises(InputError, match="expected a CSV file of points, there is none"):
        load_points(tmp_path / "markers.csv")
    (tmp_path / "latin.csv").write_bytes("x_mm,y_mm,\xe4\n".encode("latin-1"))
    with pytest.raises(InputError, match="UTF-8"):
        load_points(tmp_path / "latin.csv")
