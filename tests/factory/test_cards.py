"""Material cards: moduli, rejected values, and cards of other names as material levels of a plan."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from factory.build import split_names
from factory.errors import InputError
from factory.materials import LAWS, load_card
from factory.plan import make_plan
from factory.reader import open_dataset
from factory.recipe import Recipe, load_recipe
from learn.data import open_store
from tests.factory.conftest import ROOT, Builder


def _moduli(law: str, p: dict[str, Any]) -> tuple[float, float]:
    """Small-strain shear and bulk modulus."""
    if law == "mooney-rivlin":
        return 2 * (p["c10"] + p["c01"]), p["bulk"]
    if law == "ogden":
        return sum(m * a for m, a in zip(p["mu"], p["alpha"], strict=True)) / 2, p["bulk"]
    if law == "arruda-boyce":
        c = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)
        series = sum(i * c[i - 1] * 3 ** (i - 1) / p["locking"] ** (2 * i - 2) for i in range(1, 6))
        return 2 * p["mu"] * series, p["bulk"]
    return p["mu"], p["lam"] + 2 * p["mu"] / 3


@pytest.mark.parametrize(("name", "young"), [("S0", 91e3), ("S0.5", 44e3), ("S1", 27.2e3)])
def test_cards_give_all_laws_the_modulus_of_the_papers_table(name: str, young: float) -> None:
    card = load_card(name)
    assert card.derived
    for law in LAWS:
        material = card.for_law(law)
        shear, bulk = _moduli(law, dict(material.parameters))
        assert 3 * shear == pytest.approx(young, rel=2e-3)
        assert bulk / shear == pytest.approx(20, rel=1e-3)
        assert material.law == law


def test_cards_are_what_their_script_writes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["derive.py", "--check"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(ROOT / "datasets" / "materials" / "derive.py"), run_name="__main__")
    assert end.value.code == 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("material: S0", "material: S9", "key material: expected S0, as the file is called, got S9"),
        ("stiffness: 0.8", "stiffness: 1.0", "key stiffness: "),
        ("alpha: [3.0]", "alpha: [3.0, 2.0]", "expected as many mu as alpha, got 1 and 2"),
        ("alpha: [3.0]", "alpha: [-3.0]", "mu and alpha of one sign"),
        ("  ogden:", "  odgen:", "odgen: law: expected one of"),
        ("  neo-hookean:", "  yeoh:", "key laws.neo-hookean: this key is missing"),
        ("locking: 2.828427", "locking: 0.5", "key laws.arruda-boyce.locking: "),
        ("mu: 30341.0, lam", "mu: -1.0, lam", "key laws.st-venant-kirchhoff.mu: "),
        ("mu: [20228.0]", "mu: [20.228]", "its shear modulus is 30.342 Pa, and that of neo-hookean"),
        ("density: 1000.0", "density: 1.07", "key density: input should be greater than or equal to 10"),
    ],
)
def test_bad_cards(old: str, new: str, words: str, tmp_path: Path) -> None:
    text = (ROOT / "datasets" / "materials" / "S0.yaml").read_text()
    assert old in text
    (tmp_path / "S0.yaml").write_text(text.replace(old, new))
    with pytest.raises(InputError) as caught:
        load_card("S0", tmp_path)
    assert words in str(caught.value)
    assert str(tmp_path / "S0.yaml") in str(caught.value)


def test_cards_are_in_a_folder(tmp_path: Path) -> None:
    (tmp_path / "S0.yaml").write_text("")
    for no_folder in (tmp_path / "S0.yaml", tmp_path / "none"):
        with pytest.raises(InputError, match=f"{no_folder.name}: expected a folder of material cards"):
            load_card("S0", no_folder)


def test_a_law_that_refuses_the_moduli_of_a_card_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tiny: Recipe
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise ValueError("bulk must be above 50 mu")

    content = yaml.safe_load((ROOT / "datasets" / "materials" / "S0.yaml").read_text())
    del content["laws"]["ogden"]
    for name in tiny.levels:
        (tmp_path / f"{name}.yaml").write_text(yaml.safe_dump({**content, "material": name}))
    monkeypatch.setattr("factory.materials.cards.material_from_moduli", refused)
    with pytest.raises(InputError, match=r"S0\.yaml: law ogden does not take the moduli of S0: bulk must be"):
        make_plan(tiny, "ogden", tmp_path)


def test_a_card_of_one_law_has_its_moduli_under_the_others(tmp_path: Path) -> None:
    content = yaml.safe_load((ROOT / "datasets" / "materials" / "S0.yaml").read_text())
    content["laws"] = {"neo-hookean": {"mu": 25e3, "lam": 5e6}}
    (tmp_path / "S0.yaml").write_text(yaml.safe_dump(content))
    card = load_card("S0", tmp_path)
    assert card.holds("neo-hookean")
    for law in LAWS:
        assert card.holds(law) == (law == "neo-hookean")
        shear, bulk = _moduli(law, dict(card.for_law(law).parameters))
        assert (shear, bulk) == pytest.approx((25e3, 5e6 + 2 * 25e3 / 3), rel=1e-9)


def _own_cards(folder: Path, *names: str) -> Path:
    """Write cards of user-defined materials, and a rig file beside them."""
    folder.mkdir(parents=True)
    text = (ROOT / "datasets" / "materials" / "S0.yaml").read_text()
    for name in names:
        (folder / f"{name}.yaml").write_text(text.replace("material: S0", f"material: {name}"))
    (folder / "rig.yaml").write_text("clamp-tilt: {}\n")
    return folder


def test_cards_of_other_names_are_the_levels(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = _own_cards(tmp_path / "my out" / "cards", "Eco", "Dragon")
    caplog.set_level("INFO")
    plan = make_plan(load_recipe("quick"), "neo-hookean", folder)
    assert plan.recipe.levels == ("Dragon", "Eco")
    assert [card.material for card in plan.cards] == ["Dragon", "Eco"]
    assert plan.identity["recipe"]["softness"] == ["Dragon", "Eco"]
    assert len(plan.pokes) == 2 * 2 * 2
    assert "has no card of the recipe's material levels (S0, S0.5, S1): its own cards" in caplog.text
    assert make_plan(load_recipe("quick"), "ogden", folder, levels=["Eco"]).recipe.levels == ("Eco",)


def test_some_cards_missing_is_an_error_with_a_way_on(tmp_path: Path) -> None:
    folder = _own_cards(tmp_path / "cards", "S0", "Eco")
    with pytest.raises(
        InputError, match=r"S0\.5\.yaml: no material card.*has Eco, S0: give --levels Eco,S0 "
    ):
        make_plan(load_recipe("quick"), "ogden", folder)
    with pytest.raises(
        InputError, match=r"material levels 'Eco', 'Eco': .*softness: expected different names"
    ):
        make_plan(load_recipe("quick"), "ogden", folder, levels=["Eco", "Eco"])
    with pytest.raises(InputError, match=r"material levels '\.\./Eco': key softness\.0: string should match"):
        make_plan(load_recipe("quick"), "ogden", folder, levels=["../Eco"])
    with pytest.raises(InputError, match=r"material levels '': key softness\.0: string should match"):
        make_plan(load_recipe("quick"), "ogden", folder, levels=[""])


def test_names_that_experiments_may_have_are_levels(tmp_path: Path) -> None:
    """`calibration.fit` names a card after its material."""
    folder = _own_cards(tmp_path / "cards", "Ecoflex 00-30", "gel (5%), old")
    assert split_names('Ecoflex 00-30, "gel (5%), old"') == ["Ecoflex 00-30", "gel (5%), old"]
    plan = make_plan(load_recipe("quick"), "ogden", folder)
    assert plan.recipe.levels == ("Ecoflex 00-30", "gel (5%), old")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mixture:", "mixture: : x", "not valid YAML"),
        ("laws:", "law_s:", "key laws: this key is missing"),
    ],
)
def test_a_card_that_cannot_be_read_is_not_passed_over(
    old: str, new: str, words: str, tmp_path: Path
) -> None:
    folder = _own_cards(tmp_path / "cards", "Eco", "Dragon")
    text = (folder / "Dragon.yaml").read_text()
    assert old in text
    (folder / "Dragon.yaml").write_text(text.replace(old, new))
    with pytest.raises(InputError, match=rf"Dragon\.yaml: .*{words}"):
        make_plan(load_recipe("quick"), "ogden", folder)


def _with_laws(folder: Path, name: str, laws: dict[str, Any]) -> None:
    content = yaml.safe_load((ROOT / "datasets" / "materials" / "S0.yaml").read_text())
    folder.mkdir(exist_ok=True)
    base = {"neo-hookean": content["laws"]["neo-hookean"]}
    (folder / f"{name}.yaml").write_text(
        yaml.safe_dump({**content, "material": name, "laws": {**base, **laws}}, sort_keys=False)
    )


def test_a_column_of_parameters_has_one_meaning(tiny: Recipe, tmp_path: Path, standin_build: Builder) -> None:
    """Whatever the order of the keys in the cards."""
    _with_laws(tmp_path / "cards", "a", {"yeoh": {"mu": 1e4, "stiffening": 0.05, "bulk": 2e5}})
    _with_laws(tmp_path / "cards", "b", {"yeoh": {"bulk": 6e5, "mu": 3e4, "stiffening": 0.07}})
    plan = make_plan(tiny, "yeoh", tmp_path / "cards", levels=["a", "b"])
    standin_build(plan, tmp_path / "s.zarr")
    data = open_dataset(tmp_path / "s.zarr")
    assert data.attributes["parameter_names"] == ["mu", "stiffening", "bulk"]
    expected = np.array([[1e4, 0.05, 2e5], [3e4, 0.07, 6e5]])[data.table["poke_softness"]]
    np.testing.assert_array_equal(data.table["parameter"], expected)


@pytest.mark.parametrize("order", [["one", "two"], ["two", "one"]])
def test_cards_may_have_different_numbers_of_terms(
    tiny: Recipe, tmp_path: Path, standin_build: Builder, order: list[str]
) -> None:
    _with_laws(tmp_path / "cards", "one", {})
    two = {"mu": [5e3, -2e3], "alpha": [3.0, -2.5], "bulk": 2e5}
    _with_laws(tmp_path / "cards", "two", {"ogden": two})
    plan = make_plan(tiny, "ogden", tmp_path / "cards", levels=order)
    standin_build(plan, tmp_path / "s.zarr")
    data = open_dataset(tmp_path / "s.zarr")
    assert data.attributes["parameter_names"] == ["mu_1", "mu_2", "alpha_1", "alpha_2", "bulk"]
    mu = load_card("one", tmp_path / "cards").for_law("neo-hookean").parameters["mu"]
    modulus = {"one": mu, "two": 0.5 * (5e3 * 3.0 + 2e3 * 2.5)}
    expected = [modulus[order[level]] for level in data.table["poke_softness"]]
    np.testing.assert_allclose(open_store(tmp_path / "s.zarr").modulus, expected)


def test_a_missing_card(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"S0\.yaml: no material card for material level S0"):
        make_plan(load_recipe("quick"), "ogden", tmp_path)
