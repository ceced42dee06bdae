"""Extended cards: effects of the material enter a dataset, faults of the rig and the camera do not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import tisim
from factory.build import app
from factory.errors import InputError
from factory.materials import load_card, material_of
from factory.plan import Plan, make_plan
from factory.reader import open_dataset
from factory.recipe import load_recipe
from tests.factory.conftest import ROOT, Builder

G, K = 10e3, 3e6


def effect(name: str, parameter: str, value: float, **more: Any) -> dict[str, Any]:
    entry = {
        "effect": name,
        "belongs_to": "specimen",
        "applies_to": "material",
        "scope": "all",
        "base_law": "neo-hookean",
        "parameters": {parameter: {"value": value, "sd": 0.1}},
        "valid_range": {"free_length_mm": [50.0, 150.0]},
        "rivals": ["taper"],
        "gain": {"held_out": "leave-one-length-out", "rms_mm_before": 0.4, "note": ""},
        "experiment_sha256": "0" * 64,
    }
    return {**entry, **more}


STIFFENING = effect("strain-stiffening", "c2_over_c1", 0.5)
CURVED = effect("residual-curvature", "curvature_per_m", 0.7, applies_to="shape", scope="S1-long")


def write_card(folder: Path, name: str, *effects: dict[str, Any]) -> Path:
    """Card of a mixture with G, K, a density of 1075 kg/m3, and effects."""
    content = yaml.safe_load((ROOT / "datasets" / "materials" / f"{name}.yaml").read_text())
    content["laws"]["neo-hookean"] = {"mu": G, "lam": K - 2 * G / 3}
    content["density"] = 1075.0
    if effects:
        content["effects"] = list(effects)
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def plan_of(tiny_file: Path, folder: Path, model: str = "neo-hookean") -> Plan:
    return make_plan(load_recipe(str(tiny_file)), model, folder)


def material(tmp_path: Path, *effects: dict[str, Any]) -> tisim.Material:
    write_card(tmp_path, "S1", *effects)
    return material_of(load_card("S1", tmp_path))


def moduli(material: tisim.Material) -> tuple[float, float]:
    found = tisim.laws.get(material.law).moduli(material.parameters)
    return found.shear_modulus, found.bulk_modulus


def test_a_plain_card_is_what_it_was(tmp_path: Path) -> None:
    plain = material(tmp_path)
    assert (plain.law, plain.parameters["mu"]) == ("neo-hookean", G)
    assert load_card("S1", tmp_path).effects == ()


def test_stiffening_is_yeohs_law(tmp_path: Path) -> None:
    made = material(tmp_path, STIFFENING)
    assert made.law == "yeoh"
    assert made.parameters == pytest.approx({"mu": G, "stiffening": 0.5, "bulk": K})
    assert made.density == 1075.0


def test_a_lower_poisson_ratio_is_a_lower_bulk_modulus(tmp_path: Path) -> None:
    made = material(tmp_path, STIFFENING, effect("compressibility", "poisson_drop", 0.1))
    before = (3 * K - 2 * G) / (6 * K + 2 * G)
    nu = before - 0.1
    assert moduli(made) == pytest.approx((G, 2 * G * (1 + nu) / (3 * (1 - 2 * nu))))
    assert made.parameters["stiffening"] == 0.5


def test_creep_keeps_the_modulus_at_one_second_and_density_its_excess(tmp_path: Path) -> None:
    made = material(
        tmp_path, effect("creep", "per_decade", 0.05), effect("density", "excess", 0.04, scope="S1")
    )
    assert made.law == "neo-hookean"
    assert moduli(made) == pytest.approx((G, K))
    assert made.density == pytest.approx(1.04 * 1075.0)


def test_other_extensions_keep_the_small_strain_moduli(tmp_path: Path) -> None:
    shared = material(tmp_path, effect("second-invariant", "c01_share", 0.3))
    assert moduli(shared) == pytest.approx((G, K))
    assert shared.parameters["c01"] == pytest.approx(0.3 * G / 2)
    locked = material(tmp_path, effect("limited-extensibility", "one_over_locking_stretch_squared", 0.16))
    assert moduli(locked) == pytest.approx((G, K))
    assert locked.law == "eight-chain"
    assert locked.parameters["locking"] == pytest.approx(2.5)


def test_what_belongs_to_a_form_or_to_one_specimen_is_left_out(tmp_path: Path) -> None:
    once = {**STIFFENING, "scope": "S1-long"}
    unknown = effect("mullins", "softening", 0.2)
    made = material(tmp_path, CURVED, once, unknown)
    assert made.law == "neo-hookean"
    reasons = [e.left_out("S1") for e in load_card("S1", tmp_path).effects]
    assert reasons[0] == "belongs to the beam's form"
    assert reasons[1].startswith("found in S1-long alone")
    assert reasons[2] == "no law of the static simulator has it"


OTHER_LAW = effect("law-form", "in_its_place", 1.0, becomes="law", rivals=[])


def card_of_another_law(folder: Path, name: str, *more: dict[str, Any]) -> Path:
    """Card whose diagnosis put Ogden's law in place of the neo-Hookean one."""
    path = write_card(folder, name, OTHER_LAW, *more)
    content = yaml.safe_load(path.read_text())
    content["law"] = "ogden"
    content["laws"]["ogden"] = {"mu": [2e3, 1e3], "alpha": [3.0, 14.0], "bulk": K}
    path.write_text(yaml.safe_dump(content))
    return path


