"""A law registered outside calibration is searched in its small-strain moduli, or in its own coordinates."""

from __future__ import annotations

from pathlib import Path

import pytest
from made_experiment import experiment

import calibration.parameters as parameters
from calibration.diagnosis.laws import law_of
from calibration.errors import InputError, OptionError
from calibration.fit_plan import law_names, plan_fit
from calibration.fit_request import FitRequest
from calibration.parameters import (
    Coordinate,
    Parametrisation,
    bulk_ratio,
    is_series,
    parametrisation,
    shear_modulus,
)
from calibration.study import tasks_for
from tisim import laws


@pytest.fixture
def twin(monkeypatch: pytest.MonkeyPatch) -> str:
    """A second neo-Hookean law that only `tisim.laws` knows."""
    names, get = laws.names(), laws.get
    monkeypatch.setattr(laws, "names", lambda: (*names, "twin"))
    monkeypatch.setattr(laws, "get", lambda name: get("neo-hookean" if name == "twin" else name))
    return "twin"


def test_small_strain_moduli_are_the_default(twin: str) -> None:
    p = parametrisation(twin)
    assert (p.law, p.names) == ("twin", ("shear_modulus", "bulk_ratio"))
    u = p.start(shear=2e4)
    assert p.moduli(u).shear_modulus == pytest.approx(2e4)
    assert p.moduli(u).bulk_modulus == pytest.approx(300 * 2e4)


def test_all_laws_hold_it_and_the_slowest_is_last(twin: str) -> None:
    names = law_names("all")
    assert twin in names
    assert names[0] == "neo-hookean"
    assert names[-1] == "st-venant-kirchhoff"
    assert law_names(f"{twin}, ogden ,{twin}") == [twin, "ogden"]


def test_coordinates_of_its_own(twin: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parameters, "_REGISTERED", dict(parameters._REGISTERED))

    def make(terms: int) -> Parametrisation:
        skew = Coordinate(name="skew", unit="-", log=False, low=0.0, high=1.0, spread=0.1, start=0.5)
        return Parametrisation(
            law=twin,
            label=f"twin-{terms}",
            coordinates=(shear_modulus(), bulk_ratio(), skew),
            assemble=lambda v: laws.get(twin).from_moduli(
                v["shear_modulus"], v["shear_modulus"] * v["bulk_ratio"]
            ),
        )

    parameters.register(twin, make)
    p = parametrisation(twin, terms=2)
    assert (p.label, p.names) == ("twin-2", ("shear_modulus", "bulk_ratio", "skew"))
    tasks = tasks_for(
        experiment(), law_names=[twin, "neo-hookean"], materials=["A"], folder=Path("fits"), terms=2
    )
    assert [(t.terms, t.label) for t in tasks] == [(2, "twin-2"), (1, "neo-hookean")]


def test_a_number_of_terms_that_no_law_takes_is_refused(tmp_path: Path) -> None:
    """It was left out of account, in fits as in a diagnosis."""
    assert [is_series(law) for law in ("ogden", "neo-hookean", "mooney-rivlin")] == [True, False, False]
    request = FitRequest(out=tmp_path, model="neo-hookean,mooney-rivlin", terms=2)
    with pytest.raises(OptionError, match="expected a law that is a series, got neo-hookean, mooney-rivlin"):
        plan_fit(experiment(), request)
    with pytest.raises(InputError, match="neo-hookean:3: expected no number of terms"):
        law_of("neo-hookean:3")
    assert law_of("ogden:3") == ("ogden", 3)


def test_a_law_that_is_nowhere() -> None:
    with pytest.raises(ValueError, match="law: expected one of"):
        parametrisation("twin")
