"""Units from the names of parameters, bars of the evidence, drawn names."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis_cases import diagnosis

from calibration.diagnosis.drawing import label, label_of_causes
from calibration.diagnosis.report._evidence import bars
from calibration.diagnosis.report._units import quantity_and_unit
from calibration.diagnosis.report._words import headline


@pytest.mark.parametrize(
    ("parameter", "name", "unit"),
    [
        ("curvature_per_m", "curvature", "1/m"),
        ("gap_mm", "gap", "mm"),
        ("angle_deg", "angle", "°"),
        ("rad_per_Nm", "", "rad/(N m)"),
        ("per_decade", "", "per decade"),
        ("per_100mm", "", "per 100 mm"),
        ("per_m2", "", "1/m²"),
        ("c2_over_c1", "c2 over c1", ""),
        ("lost_EI", "lost EI", ""),
        ("excess", "excess", ""),
        ("shear_modulus_Pa", "shear modulus", "Pa"),
        ("rms_mm", "rms", "mm"),
    ],
)
def test_units_are_read_from_names(parameter: str, name: str, unit: str) -> None:
    assert quantity_and_unit(parameter) == (name, unit)


def test_bars_are_one_an_effect_the_strongest_first() -> None:
    made, model = diagnosis("found")
    found = bars(made.finding)
    assert [b.gain for b in found] == sorted((b.gain for b in found), reverse=True)
    single = [b for b in found if "+" not in b.name]
    assert sorted(b.name.split(" of ")[0] for b in single) == sorted(model.effects)
    assert [b.name for b in found if b.named] == ["bend"]
    assert [b.name for b in found if b.behind == 0.0] == ["bend"]
    best = made.finding.explanations[0]
    assert found[0].gain == pytest.approx(made.finding.baseline.chi2 - best.fit.chi2)


def test_rivals_are_marked_too() -> None:
    made, _ = diagnosis("ambiguous")
    named = [b for b in bars(made.finding) if b.named]
    assert {b.name for b in named} == {"bend", "twin"}
    assert all(b.behind is not None and b.behind <= 6.0 for b in named)


def test_the_title_says_how_many_are_certain() -> None:
    made, _ = diagnosis("ambiguous")
    sets = (("grip", "bend", "void"), ("grip", "bend", "twin"))
    two = replace(made.finding, equivalent=sets)
    assert headline(two) == "Several causes found, another not identified"
    one = replace(made.finding, equivalent=tuple(s[1:] for s in sets))
    assert headline(one) == "One cause found, another not identified"


def test_what_was_only_screened_has_its_gain_to_first_order() -> None:
    made, _ = diagnosis("unexplained")
    screened = replace(made.finding, explanations=())
    linear = {b.name: b.gain for b in bars(screened)}
    assert all(b.behind is None for b in bars(screened))
    # the model is linear: a fit improves chi-square by the screened amount
    for e in made.finding.explanations:
        gain = made.finding.baseline.chi2 - e.fit.chi2
        assert linear[e.fit.label] == pytest.approx(gain, abs=1e-6)


def test_causes_go_on_in_another_line_and_none_is_left_out() -> None:
    assert label_of_causes("creep + skin") == "creep + skin"
    three = "hysteresis of M0 + strain-offset of M1-equibiaxial + limited-extensibility of M0"
    shown = label_of_causes(three)
    assert shown == "hysteresis of M0 + strain-offset of M1-equibiaxial +\nlimited-extensibility of M0"
    long = label_of_causes(f"creep + {'a' * 90} + skin").split("\n")
    assert [line[0] for line in long] == ["c", "a", "s"]
    assert max(len(line) for line in long) == 54 + len(" +")


def test_labels_are_short_and_no_mathematics() -> None:
    assert label("S0-cantilever-050") == "S0-cantilever-050"
    assert label("a$b") == r"a\$b"
    assert len(label("x" * 500)) == 44
    assert label("材") == "\N{WHITE SQUARE}"
    assert label("two\nlines\x00") == "two lines\N{WHITE SQUARE}"
