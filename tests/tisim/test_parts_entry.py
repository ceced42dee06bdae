"""Parts as plain values: what is written is read, also without units, and what is unsound is refused."""

from __future__ import annotations

import json
import pickle
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
import pytest

import tisim
from tisim import parts

PRONY = tisim.Prony(fractions=(0.2, 0.1), times=(1.0, 30.0), modulus="instantaneous")
MULLINS = tisim.OgdenRoxburgh(r=2.0, m=1234.5678, beta=0.1)
FIBRES = tisim.HolzapfelGasserOgden(direction=(0.8, 0.6, 0.0), k1=5e3, k2=1.0)
BESIDE = {"viscosity": PRONY, "softening": MULLINS, "fibres": FIBRES}


@dataclass(frozen=True, kw_only=True)
class Power(parts.Viscosity):
    """A part from outside: a parameter with its unit, and two of which one is called as the other's unit."""

    name: ClassVar[str] = "power"
    title: ClassVar[str] = "Power law"
    units: ClassVar[Mapping[str, str]] = {"first": "s"}
    first: float
    rate: float = 1.0
    rate_Pa: float = 2.0

    def check(self) -> None:
        if self.rate > 5.0:
            raise RuntimeError("made for\nsmall rates")

    def spectrum(self) -> parts.Spectrum:
        return parts.Spectrum(equilibrium=1.0, strengths=np.zeros(1), times=np.array([self.first]))


@pytest.fixture
def power() -> Iterator[type[Power]]:
    yield parts.register(Power)
    parts.unregister("power")


def test_what_is_written_is_read() -> None:
    material = tisim.Material(law="neo-hookean", parameters={"mu": 1e4, "lam": 1e6}, **BESIDE)  # type: ignore[arg-type]
    assert parts.of(material) == BESIDE
    written = json.loads(json.dumps({field: parts.encode(part) for field, part in BESIDE.items()}))
    assert written == {
        "viscosity": {
            "kind": "prony", "fractions": [0.2, 0.1], "times_s": [1.0, 30.0], "modulus": "instantaneous",
        },
        "softening": {"kind": "ogden-roxburgh", "r": 2.0, "m_J_per_m3": 1234.5678, "beta": 0.1},
        "fibres": {
            "kind": "holzapfel-gasser-ogden", "direction": [0.8, 0.6, 0.0], "k1_Pa": 5e3, "k2": 1.0,
        },
    }  # fmt: skip
    assert {field: parts.decode(field, entry) for field, entry in written.items()} == BESIDE
    assert parts.encode(MULLINS, digits=6)["m_J_per_m3"] == 1234.57


def test_entries_without_units_are_read() -> None:
    """Cards and fits of earlier versions have them."""
    for field, part in BESIDE.items():
        names = [f.name for f in fields(part)]
        entry = {"kind": part.name, **{name: getattr(part, name) for name in names}}
        assert parts.decode(field, entry) == part
    listed = {"kind": "prony", "fractions": [0.5], "times": [2]}
    assert parts.decode("viscosity", listed) == tisim.Prony(fractions=(0.5,), times=(2.0,))


def test_a_part_from_outside_states_its_units(power: type[Power]) -> None:
    part = power(first=2.0, rate=3.0)
    entry = parts.encode(part)
    assert entry == {"kind": "power", "first_s": 2.0, "rate": 3.0, "rate_Pa": 2.0}
    assert parts.decode("viscosity", entry) == part
    # where no unit is stated any of SI's is accepted, and a parameter's own name goes first
    assert parts.decode("viscosity", {"kind": "power", "first": 2.0, "rate_per_s": 3.0}) == part
    assert parts.decode("viscosity", {"kind": "power", "first": 2.0, "rate": 3.0, "rate_Pa": 2.0}) == part
    with pytest.raises(parts.EntryError, match=r"^key viscosity: power: RuntimeError: made for small rates$"):
        parts.decode("viscosity", {"kind": "power", "first": 2.0, "rate": 6.0})


SOUND: dict[str, dict[str, Any]] = {field: parts.encode(part) for field, part in BESIDE.items()}


@pytest.mark.parametrize(
    ("field", "change", "sentence"),
    [
        ("viscosity", {"times": [1.0, 2.0]}, ".times: states the same as times_s: expected one of them"),
        ("viscosity", {"fractions": [True, 0.1]}, ".fractions: expected a number, a word or a list of"),
        ("viscosity", {"fractions": [[0.2], 0.1]}, ".fractions: expected a number, a word or a list of"),
        ("viscosity", {"fractions": None}, ".fractions: expected a number, a word or a list of"),
        ("viscosity", {"times_s": [1.0, -1.0]}, ".times_s: expected one or more relaxation times above 0 s"),
        ("viscosity", {"kind": "prony", "times_ms": 1}, ".times_ms: unknown key"),
        ("viscosity", {"kind": "pronny"}, ".kind: expected one of prony, got 'pronny'"),
        ("viscosity", {"kind": "ogden-roxburgh"}, ".kind: expected one of prony, got 'ogden-roxburgh'"),
        ("softening", {"beta": True}, ".beta: expected a number, a word or a list of numbers, got True"),
        ("softening", {"r": 0.5}, ".r: expected a number of 1 or more, got 0.5"),
        ("softening", {"m_J_per_m3": "many"}, ".m_J_per_m3: expected an energy above 0 J/m3, got 'many'"),
        ("fibres", {"direction": [0, 0, 0]}, ".direction: expected a direction other than (0, 0, 0)"),
    ],
)
def test_an_unsound_entry_in_one_sentence(field: str, change: dict[str, Any], sentence: str) -> None:
    with pytest.raises(parts.EntryError) as caught:
        parts.decode(field, {**SOUND[field], **change})
    assert str(caught.value).startswith(f"key {field}{sentence}")
    assert caught.value.field == field
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)


def test_a_rate_is_not_read_as_a_time() -> None:
    with pytest.raises(parts.EntryError) as caught:
        parts.decode("viscosity", {"kind": "prony", "fractions": [0.1], "times_per_s": [1.0]})
    assert str(caught.value) == (
        "key viscosity.times_per_s: unknown key; key viscosity.times: this key is missing"
    )


@pytest.mark.parametrize("entry", [3, "prony", None, ["prony"], {1: 2}])
def test_what_is_no_entry(entry: object) -> None:
    with pytest.raises(parts.EntryError, match=r"^key fibres: expected the key kind and the parameters"):
        parts.decode("fibres", entry)
    with pytest.raises(parts.EntryError, match=r"^key fibres\.kind: this key is missing$"):
        parts.decode("fibres", {})
    with pytest.raises(ValueError, match="expected one of viscosity, softening, fibres, got 'law'"):
        parts.decode("law", SOUND["fibres"])
