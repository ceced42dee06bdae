"""The page of a diagnosis: self-contained, consistent with the JSON file, and safe for any name."""

from __future__ import annotations

import base64
import io
import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib.figure
import numpy as np
import pytest
from diagnosis_cases import Kind, LinearModel, diagnosis, numbers
from html_page import Page
from matplotlib.image import imread

from calibration.diagnosis import Diagnosis
from calibration.diagnosis.drawing import Figure, figures_of, paired_bars
from calibration.diagnosis.report import write_report
from calibration.diagnosis.report._tables import fold_rows

KINDS: tuple[Kind, ...] = ("none", "found", "ambiguous", "unexplained")
EVIL = "<script>alert(1)</script><img src=x onerror=alert(2)>\"'&"
ODD = "$\\frac{a$ _^{} 材料 \U0001f9ea \N{COMBINING ACUTE ACCENT}\t" + 60 * "long"


class DrawnModel(LinearModel):
    """A kind of measurement with figures of its own."""


class MuteModel(LinearModel):
    """A model whose beam has no equilibrium to draw."""


@figures_of.register(DrawnModel)
def _drawn(model: DrawnModel, made: Diagnosis) -> list[Figure]:
    after = [2.0] if made.extended else None
    bars = paired_bars([model.place], [3.0], after, quantity="rms / mm", noise=1.0, held_out=None)
    return [
        Figure(name=model.place, caption=f"shapes of {model.place}", figure=_curve()),
        Figure(name=model.place, caption="bars", figure=bars, section="residuals"),
    ]


@figures_of.register(MuteModel)
def _mute(model: MuteModel, made: Diagnosis) -> list[Figure]:
    del model, made
    raise ValueError("no equilibrium at this state")


def _curve() -> matplotlib.figure.Figure:
    figure = matplotlib.figure.Figure()
    figure.subplots().plot([1, 2, 1])
    return figure


@pytest.fixture(scope="module", params=KINDS)
def case(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Kind, Diagnosis, Page, list[Path]]:
    made, model = diagnosis(request.param)
    model.__class__ = DrawnModel
    paths = write_report(made, model, tmp_path_factory.mktemp("page") / "new", title="a beam")
    return request.param, made, Page(paths[0]), paths


def test_the_verdict_stands_on_top(case: tuple[Kind, Diagnosis, Page, list[Path]]) -> None:
    kind, made, page, _ = case
    assert page.verdict == kind
    assert made.sentence() in page.text
    assert page.text.index(made.sentence()) < page.text.index("Measured against ")
    assert made.next_experiment in page.text


def test_figures_are_those_of_the_json(case: tuple[Kind, Diagnosis, Page, list[Path]]) -> None:
    kind, made, page, _ = case
    told = made.to_json()
    assert (told["extended"] is None) == (kind in ("none", "unexplained"))
    for key in ("causes", "baseline", "extended", "not_visible"):
        for value in numbers(told[key]):
            # the sd of a cause is in the text beside its value
            assert value in page.values or key == "causes", (key, value)
    gain = told["gain"] or {}
    for key in ("rms_mm_before", "rms_mm_after", "rms_mm_noise", "log_likelihood"):
        assert key not in gain or gain[key] in page.values
    for cause in told["causes"]:
        assert cause["confidence"] in page.values
        for p in cause["parameters"].values():
            value, sd = page.shown[p["value"]].split(" ± ")
            assert float(value.split()[-1]) == pytest.approx(p["value"], rel=0.05)
            assert float(sd.split()[0]) == pytest.approx(p["sd"], rel=0.5)
    shown = page.shown[told["baseline"]["rms_mm"]]
    assert float(shown) == pytest.approx(told["baseline"]["rms_mm"], rel=0.01)


def test_it_needs_nothing_beside_it(case: tuple[Kind, Diagnosis, Page, list[Path]]) -> None:
    _, _, page, paths = case
    assert "http:" not in page.raw
    assert "https:" not in page.raw
    assert "url(" not in page.raw
    assert not page.tags & {"script", "link", "iframe", "object"}
    inside = [base64.b64decode(s.removeprefix("data:image/png;base64,")) for s in page.sources]
    assert sorted(inside) == sorted(p.read_bytes() for p in paths[1:])


def test_pictures_are_files_and_not_blank(case: tuple[Kind, Diagnosis, Page, list[Path]]) -> None:
    _, _, _, paths = case
    assert paths[0].name == "report.html"
    assert sorted(p.name for p in paths[0].parent.iterdir()) == sorted(p.name for p in paths)
    assert len({p.name for p in paths}) == 4  # evidence, and two of the model's with the same name
    for p in paths[1:]:
        pixels = imread(io.BytesIO(p.read_bytes()))[..., :3]
        inked = np.any(np.abs(pixels - 1.0) > 0.1, axis=2)
        assert 0.005 < inked.mean() < 0.9


