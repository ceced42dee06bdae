"""Search coordinates of parts beside a law."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

import tisim
from calibration.parameters import (
    Coordinate,
    PartCoordinates,
    PartKind,
    ProtocolWindow,
    parametrisation,
    part_alternatives,
    part_coordinates,
    part_kind,
    register_part,
)
from calibration.parameters import _parts as registry
from tisim import parts

WINDOW = ProtocolWindow(first=2.0, last=400.0, peaks=2)


def test_a_law_with_parts_makes_a_material_with_parts() -> None:
    specs = ("prony:2", "mullins")
    law = parametrisation("ogden", terms=2).with_parts([part_coordinates(s, WINDOW) for s in specs])
    assert law.label == "ogden-2+prony-2+mullins"
    start = law.start(shear=3e4)
    made = law.material(start)
    assert isinstance(made.viscosity, tisim.Prony)
    assert made.viscosity.modulus == "long-time"
    assert made.softening == tisim.OgdenRoxburgh(
        r=pytest.approx(2.0), m=pytest.approx(3e3), beta=pytest.approx(0.1)
    )
    assert law.moduli(start).shear_modulus == pytest.approx(3e4)
    assert law.values(start)["shear_modulus_1"] == pytest.approx(1.5e4)
    assert len(start) == len(law.bounds) == len(law.names) == 12
    held = law.holding("bulk_ratio")
    assert held.parts == law.parts


def test_times_that_do_not_rise_have_no_answer() -> None:
    law = parametrisation("neo-hookean").with_parts([part_coordinates("prony:2", WINDOW)])
    u = law.start(shear=1e4)
    i, j = law.names.index("prony_time_1"), law.names.index("prony_time_2")
    law.material(u)
    u[[i, j]] = u[[j, i]]
    with pytest.raises(ValueError, match="rise"):
        law.material(u)


def test_times_of_one_ramp_alone_begin_apart() -> None:
    """A record without a hold shows one time only; equal times of two terms would have no solution."""
    law = parametrisation("neo-hookean").with_parts(
        [part_coordinates("prony:3", replace(WINDOW, last=WINDOW.first))]
    )
    made = law.material(law.start(shear=1e4)).viscosity
    assert isinstance(made, tisim.Prony)
    assert (np.diff(np.log10(made.times)) > 0.3).all()


def test_a_spectrum_has_two_times_a_decade_across_the_window() -> None:
    spectrum = part_coordinates("prony:spectrum", WINDOW)
    values = {c.name: c.value(c.prior[0]) for c in spectrum.coordinates if c.prior}
    made = spectrum.assembled(values)
    assert isinstance(made, tisim.Prony)
    assert made.times[0] == pytest.approx(WINDOW.first)
    assert np.diff(np.log10(made.times)) == pytest.approx(0.5)
    assert abs(np.log10(made.times[-1] / WINDOW.last)) < 0.26


@pytest.mark.parametrize("spec", ["prony:0", "prony:4", "prony:-1", "prony:two", "mullins:1", "maxwell", ""])
def test_what_is_no_part_is_refused(spec: str) -> None:
    with pytest.raises(ValueError, match="expected"):
        part_coordinates(spec, WINDOW)


def test_the_data_choose_where_no_number_is_given() -> None:
    assert part_alternatives("prony") == ("prony:1", "prony:2", "prony:3")
    assert part_alternatives("prony:2") == ("prony:2",)
    assert part_alternatives("mullins") == ("mullins",)


def remarks(spec: str, window: ProtocolWindow, **values: float) -> str:
    law = parametrisation("neo-hookean").with_parts([part_coordinates(spec, window)])
    u = law.start(shear=1e4)
    for name, value in values.items():
        u[law.names.index(name)] = law.coordinates[law.names.index(name)].inside(value)
    return "; ".join(law.remarks(u))


def test_what_tests_cannot_show_is_said() -> None:
    said = remarks("prony:2", WINDOW, prony_time_1=0.5, prony_time_2=40.0)
    assert "relaxation time 1, 0.5 s, is outside" in said
    assert "2 s to 400 s" in said
    assert "closer" not in said
    assert "closer than a decade" in remarks("prony:2", WINDOW, prony_time_1=10.0, prony_time_2=40.0)
    quiet = remarks("prony:2", WINDOW, prony_time_1=3.0, prony_time_2=40.0)
    assert "outside" not in quiet
    assert "instantaneous shear modulus is 12 kPa (1.2 times the long-time one)" in quiet
    assert "stated, not fitted" in remarks("prony:spectrum", WINDOW)
    assert remarks("mullins", WINDOW) == ""
    assert "no test unloads" in remarks("mullins", ProtocolWindow(first=1.0, last=9.0, peaks=0))
    assert "cannot be told apart" in remarks("mullins", ProtocolWindow(first=1.0, last=9.0, peaks=1))


def test_fibres_are_an_angle_and_two_constants() -> None:
    law = parametrisation("neo-hookean").with_parts([part_coordinates("fibres", WINDOW)])
    u = law.start(shear=1e4)
    u[law.names.index("fibres_angle_deg")] = 30.0
    made = law.material(u).fibres
    assert isinstance(made, tisim.HolzapfelGasserOgden)
    assert made.direction == pytest.approx((np.sqrt(0.75), 0.5, 0.0))
    assert made.k1 == pytest.approx(5e3)
    assert "along an axis" not in remarks("fibres", WINDOW, fibres_angle_deg=30.0)
    assert "along an axis" in remarks("fibres", WINDOW, fibres_angle_deg=88.0)


def test_a_part_of_ones_own_is_one_registration(monkeypatch: pytest.MonkeyPatch) -> None:
    @dataclass(frozen=True, kw_only=True)
    class LogTime(parts.Viscosity):
        name: ClassVar[str] = "log-time-test"
        title: ClassVar[str] = "Log-time relaxation"
        decade: float

        def check(self) -> None:
            if not self.decade >= 0.0:
                raise ValueError("decade: expected 0 or more")

        def spectrum(self) -> parts.Spectrum:
            times = 10.0 ** np.arange(-2.0, 4.25, 0.5)
            return parts.Spectrum(
                equilibrium=1.0, strengths=np.full(times.size, self.decade / 2.0), times=times
            )

    def make(argument: str, window: ProtocolWindow) -> PartCoordinates:
        del argument
        per_decade = Coordinate(
            name="per_decade", unit="-", log=False, low=0.0, high=1.0, spread=0.02, start=0.05
        )
        return PartCoordinates(
            spec="log-time",
            label="log-time",
            field="viscosity",
            window=window,
            coordinates=(per_decade,),
            assemble=lambda v: LogTime(decade=v["per_decade"]),
            describe=lambda _values, _moduli: [],
        )

    monkeypatch.setattr(registry, "_KINDS", dict(registry._KINDS))
    register_part(PartKind(name="log-time", option="time", usage="log-time", make=make, needs_time=True))
    assert part_kind("log-time").option == "time"
    law = parametrisation("neo-hookean").with_parts([part_coordinates("log-time", WINDOW)])
    made = law.material(law.start(shear=1e4))
    assert made.viscosity is not None
    assert made.viscosity.spectrum().strengths.sum() == pytest.approx(13 * 0.025)
