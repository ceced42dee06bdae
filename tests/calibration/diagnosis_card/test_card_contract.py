"""The two readers of material cards take every card that is written here, and understand the same.

`factory.materials` reads cards for datasets, `calibration.prediction` for predictions, exports and further
fits; neither imports the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import pytest
from card_cases import bench, diagnosis

import tisim
from calibration.diagnosis import Candidate
from calibration.diagnosis.card import write_cards
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.inference import Estimate
from calibration.measurements._effect import HandedOn
from calibration.parameters import ProtocolWindow, held_part, parametrisation, part_coordinates, part_entry
from calibration.prediction._cards import read_cards
from calibration.study import Calibration, write_card
from factory.materials import card_names, load_card, material_of
from tisim import laws, parts

ROOT = Path(__file__).parents[3]
WINDOW = ProtocolWindow(first=0.1, last=100.0, peaks=2)
BESIDE: dict[str, parts.Part] = {
    "viscosity": tisim.Prony(fractions=(0.4, 0.2), times=(1.0, 1000.0 / 3.0), modulus="instantaneous"),
    "softening": tisim.OgdenRoxburgh(r=1.8, m=1500.0, beta=0.15),
    "fibres": tisim.HolzapfelGasserOgden(direction=(0.8, 0.6, 0.0), k1=1e4, k2=0.5),
}


def understood(folder: Path) -> dict[str, dict[str, parts.Part]]:
    """Parts of a folder's materials, by both readers: equal, as are law, parameters and density."""
    found = read_cards(folder)
    assert sorted(card_names(folder)) == sorted(found)
    for name, ours in found.items():
        theirs = load_card(name, folder)
        material_of(theirs)
        for law, parameters in ours.laws.items():
            made = theirs.for_law(law)
            assert (dict(made.parameters), made.density) == (dict(parameters), ours.density)
            assert parts.of(made) == ours.parts()
        assert theirs.law == ours.law
    return {name: card.parts() for name, card in found.items()}


def fit(law: str, specs: Sequence[str] = (), held: Sequence[str] = (), *, sure: bool = True) -> Calibration:
    """A fit that stays where its search began; sure : with error bars."""
    own = [part_coordinates(spec, WINDOW) for spec in specs]
    own += [held_part(field, BESIDE[field], WINDOW) for field in held]
    form = parametrisation(law).with_parts(own) if own else parametrisation(law)
    u = form.start(shear=2e4)
    moduli = form.moduli(u)
    sd = tuple(tuple(1e-4 * float(i == j) for j in range(len(u))) for i in range(len(u)))
    modulus = Estimate(
        name="shear_modulus", unit="Pa", value=2e4, sd=200.0, low=19.6e3, high=20.4e3,
        seen="identified", relative=False,
    )  # fmt: skip
    return Calibration(
        material="S0", law=law, label=form.label, status="converged", message="", density=None,
        u=tuple(float(x) for x in u), parameters=form.parameters(u),
        shear_modulus=moduli.shear_modulus, shear_modulus_sd=200.0, bulk_modulus=moduli.bulk_modulus,
        estimates=(modulus,) if sure else (), covariance=sd if sure else (),
        chi2=90.0, points=100, reduced_chi2=0.9, parts=tuple(specs),
        held={field: part_entry(BESIDE[field]) for field in held}, protocol=asdict(WINDOW),
    )  # fmt: skip


@pytest.mark.parametrize("sure", [True, False])
@pytest.mark.parametrize("law", laws.names())
def test_a_fitted_law(law: str, sure: bool, tmp_path: Path) -> None:
    write_card(tmp_path / "cards", [fit(law, sure=sure)], bench(tmp_path / "bench"))
    assert understood(tmp_path / "cards") == {"S0": {}}


@pytest.mark.parametrize(
    ("specs", "held"),
    [
        (("prony:2",), ()),
        (("mullins",), ()),
        (("fibres",), ()),
        (("prony:1", "mullins", "fibres"), ()),
        ((), ("viscosity", "softening", "fibres")),
        (("prony:spectrum",), ("softening",)),
    ],
)
def test_parts_beside_a_fitted_law(specs: tuple[str, ...], held: tuple[str, ...], tmp_path: Path) -> None:
    made = fit("ogden", specs, held)
    experiment = bench(tmp_path / "bench")
    worse = replace(fit("neo-hookean"), chi2=900.0, reduced_chi2=9.0)
    path = write_card(tmp_path / "cards", [worse, made], experiment)
    found = understood(tmp_path / "cards")["S0"]
    assert found.keys() == made.material_parts.keys()
    for field, part in made.material_parts.items():
        assert parts.encode(found[field]) == part_entry(part)
        assert all(f"  {key}:" in path.read_text() for key in parts.encode(part))


@pytest.mark.parametrize("field", [*parts.FIELDS, "law"])
def test_a_diagnosis_that_hands_on_a_part(field: str, tmp_path: Path) -> None:
    cause = Candidate(effect="creep", at="S1")
    found = diagnosis({cause: 0.05})

    def stiffening(shear: float, bulk: float) -> tuple[str, dict[str, float]]:
        return "yeoh", {"mu": shear, "stiffening": 0.123456789, "bulk": bulk}

    handed = HandedOn(
        field=field,  # type: ignore[arg-type]
        part=BESIDE.get(field),
        law=stiffening if field == "law" else None,
        modulus_ratio=1.2,
        states="that of a test",
    )
    found = replace(found, subject=replace(found.subject, handed_on={cause: {"S1": handed}}))
    write_cards(tmp_path / "cards", found, bench(tmp_path / "bench"))
    read = understood(tmp_path / "cards")
    assert read["S0"] == {}
    assert list(read["S1"]) == ([] if field == "law" else [field])
    assert all(part_entry(part) == part_entry(BESIDE[name]) for name, part in read["S1"].items())
    assert load_card("S1", tmp_path / "cards").law == ("yeoh" if field == "law" else "neo-hookean")


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_diagnosis_of_any_effect(effect: str, tmp_path: Path) -> None:
    """Of rig and camera too: their file is no card to either reader."""
    middle = min(0.5 * EFFECTS[effect].bounds[1], 0.05)
    write_cards(tmp_path / "cards", diagnosis({Candidate(effect=effect): middle}), bench(tmp_path / "bench"))
    assert understood(tmp_path / "cards") == {"S0": {}, "S1": {}}


@pytest.mark.parametrize("folder", ["datasets/materials", "studies/learning/materials"])
def test_cards_that_come_along(folder: str) -> None:
    found = understood(ROOT / folder)
    assert any("viscosity" in beside for beside in found.values())
