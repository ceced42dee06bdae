"""Recipes with a loading course over time, and cards with parts beside the law."""

from __future__ import annotations

import re
from pathlib import Path

import factory
from tests.factory.conftest import ROOT, TINY

COURSE = """
  course:
    - {to_mm: 1, speed_mm_per_s: [1, 5]}
    - {hold_s: 10, frames: 4}
    - {to_mm: 0, speed_mm_per_s: 2}
    - {hold_s: 5, frames: 2}
"""
# simulated in seconds by tisim itself
SMALL = f"""
name: small
description: one indentation of a small viscous block
seed: 3
block_mm: [44, 44, 16]
rod: {{radius_mm: 2.5, length_mm: 40}}
friction: 0.6
protocol:
  shared_sites: 0
  own_sites: 1
  margin_mm: 20
  max_angle_deg: 10
  depth_mm: 1
  frame_spacing_mm: 0.5{COURSE}
softness: [S1-viscous]
border_mm: 5
cover_mm: 6
refinement: 0.5
shapes:
  - {{kind: cube, id: cube, side_mm: 8}}
"""
PROTOCOL = """
protocol:
  shared_sites: 1
  own_sites: 1
  margin_mm: 20
  max_angle_deg: 45
  depth_mm: 30
  frame_spacing_mm: 10
  course:
    - {to_mm: 30, speed_mm_per_s: [1, 20]}
    - {hold_s: 8, frames: 3}
    - {to_mm: 10, speed_mm_per_s: 5}
    - {to_mm: 20, speed_mm_per_s: 5}
    - {to_mm: 0, speed_mm_per_s: 5}
    - {hold_s: 4, frames: 2}
"""
# of a block so high that tissue is left above the inclusion at 30 mm
TIMED = re.sub(r"\nprotocol: .*\n", PROTOCOL, TINY).replace("[100, 100, 32]", "[100, 100, 60]")


def recipe(folder: Path, text: str = TIMED) -> factory.Recipe:
    path = folder / "recipe.yaml"
    path.write_text(text)
    return factory.load_recipe(path)


def card(folder: Path, text: str, name: str = "S1") -> Path:
    """Write a card with the keys of S1 and these; return its folder."""
    cards = folder / "cards"
    cards.mkdir(exist_ok=True)
    plain = (ROOT / "datasets" / "materials" / "S1.yaml").read_text()
    (cards / f"{name}.yaml").write_text(plain.replace("material: S1", f"material: {name}") + text + "\n")
    return cards


VISCOUS = "viscosity: {kind: prony, fractions: [0.2, 0.1], times_s: [1, 30], modulus: long-time}"
SOFTENING = "softening: {kind: ogden-roxburgh, r: 2, m_J_per_m3: 500, beta: 0.1}"
FIBRES = "fibres: {kind: holzapfel-gasser-ogden, direction: [1, 0, 0], k1_Pa: 5000, k2: 1}"
