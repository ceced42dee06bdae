"""Derives the first material cards from the one thing the paper prints about stiffness.

The paper gives no parameters. Its table of dataset features gives, for Mooney-Rivlin, the mean depth and
the mean force of all snapshots of each mixture. A flat punch of radius a on an incompressible half space
pushes back with F = 2 a E d / (1 - nu^2), nu = 1/2; so E = (3/4) F_mean / (2 a Tip_mean), and the shear
modulus is E / 3. All six laws get this same small-strain shear modulus.

Run from the repository's root: `python datasets/materials/derive.py` rewrites the cards (--check only
compares).
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import yaml

# mixture: softener parts, Tip_mean [mm], F_mean [N] of the paper's Mooney-Rivlin rows, profile code
TABLE = {"S0": ("0", 7.91, 4.80, 0.8), "S0.5": ("0.5", 7.94, 2.33, 0.4), "S1": ("1", 7.82, 1.42, 0.0)}
ROD_RADIUS = 2.5e-3  # m, from the paper
BULK_RATIO = 20.0  # K / mu: assumed
OGDEN_ALPHA = 3.0  # assumed
C01_SHARE = 0.2  # of c10 + c01: assumed
LOCKING = 8**0.5  # what SOFA has built in

PROVENANCE = """\
Derived from the paper's table of dataset features, Mooney-Rivlin row of this mixture:
Tip_mean = {depth} mm, F_mean = {force} N. Flat punch on an incompressible half space,
F = 2 a E d / (1 - nu^2) with a = 2.5 mm and nu = 1/2, gives E = {E:.1f} kPa and a shear modulus
mu = E / 3 = {G:.2f} kPa, which all six laws share at small strain. Assumed: bulk modulus K = 20 mu;
Ogden with one term, alpha = 3; Mooney-Rivlin with c01 = 0.2 (c10 + c01); Arruda-Boyce with a locking
stretch of sqrt(8), as in SOFA. Written by datasets/materials/derive.py."""

UNCERTAINTY = """\
The forces are means over depth, over angles up to 45 degrees and over sites with and without an
inclusion below, of plain 4-node meshes: locking makes these 15 to 50 % too stiff, the finite block (32 mm)
and large strain stiffen the answer further, the oblique angles soften it; the paper's Ogden forces would
give 16 to 36 % more (S0, S0.5) or 21 % less (S1). The shape of the law beyond small strain is assumed,
not fitted."""


def card(name: str) -> dict[str, Any]:
    """The card of one mixture."""
    parts, depth, force, code = TABLE[name]
    young = 0.75 * force / (2 * ROD_RADIUS * depth * 1e-3)
    mu = young / 3
    bulk = BULK_RATIO * mu
    lame = {"mu": _round(mu), "lam": _round(bulk - 2 * mu / 3)}
    coefficients = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)
    series = sum(i * c * 3.0 ** (i - 1) / LOCKING ** (2 * i - 2) for i, c in enumerate(coefficients, start=1))
    return {
        "material": name,
        "mixture": f"Eurosil 4, A : B : softener = 1 : 1 : {parts} by weight",
        "derived": True,
        "provenance": PROVENANCE.format(depth=depth, force=force, E=young / 1e3, G=mu / 1e3),
        "uncertainty": {"shear_modulus_low": -0.4, "shear_modulus_high": 0.4, "text": UNCERTAINTY},
        "density": 1000.0,
        "stiffness": code,
        "laws": {
            "st-venant-kirchhoff": dict(lame),
            "neo-hookean": dict(lame),
            "stable-neo-hookean": dict(lame),
            "mooney-rivlin": {
                "c10": _round((1 - C01_SHARE) * mu / 2),
                "c01": _round(C01_SHARE * mu / 2),
                "bulk": _round(bulk),
            },
            "ogden": {"mu": [_round(2 * mu / OGDEN_ALPHA)], "alpha": [OGDEN_ALPHA], "bulk": _round(bulk)},
            "arruda-boyce": {
                "mu": _round(mu / (2 * series)),
                "locking": round(LOCKING, 6),
                "bulk": _round(bulk),
            },
        },
    }


def _round(value: float) -> float:
    return float(f"{value:.5g}")


class _Dumper(yaml.SafeDumper):
    """Long texts as blocks, numbers of a series on one line."""


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.Node:
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None)


_Dumper.add_representer(str, _text)


def card_text(name: str) -> str:
    """The card as YAML; moduli in Pa, density in kg/m3."""
    body = yaml.dump(card(name), Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=200)
    return f"# Moduli in Pa, density in kg/m3. Derived, not calibrated: see provenance.\n{body}"


def main() -> int:
    folder = Path(__file__).parent
    differs = 0
    for name in TABLE:
        path = folder / f"{name}.yaml"
        if "--check" in sys.argv[1:]:
            differs += not path.is_file() or path.read_text(encoding="utf-8") != card_text(name)
        else:
            path.write_text(card_text(name), encoding="utf-8")
    return 1 if differs else 0


if __name__ == "__main__":
    sys.exit(main())