def test_a_law_in_place_of_the_base_law_is_the_materials(tmp_path: Path) -> None:
    card_of_another_law(tmp_path, "S1")
    card = load_card("S1", tmp_path)
    made = material_of(card)
    assert (made.law, made.parameters["alpha"]) == ("ogden", (3.0, 14.0))
    assert material_of(card, "neo-hookean").law == "neo-hookean"  # what is asked for by name
    card_of_another_law(tmp_path, "S1", STIFFENING)
    with pytest.raises(InputError, match="extends neo-hookean by strain-stiffening"):
        material_of(load_card("S1", tmp_path))


BAD: list[tuple[dict[str, Any], str]] = [
    ({"belongs_to": "rig"}, "key effects.0.belongs_to: expected specimen"),
    ({"belongs_to": "camera"}, "key effects.0.belongs_to: expected specimen"),
    ({"belongs_to": "simulator"}, "must not enter a dataset"),
    ({"applies_to": "all"}, "key effects.0.applies_to: "),
    ({"base_law": "ogden"}, "key effects.0.base_law: expected neo-hookean, got ogden"),
    ({"parameters": {}}, "key effects.0.parameters: "),
    ({"parameters": {"alpha": {"value": 1.0, "sd": 0.1}}}, "expected c2_over_c1 of strain-stiffening"),
    ({"parameters": {"c2_over_c1": {"value": 0.5, "sd": -1.0}}}, "key effects.0.parameters.c2_over_c1.sd: "),
    ({"parameters": {"c2_over_c1": {"value": -0.5, "sd": 0.1}}}, "stiffening must not be negative, got -0.5"),
    ({"parameters": {"c2_over_c1": {"value": float("nan"), "sd": 0.1}}}, "finite"),
    ({"experiment_sha256": "abc"}, "key effects.0.experiment_sha256: "),
    ({"colour": "red"}, "key effects.0.colour: unknown key"),
]


