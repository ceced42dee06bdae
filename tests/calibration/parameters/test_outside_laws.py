"""A law registered outside calibration is searched in its small-strain moduli, or in its own coordinates."""

from __future__ import annotations

import pytest

import calibration.parameters as parameters
from calibration.fit_plan import law_names
from calibration.parameters import Coordinate, Parametrisation, bulk_ratio, parametrisation, shear_modulus
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


def test_a_law_that_is_nowhere() -> None:
    with pytest.raises(ValueError, match="law: expected one of"):
        parametrisation("twin")
