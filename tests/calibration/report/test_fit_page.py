"""The page of `calibration.fit` for one beam: figures equal the JSON file's, pictures are embedded."""

from __future__ import annotations

import base64
import json
import re
import shlex
from pathlib import Path

import pytest
from html_page import Page
from report_cases import beam_folder
from typer.testing import CliRunner

from calibration.experiment import read
from calibration.fit import app
from calibration.report._draw_outlines import contours
from calibration.study import Calibration, measurements


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Experiment and results of a short fit."""
    folder = tmp_path_factory.mktemp("page")
    experiment, out = beam_folder(folder / "experiment"), folder / "out"
    words = [str(experiment), "--model", "neo-hookean", "--generations", "6", "--seed", "3", "--workers", "1"]
    ended = CliRunner().invoke(app, [*words, "--out", str(out)])
    assert ended.exit_code in (0, 1), ended.output
    return experiment, out


@pytest.fixture(scope="module")
def result(study: tuple[Path, Path]) -> Calibration:
    data = json.loads((study[1] / "fits" / "S1-neo-hookean.json").read_text(encoding="utf-8"))
    return Calibration.from_json(data["calibration"])


@pytest.fixture(scope="module")
def page(study: tuple[Path, Path]) -> Page:
    return Page(study[1] / "report.html")


def test_figures_are_those_of_the_json(page: Page, result: Calibration) -> None:
    for value in (result.shear_modulus, result.reduced_chi2, result.rms, result.candidates):
        assert value in page.values
    row = page.row("neo-hookean")
    modulus, sd = row[2].split(" ± ")
    assert float(modulus) == pytest.approx(result.shear_modulus / 1e3, abs=0.5 * 10.0 ** -_places(modulus))
    assert float(sd) == pytest.approx(result.shear_modulus_sd / 1e3, rel=0.5)
    assert result.rms is not None
    assert float(row[7]) == pytest.approx(1e3 * result.rms, abs=0.0005)
    # the synthetic beams are no elastica: the headline states a lack of fit
    assert page.text.count(f"Until then: {row[2]} kPa by neo-hookean") == 1
    assert "python -m calibration.diagnose" in page.text


def test_the_fit_found_the_elastica(result: Calibration) -> None:
    # a beam of 2.5 diameters deflects more than an elastica, so the fit has a larger modulus
    assert 10e3 < result.shear_modulus < 15e3


def test_pictures_are_inside_the_page_and_beside_it(study: tuple[Path, Path], page: Page) -> None:
    inside = [base64.b64decode(s.removeprefix("data:image/png;base64,")) for s in page.sources]
    files = {p.name: p.read_bytes() for p in (study[1] / "pictures").iterdir()}
    assert sorted(files) == ["S1-parameters.png", "S1-residuals.png", "beam-hanging.png"]
    assert sorted(inside) == sorted(files.values())
    assert all(png.startswith(b"\x89PNG") and len(png) > 5000 for png in inside)


def test_the_page_needs_nothing_beside_it(page: Page) -> None:
    assert "http:" not in page.raw
    assert "https:" not in page.raw
    assert all(s.startswith("data:image/png;base64,") for s in page.sources)
    assert all(link.startswith("#") for link in page.links)
    assert not page.tags & {"link", "iframe"}


def test_the_beam_can_be_turned_around(page: Page) -> None:
    """There is one view, with the rms of the table; its script is in the page."""
    assert page.raw.count('<section class="tisim-view"') == 1
    assert page.raw.count("getContext") == 1
    label = re.search(r"hanging at [\d.]+ s · outline from body: ([\d.]+) mm rms, registered", page.raw)
    assert label is not None
    assert float(label[1]) == pytest.approx(float(page.row("neo-hookean")[7]), rel=0.06)


def test_what_is_drawn_is_what_was_fitted(study: tuple[Path, Path], result: Calibration) -> None:
    outlines = measurements(read(study[0]), "S1", result.parametrisation, workers=1).outlines
    assert outlines is not None
    drawn = contours(outlines, result)
    assert drawn is not None
    assert drawn.rms == pytest.approx(result.rms, rel=0.02)
    (photograph,) = drawn.photographs
    assert photograph.rms[1] == pytest.approx(drawn.rms)
    assert photograph.rms[0] > photograph.rms[1]
    assert set(drawn.simulated) == {"hanging"}


def test_data_command_and_what_was_not_used(study: tuple[Path, Path], page: Page) -> None:
    experiment, out = study
    assert read(experiment).digest in page.text
    words = shlex.split(page.raw.rpartition("<pre>")[2].partition("</pre>")[0])
    assert words[:4] == ["python", "-m", "calibration.fit", str(experiment)]
    options = dict(zip(words[4::2], words[5::2], strict=True))
    assert options["--model"] == "neo-hookean"
    assert (options["--seed"], options["--generations"]) == ("3", "6")
    assert options["--out"] == str(out)
    assert "untraced: not traced yet" in page.text
    assert "one beam alone: no length can be left out" in page.text
    assert "a <made> experiment" in page.text  # escaped in the source
    assert "<made>" not in page.raw


def _places(number: str) -> int:
    return len(number.partition(".")[2])