def test_what_a_cause_belongs_to_is_said() -> None:
    made, model = diagnosis("ambiguous")
    words = _page(made, model).text
    assert "a property of the specimen: it may enter a simulated dataset" in words
    assert "Equivalent explanations" in words
    assert made.finding.equivalent == (("bend",), ("twin",))
    assert "turn it over: bend, twin part there by" in words


def test_unexplained_shows_the_test_that_fails_and_names_nothing() -> None:
    made, model = diagnosis("unexplained")
    page = _page(made, model)
    assert "the residuals exceed noise in the sum of squares of all residuals and odd bends" in page.text
    assert page.raw.index('id="lack-of-fit"') < page.raw.index('id="evidence"')
    assert "p-value of the lack of fit ≤ 0.00025" in page.text
    assert "Found" not in page.text


def test_what_cannot_be_seen_is_listed_with_its_amplitude() -> None:
    page = _page(*diagnosis("none"))
    assert "no amplitude shows" in page.text  # for `blind`
    assert "take the blind away" in page.text
    made, _ = diagnosis("none")
    threshold = next(i.threshold for i in made.undetectable if i.effect == "coarse-mesh")
    assert threshold == pytest.approx(5.0)  # its column has unit length
    assert page.shown[threshold] == "share 5.0"


def test_text_out_of_files_is_escaped() -> None:
    made, model = diagnosis("found", place=EVIL)
    made = replace(made, next_experiment=EVIL, notes=(EVIL,))
    model.__class__ = DrawnModel
    page = _page(made, model, title=EVIL)
    assert "script" not in page.tags
    assert "onerror" not in page.attributes
    assert page.text.count("<script>alert(1)</script>") >= 5  # title, heading, next, notes, moduli
    assert len(page.sources) == 3


def test_odd_names_do_not_break_it(tmp_path: Path) -> None:
    made, model = diagnosis("found", place=ODD)
    model.__class__ = DrawnModel
    paths = write_report(made, model, tmp_path, title=ODD)
    assert all(len(p.name) < 100 and p.name.isascii() for p in paths)
    assert " ".join(ODD.split()) in Page(paths[0]).text


def test_a_domain_without_pictures_has_a_page(tmp_path: Path) -> None:
    made, model = diagnosis("found")
    paths = write_report(made, model, tmp_path, title="plain")
    assert [p.name for p in paths] == ["report.html", "evidence.png"]
    assert "No pictures of shapes." in Page(paths[0]).text


def test_missing_pictures_are_said(tmp_path: Path) -> None:
    made, model = diagnosis("found")
    model.__class__ = MuteModel
    words = Page(write_report(made, model, tmp_path, title="mute")[0]).text
    assert "pictures of shapes and residuals are missing: no equilibrium at this state" in words


def test_a_fit_that_did_not_converge_is_said_where_the_verdict_stands_on_it() -> None:
    """Fits of causes that are not named are in the notes."""
    made, model = diagnosis("found")
    first, *others = made.finding.explanations
    lame = replace(first, fit=replace(first.fit, converged=False, message="not converged in 10 steps"))
    other = replace(made, finding=replace(made.finding, explanations=(lame, *others)))
    assert "did not converge" not in _page(other, model).text
    named = replace(made, chosen=lame)
    assert "The fit of bend did not converge: not converged in 10 steps." in _page(named, model).text


def test_parts_that_a_cause_does_not_change_are_counted() -> None:
    def fold(name: str, after: float) -> dict[str, object]:
        sizes = {"rms_mm_before": 2.0, "rms_mm_after": after, "rms_mm_noise": 1.0}
        return {"left_out": name, "skill": 0.5, **sizes}

    def first(*folds: dict[str, object]) -> list[str]:
        return [row[0].text for row in fold_rows({"gain": {"folds": folds}}, "mm")]

    assert first(fold("a", 1.5), fold("b", 2.0), fold("c", 2.0001)) == ["a", "2 others"]
    assert first(fold("a", 1.5), fold("b", 2.1)) == ["a", "b"]
    assert first(fold("a", 2.0), fold("b", 2.0)) == ["all 2"]


def test_no_fold_is_said() -> None:
    made, model = diagnosis("found")
    assert made.held_out is not None
    made = replace(made, held_out=replace(made.held_out, held_out="", kept=0.1, note="no fold keeps it"))
    assert "Nothing was held out: no fold keeps it (at best 10 %" in _page(made, model).text


def _page(made: Diagnosis, model: LinearModel, *, title: str = "a beam") -> Page:
    with tempfile.TemporaryDirectory() as folder:
        return Page(write_report(made, model, Path(folder), title=title)[0])
