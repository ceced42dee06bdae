"""Figures of beams: the drawn values are the fitted ones, and the extension passes through the points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bent_beams import bent_folder
from html_page import Page

from calibration.diagnosis import Diagnosis, Rules, diagnose
from calibration.diagnosis.drawing import figures_of
from calibration.diagnosis.drawing.outlines._drawn import DrawnTrial, drawn, explained_photographs, rms_of
from calibration.diagnosis.drawing.outlines._grid import grid_of
from calibration.diagnosis.drawing.outlines._look import magnification
from calibration.diagnosis.drawing.outlines._residuals import middles
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.diagnosis.report import write_report
from calibration.experiment import read
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.turned import turned

LEFT = ("residual-curvature", "creep")  # a part of the catalogue, for speed
ODD = "a_long(%)-" + 60 * "x"


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> tuple[Diagnosis, OutlineModel]:
    folder = bent_folder(tmp_path_factory.mktemp("bent") / "x", curvature=3.0, name=ODD)
    model = OutlineModel(read(folder), effects={n: e for n, e in EFFECTS.items() if n in LEFT}, workers=1)
    # an elastica differs from a thick beam by more than noise, which does not matter here
    return diagnose(model, rules=Rules(lack_of_fit_level=0.0), gain=False), model


@pytest.fixture(scope="module")
def beams(bent: tuple[Diagnosis, OutlineModel]) -> list[DrawnTrial]:
    return drawn(bent[1], bent[0], explained_photographs(bent[1], bent[0]))


def test_the_case_is_what_it_should_be(bent: tuple[Diagnosis, OutlineModel]) -> None:
    found = bent[0]
    assert found.finding.chosen is not None
    assert found.finding.chosen.names == ("residual-curvature",)


def test_rms_is_the_models(bent: tuple[Diagnosis, OutlineModel], beams: list[DrawnTrial]) -> None:
    found, model = bent
    assert found.extended is not None
    photographs = [p for b in beams for p in b.photographs]
    assert len(photographs) == 4
    assert 1e3 * rms_of(photographs, "after") == pytest.approx(found.extended.rms)
    base = model.distance_rms(found.finding.baseline.state)
    assert rms_of(photographs, "before") == pytest.approx(base)
    assert rms_of(photographs, "after") < 0.7 * base


def test_the_extension_is_drawn_where_the_points_are(beams: list[DrawnTrial]) -> None:
    for b in beams:
        for e in (e for p in b.photographs for e in p.edges):
            assert e.smooth_after is not None
            drawn_line = e.smooth_before - e.smooth_after
            far = np.abs(drawn_line) > 2e-4
            # far from the baseline both lie on the same side of it
            assert np.all(np.sign(drawn_line[far]) == np.sign(e.smooth_before[far]))
            assert np.allclose(np.linalg.norm(e.normal, axis=1), 1.0)


def test_a_beam_bent_upwards_departs_upwards_at_its_tip(beams: list[DrawnTrial]) -> None:
    for b in beams:
        line = middles(b).before.mean(axis=0)
        assert line[-1] > 1e-4
        assert line[len(line) // 2] < -1e-4
        assert all(np.all(e.normal[:, 1] > 0.0) for p in b.photographs for e in p.edges)


def test_photographs_are_averaged_and_their_noise_falls(beams: list[DrawnTrial]) -> None:
    lines = middles(beams[0])
    assert lines.before.shape[0] == len(beams[0].photographs) == 2
    one = beams[0].photographs[0].upper.smooth_sd
    assert 0.4 < lines.sd.mean() / one.mean() < 0.6  # two photographs of two edges
    assert lines.after is not None
    assert np.abs(lines.after).mean() < np.abs(lines.before).mean()


def test_the_magnification_keeps_edges_apart(beams: list[DrawnTrial]) -> None:
    factor = magnification(beams)
    largest = max(b.largest for b in beams)
    assert factor >= 1.0
    assert factor * largest < 0.010 or factor == 1.0


def test_panels_are_a_grid_of_materials_and_kinds(beams: list[DrawnTrial]) -> None:
    grid, missing = grid_of(beams)
    assert missing == 0
    assert [[b and b.kind for b in row] for row in grid] == [["cantilever 60 mm", "cantilever 100 mm"]]


def test_the_beams_can_be_turned_around(bent: tuple[Diagnosis, OutlineModel]) -> None:
    """The outline is a tube about its registered points, on the surface of the extension's body."""
    found, model = bent
    seen = explained_photographs(model, found)
    view = turned(seen, title="bent")
    assert len(view.labels) == len(seen) == 4
    bodies, tubes = view.surfaces[0::2], view.surfaces[1::2]
    for frame, (s, body, tube) in enumerate(zip(seen, bodies, tubes, strict=True)):
        assert body.frame == tube.frame == frame
        nearest = np.concatenate([f.nearest for f in s.projections])
        normal = np.concatenate([f.normal for f in s.projections])
        wanted = nearest + s.left[:, None] * normal
        centres = tube.positions[0].reshape(-1, 6, 3).mean(axis=1)
        assert np.allclose(centres[:, 1], 0.0, atol=1e-12)
        if len(centres) == len(wanted):  # short edges keep all points
            assert centres[:, [0, 2]] == pytest.approx(wanted, abs=1e-9)
        middle = body.positions[0][np.abs(body.positions[0][:, 1]) < 1e-6]
        gap = np.linalg.norm(centres[:, None, [0, 2]] - middle[None, :, [0, 2]], axis=2).min(axis=1)
        assert gap.max() < 0.006  # between the nodes of a mesh of 7 mm
        assert np.abs(body.positions[0][:, 1]).max() == pytest.approx(0.010, rel=0.05)


def test_the_page_has_them(bent: tuple[Diagnosis, OutlineModel], tmp_path: Path) -> None:
    paths = write_report(*bent, tmp_path, title="bent")
    assert [p.name for p in paths] == [
        "report.html",
        "evidence.png",
        "shapes.png",
        "residuals.png",
        "rms.png",
    ]
    page = Page(paths[0])
    assert len(page.sources) == 4
    assert page.raw.count('<section class="tisim-view"') == 1
    assert "Measured outlines over the beams of the baseline extended by residual-curvature" in page.text
    assert "correlated over 5.0 mm" in page.text
    assert "The mesh's error is corrected by a finer mesh" in page.text
    shown = next(f for f in figures_of(bent[1], bent[0]) if f.name == "shapes")
    assert "times magnified" in shown.caption
