"""`calibration.fit --start`: parts of a material card, held in a fit or as the start of its search."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from timed_coupons import CYCLES, RELAXATION, SOLID, trial, write

import calibration
from calibration.errors import InputError
from calibration.experiment import read
from calibration.export._response import long_time
from calibration.parameters import ProtocolWindow, held_part, parametrisation, part_coordinates
from calibration.study import parts
from calibration.study._store import FitStore
from calibration.study.calibration import Calibration
from calibration.study.parts import CardParts
from factory.materials import load_card
from tisim import HolzapfelGasserOgden, Material, OgdenRoxburgh, Prony
from tisim.parts import encode

PRONY = {"kind": "prony", "fractions": [0.3, 0.2], "times": [2.0, 60.0]}
MULLINS = {"kind": "ogden-roxburgh", "r": 1.8, "m": 1500.0, "beta": 0.15}
WORN = OgdenRoxburgh(r=1.8, m=1500.0, beta=0.15)
FAST: dict[str, Any] = {"generations": 2, "workers": 1, "seed": 1, "model": "ogden"}


def card(folder: Path, name: str = "found", **beside: object) -> Path:
    content = {
        "material": name,
        "laws": {"ogden": {"mu": [1.0], "alpha": [2.0], "bulk": 1e5}},
        "law": "ogden",
    }
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump({**content, **beside}))
    return path


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = [
        trial("relaxation", "uniaxial", RELAXATION, noise=0.01, seed=1),
        trial("cycles", "uniaxial", CYCLES, noise=0.01, seed=2),
    ]
    return write(tmp_path_factory.mktemp("held") / "experiment", made)


@pytest.mark.slow
def test_parts_of_a_card_are_held(experiment: Path, tmp_path: Path) -> None:
    path = card(tmp_path / "cards", viscosity=PRONY, softening=MULLINS)
    (found,) = calibration.fit(experiment, start=path, out=tmp_path / "out", **FAST)
    assert found.label == "ogden+prony-held+ogden-roxburgh-held"
    assert found.status == "converged"
    assert found.parts == ()
    assert found.shear_modulus == pytest.approx(SOLID.shear_modulus, rel=0.01)
    assert {e.name for e in found.estimates} == {"shear_modulus", "alpha", "bulk_ratio"}
    assert "viscosity (prony, fractions 0.3 and 0.2, times 2 and 60" in found.note
    assert "no error bar has the error of what is held" in found.note
    again = Calibration.from_json(found.to_json())
    assert again.held["softening"] == encode(WORN)
    made = again.simulated()
    assert made.viscosity == Prony(fractions=(0.3, 0.2), times=(2.0, 60.0))
    assert made.softening == OgdenRoxburgh(r=1.8, m=1500.0, beta=0.15)
    # held parts are in the new card, which a dataset and a further fit read
    fits = calibration.fit(experiment, start=path, out=tmp_path / "out", **FAST)
    (written,) = fits.write_cards(tmp_path / "new")
    assert load_card(written.stem, written.parent).for_law("ogden").viscosity == made.viscosity
    assert "Held beside ogden" in written.read_text()
    assert f"--start {path}" in fits.write_report(tmp_path / "out").read_text()


@pytest.mark.slow
def test_a_search_begins_at_the_card(experiment: Path, tmp_path: Path) -> None:
    path = card(tmp_path / "cards", viscosity=PRONY, softening=MULLINS)
    (found,) = calibration.fit(experiment, start=path, time="prony:2", **FAST)
    assert found.label == "ogden+prony-2+ogden-roxburgh-held"
    assert found.parts == ("prony:2",)
    assert "the search of prony-2 began at the viscosity of the card of found" in found.note
    near = {e.name: e.value for e in found.estimates}
    assert near["prony_time_2"] == pytest.approx(60.0, rel=0.2)


@pytest.mark.parametrize(
    ("time", "label", "searched"),
    [
        (None, "ogden+prony-held+ogden-roxburgh-held", []),
        (
            "prony:2",
            "ogden+prony-2+ogden-roxburgh-held",
            ["prony_fraction_1", "prony_time_1", "prony_fraction_2", "prony_time_2"],
        ),
    ],
)
def test_what_a_fit_from_a_card_searches(
    experiment: Path, time: str | None, label: str, searched: list[str]
) -> None:
    found = CardParts(
        "the card", {"viscosity": Prony(fractions=(0.3, 0.2), times=(2.0, 60.0)), "softening": WORN}
    )
    assert sorted(found.content) == ["softening", "viscosity"]
    own = parts.with_parts(
        parametrisation("ogden"), [] if time is None else [time], read(experiment), "M", found
    )
    assert own.label == label
    assert list(own.names) == ["shear_modulus", "bulk_ratio", "alpha", *searched]
    made = own.material(own.start(shear=3e4))
    assert made.softening == WORN
    assert made.viscosity is not None
    assert made.viscosity.spectrum().times == pytest.approx([2.0, 60.0])


def test_an_instantaneous_series_is_held_beside_the_long_time_modulus() -> None:
    """A fit reports long-time moduli; stiffness of fibres and softening energy refer to the same."""
    at_once = Prony(fractions=(0.4, 0.2), times=(1.0, 30.0), modulus="instantaneous")
    fibres = HolzapfelGasserOgden(k1=1e3, k2=2.0, direction=(1.0, 0.0, 0.0))
    held = CardParts("c", {"viscosity": at_once, "softening": WORN, "fibres": fibres}).held(())
    law = parametrisation("neo-hookean").with_parts(
        [held_part(name, part, ProtocolWindow(first=1.0, last=100.0, peaks=0)) for name, part in held.items()]
    )
    u = law.start(shear=8e3)
    found = law.material(u)
    assert law.moduli(u).shear_modulus == pytest.approx(8e3)
    assert found.viscosity is not None
    assert found.viscosity.spectrum().equilibrium == 1.0
    assert found.viscosity.spectrum().instantaneous == pytest.approx(2.5)
    beside = {"viscosity": at_once, "softening": WORN, "fibres": fibres}
    stated = Material(law="neo-hookean", parameters={"mu": 20e3, "lam": 1e6}, **beside)  # type: ignore[arg-type]
    assert found.fibres == long_time(stated).fibres
    assert found.softening == long_time(stated).softening


def test_a_fit_of_an_earlier_version_is_read(tmp_path: Path) -> None:
    """It states what it held, and its card, without units behind the keys; another card is another fit."""
    found = CardParts(
        "the card", {"viscosity": Prony(fractions=(0.3, 0.2), times=(2.0, 60.0)), "softening": WORN}
    )
    before = {"viscosity": {**PRONY, "modulus": "long-time"}, "softening": MULLINS}
    assert before != found.content
    old = Calibration(
        material="M", law="neo-hookean", label="neo-hookean+prony-held+ogden-roxburgh-held",
        status="converged", message="", density=None, u=(10.0, 5.7), parameters={"mu": 2e4, "lam": 6e6},
        held=before, protocol={"first": 1.0, "last": 100.0, "peaks": 1},
    )  # fmt: skip
    FitStore(tmp_path, "fit", {"card": before}).finish(old)
    again = FitStore(tmp_path, "fit", {"card": found.content}).result()
    assert again is not None
    assert again.material_parts == found.parts
    worn = {**before, "softening": {**MULLINS, "r": 1.9}}
    for other in (worn, {"viscosity": before["viscosity"]}, None, {"viscosity": {"kind": "lost"}}):
        with pytest.raises(InputError, match="made with another card"):
            FitStore(tmp_path, "fit", {"card": other}).result()


def test_parts_are_taken_apart_and_put_together() -> None:
    window = ProtocolWindow(first=0.1, last=1000.0, peaks=2)
    at_once = Prony(fractions=(0.1, 0.3), times=(50.0, 1.0), modulus="instantaneous")
    for spec, part in (
        ("prony:2", at_once),
        ("mullins", OgdenRoxburgh(r=1.8, m=1500.0, beta=0.15)),
        ("fibres", HolzapfelGasserOgden(direction=(0.8, 0.6, 0.0), k1=1e4, k2=0.5)),
    ):
        begun = part_coordinates(spec, window).starting_at(part)
        again = begun.assembled({c.name: float(c.start or 0.0) for c in begun.coordinates})
        if isinstance(again, Prony):
            assert again.times == (1.0, 50.0)
            assert again.fractions == pytest.approx((0.5, 1 / 6))
        elif isinstance(again, HolzapfelGasserOgden):
            assert again.direction == pytest.approx((0.8, 0.6, 0.0))
        else:
            assert again == part
    with pytest.raises(ValueError, match="of so many terms"):
        part_coordinates("prony:1", window).starting_at(at_once)
    own = parts.CardParts("the card of M", {"viscosity": at_once})
    assert "the search of prony-1 did not begin, for its other form" in own.sentence(["prony:1"])


@pytest.mark.parametrize(
    ("cards", "expected"),
    [
        ({"found": {}}, "start .*: expected viscosity, softening or fibres in the card of found"),
        (
            {"A": {"viscosity": PRONY}, "B": {"viscosity": PRONY}},
            "start .*: expected a card of M, found A, B",
        ),
        ({"M": {"viscosity": {**PRONY, "times": [1.0, 1.0]}}}, "of which no two are alike"),
        (
            {"M": {"viscosity": {**PRONY, "modulus": "instantaneous", "fractions": [0.7, 0.4]}}},
            "sum to less than 1",
        ),
        (
            {"M": {"softening": {**MULLINS, "r": 0.5}}},
            r"key softening\.r: expected a number of 1 or more, got 0\.5",
        ),
        (
            {"M": {"fibres": {"kind": "holzapfel-gasser-ogden", "direction": [0, 0, 0], "k1": 1.0}}},
            "direction",
        ),
    ],
)
def test_cards_that_cannot_be_used(
    experiment: Path, tmp_path: Path, cards: dict[str, Any], expected: str
) -> None:
    for name, beside in cards.items():
        card(tmp_path / "cards", name, **beside)
    with pytest.raises(InputError, match=expected):
        calibration.fit(experiment, start=tmp_path / "cards", **FAST)


def test_a_card_that_the_tests_cannot_follow(tmp_path: Path) -> None:
    folder = write(tmp_path / "x", [trial("relaxation", "uniaxial", RELAXATION)], clock=False)
    path = card(tmp_path / "cards", viscosity=PRONY)
    words = [sys.executable, "-m", "calibration.fit", str(folder), "--model", "ogden", "--start", str(path)]
    ended = subprocess.run(
        [*words, "--out", str(tmp_path / "out")], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert "the card of found: trial relaxation: --time prony: expected a column time_s" in " ".join(
        ended.stderr.split()
    )
