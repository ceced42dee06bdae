"""Parts beside the law in material cards."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

import tisim
from factory.materials import Card, load_card, material_of

CARDS = Path(__file__).parents[3] / "datasets" / "materials"
PRONY = {"kind": "prony", "modulus": "long-time", "fractions": [0.2, 0.1], "times": [1.0, 30.0]}
MULLINS = {"kind": "ogden-roxburgh", "r": 2.0, "m": 1000.0, "beta": 0.1}
FIBRES = {"kind": "holzapfel-gasser-ogden", "direction": [0.8, 0.6, 0.0], "k1": 1e4, "k2": 0.5}


def card(folder: Path, parts: dict[str, Any], **more: object) -> Card:
    name = sorted(CARDS.glob("*.yaml"))[0].stem
    content = yaml.safe_load((CARDS / f"{name}.yaml").read_text())
    (folder / f"{name}.yaml").write_text(yaml.safe_dump({**content, **parts, **more}))
    return load_card(name, folder)


def test_a_card_brings_its_parts_to_any_law(tmp_path: Path) -> None:
    found = card(tmp_path, {"viscosity": PRONY, "softening": MULLINS, "fibres": FIBRES})
    for law in ("neo-hookean", "ogden"):
        made = found.for_law(law)
        assert made.viscosity == tisim.Prony(fractions=(0.2, 0.1), times=(1.0, 30.0))
        assert made.softening == tisim.OgdenRoxburgh(r=2.0, m=1000.0, beta=0.1)
        assert made.fibres == tisim.HolzapfelGasserOgden(direction=(0.8, 0.6, 0.0), k1=1e4, k2=0.5)
    assert material_of(found).viscosity is not None


def test_effects_leave_parts_alone(tmp_path: Path) -> None:
    effect = {
        "effect": "strain-stiffening",
        "belongs_to": "specimen",
        "applies_to": "material",
        "scope": "all",
        "base_law": "neo-hookean",
        "parameters": {"c2_over_c1": {"value": 0.5, "sd": 0.1}},
        "experiment_sha256": "0" * 64,
    }
    made = material_of(card(tmp_path, {"viscosity": PRONY}, effects=[effect]))
    assert made.law == "yeoh"
    assert made.viscosity is not None