@pytest.mark.parametrize(("change", "words"), BAD)
def test_bad_effects_end_in_one_sentence(change: dict[str, Any], words: str, tmp_path: Path) -> None:
    path = write_card(tmp_path, "S1", {**STIFFENING, **change})
    with pytest.raises(InputError) as caught:
        load_card("S1", tmp_path)
    assert str(caught.value).startswith(f"{path}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_two_laws_at_once_are_refused(tmp_path: Path, tiny_file: Path) -> None:
    shared = effect("second-invariant", "c01_share", 0.3)
    write_card(tmp_path, "S1", STIFFENING, shared)
    with pytest.raises(InputError, match=r"S1\.yaml: key effects\.1\..*another law than yeoh"):
        load_card("S1", tmp_path)
    write_card(tmp_path, "S0", shared)
    write_card(tmp_path, "S1", STIFFENING)
    with pytest.raises(InputError, match="material level S0 asks for the law mooney-rivlin and S1 for yeoh"):
        plan_of(tiny_file, tmp_path)


def test_a_dataset_takes_the_effects_over(tmp_path: Path, tiny_file: Path, standin_build: Builder) -> None:
    """The store's material has the effects, and a changed card is detected; simulated by the stand-in."""
    cards, target = tmp_path / "cards", tmp_path / "a.zarr"
    write_card(cards, "S0")
    write_card(cards, "S1", STIFFENING, CURVED)
    plan = plan_of(tiny_file, cards)
    assert [p.scene.material.law for p in plan.pokes] == ["yeoh"] * 4  # one set of parameters per dataset
    standin_build(plan, target)
    data = open_dataset(target)
    assert data.attributes["model"] == "yeoh"
    assert data.attributes["parameter_names"] == ["mu", "stiffening", "bulk"]
    np.testing.assert_allclose(data.table["parameter"][:, 1], [0.0, 0.0, 0.5, 0.5])
    np.testing.assert_allclose(data.table["parameter"][2:], [[G, 0.5, K]] * 2)
    assert set(data.table["law"]) == {6}
    stored = data.attributes["identity"]["materials"]
    assert [e["effect"] for e in stored["S1"]["effects"]] == ["strain-stiffening"]
    assert "effects" not in stored["S0"]
    write_card(cards, "S1", effect("strain-stiffening", "c2_over_c1", 0.6), CURVED)
    with pytest.raises(InputError, match=r"another plan \(changed: materials\.S1\.effects"):
        standin_build(plan_of(tiny_file, cards), target)


def test_a_form_changes_no_dataset(tmp_path: Path, tiny_file: Path) -> None:
    write_card(tmp_path, "S0")
    write_card(tmp_path, "S1")
    before = plan_of(tiny_file, tmp_path)
    write_card(tmp_path, "S1", CURVED)
    after = plan_of(tiny_file, tmp_path)
    assert (after.fingerprint, after.pokes) == (before.fingerprint, before.pokes)
    assert plan_of(tiny_file, tmp_path, "ogden").law == "ogden"


def command(tiny_file: Path, folder: Path, model: str, *more: str) -> tuple[int, str]:
    out = folder.parent / "out.zarr"
    arguments = ["--recipe", str(tiny_file), "--model", model, "--materials", str(folder), "--out", str(out)]
    ended = CliRunner().invoke(app, [*arguments, *more], env={"COLUMNS": "400"})
    assert not out.exists()
    return ended.exit_code, " ".join((ended.stdout + ended.stderr).split())


def test_the_dry_run_says_what_becomes_of_each_effect(tmp_path: Path, tiny_file: Path) -> None:
    cards = tmp_path / "cards"
    write_card(cards, "S0", effect("creep", "per_decade", 0.05))
    write_card(cards, "S1", STIFFENING, CURVED)
    code, text = command(tiny_file, cards, "neo-hookean", "--dry-run")
    assert code == 0, text
    assert "creep (per_decade 0.05 +- 0.1; equivalent to taper): taken over as the modulus at 1 s" in text
    assert (
        "strain-stiffening (c2_over_c1 0.5 +- 0.1; equivalent to taper): taken over as the law yeoh" in text
    )
    assert "not taken over: belongs to the beam's form" in text


def test_the_dry_run_names_the_model_of_a_law_that_was_found(tmp_path: Path, tiny_file: Path) -> None:
    cards = tmp_path / "cards"
    for name in ("S0", "S1"):
        card_of_another_law(cards, name)
    code, text = command(tiny_file, cards, "neo-hookean", "--dry-run")
    assert code == 0, text
    assert "not taken over: the card's law ogden has it: give --model ogden" in text
    code, text = command(tiny_file, cards, "ogden", "--dry-run")
    assert code == 0, text
    assert "law-form (in_its_place 1 +- 0.1): taken over as the card's law" in text


def test_another_law_is_refused_at_the_command_line(tmp_path: Path, tiny_file: Path) -> None:
    cards = tmp_path / "cards"
    write_card(cards, "S0")
    path = write_card(cards, "S1", STIFFENING)
    code, text = command(tiny_file, cards, "ogden")
    assert code == 2
    assert f"{path}: --model ogden: the card of S1 extends neo-hookean by strain-stiffening" in text
    assert "give --model neo-hookean, or delete key effects" in text


def test_a_rigs_fault_in_a_card_is_refused_at_the_command_line(tmp_path: Path, tiny_file: Path) -> None:
    cards = tmp_path / "cards"
    write_card(cards, "S0")
    path = write_card(cards, "S1", effect("clamp-tilt", "angle_deg", 1.0, belongs_to="rig"))
    code, text = command(tiny_file, cards, "neo-hookean")
    assert code == 2
    assert f"{path}: key effects.0.belongs_to: expected specimen" in text
