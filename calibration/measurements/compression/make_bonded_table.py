"""Compute the bonded-to-free force ratio of cylinders by finite elements; write `_bonded_table.py`.

    python -m calibration.measurements.compression.make_bonded_table        # four core-minutes

The table has the logarithm of the force of a bonded cylinder (`tisim.Press`) over that of a free one of the
same law (homogeneous): for several diameter-to-height ratios for the neo-Hookean law, and at the reference
ratio for other laws.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import tisim
from calibration.measurements.homogeneous import nominal_stress
from tisim.io.whole import write_whole

FILE = Path(__file__).with_name("_bonded_table.py")
STRAINS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.63, 0.66, 0.69)
SHEAR = 1e4
BULK_RATIO = 1000.0  # K/G of 3000 changes the logarithm by less than 0.005 to 60 %
HEIGHT = 0.03
REFERENCE = 5.0 / 3.0  # diameter over height
SLENDER = (0.8, 1.2, REFERENCE, 2.3)
LONGEST = 0.75  # largest chain stretch over the locking stretch
AMPLITUDES = {
    "strain-stiffening": (0.03, 0.08, 0.15, 0.3, 0.6, 1.2),
    "second-invariant": (-0.2, -0.1, 0.2, 0.4, 0.7, 1.0),
    "limited-extensibility": (0.02, 0.05, 0.1, 0.2, 0.35),
}
HEADING = '''"""Logarithm of bonded over free force, made by `make_bonded_table.py`; nan: no equilibrium."""

# fmt: off
from math import nan

STRAINS = {strains}
REFERENCE = {reference!r}
# by diameter over height, Neo-Hookean
SLENDER: dict[float, tuple[float, ...]] = {{
{slender}}}
# by effect and amplitude, at REFERENCE
LAWS: dict[str, dict[float, tuple[float, ...]]] = {{
{laws}}}
'''


def material(effect: str | None, amplitude: float) -> tisim.Material:
    """Law of `tisim` that corresponds to an effect of homogeneous tests, with the shear modulus SHEAR."""
    bulk = BULK_RATIO * SHEAR
    if effect == "strain-stiffening":
        return tisim.Material(law="yeoh", parameters={"mu": SHEAR, "stiffening": amplitude, "bulk": bulk})
    if effect == "second-invariant":
        half = 0.5 * SHEAR
        parameters = {"c10": half * (1.0 - amplitude), "c01": half * amplitude, "bulk": bulk}
        return tisim.Material(law="mooney-rivlin", parameters=parameters)
    if effect == "limited-extensibility":
        chains = {"mu": SHEAR, "locking": amplitude**-0.5, "bulk": bulk}
        return tisim.Material(law="eight-chain", parameters=chains)
    return tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=bulk)


def log_ratio(law: tisim.Material, slender: float) -> NDArray[np.float64]:
    """ln(bonded / free force) at STRAINS; NaN from the first strain without an equilibrium."""
    stretches = 1.0 - np.array(STRAINS)
    scene = tisim.Press(
        material=law, radius=0.5 * slender * HEIGHT, height=HEIGHT, stretches=tuple(stretches)
    )
    (result,) = tisim.simulate([scene], workers=1)
    found = np.full(len(STRAINS), np.nan)
    assert result.nominal_stress is not None
    reached = len(result.nominal_stress)
    free = nominal_stress(law, "uniaxial", stretches)
    found[:reached] = np.log(result.nominal_stress / free[:reached])
    print(slender, law.law, f"to strain {STRAINS[reached - 1]:g}", np.round(found, 3), flush=True)
    return found


def short_of_ends(effect: str, amplitude: float, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values with NaN where the chain stretch of the free cylinder exceeds LONGEST.

    At bonded ends the chains are then beyond the range of the law.
    """
    if effect != "limited-extensibility":
        return values
    stretches = 1.0 - np.array(STRAINS)
    first_invariant = stretches**2 + 2.0 / stretches
    return np.where(amplitude * first_invariant / 3.0 <= LONGEST**2, values, np.nan)


def main() -> None:
    slender = {x: log_ratio(material(None, 0.0), x) for x in SLENDER}
    laws = {
        name: {a: short_of_ends(name, a, log_ratio(material(name, a), REFERENCE)) for a in amplitudes}
        for name, amplitudes in AMPLITUDES.items()
    }
    text = HEADING.format(
        strains=STRAINS,
        reference=REFERENCE,
        slender="".join(f"    {x!r}: {_row(v)},\n" for x, v in slender.items()),
        laws="".join(
            f'    "{n}": {{\n' + "".join(f"        {a!r}: {_row(v)},\n" for a, v in rows.items()) + "    },\n"
            for n, rows in laws.items()
        ),
    )
    write_whole(FILE, text)


def _row(values: NDArray[np.float64]) -> str:
    """Format a row of the table in two lines."""
    cells = ["nan" if np.isnan(v) else f"{v:.4f}" for v in values]
    half = len(cells) // 2
    return "(" + ", ".join(cells[:half]) + ",\n            " + ", ".join(cells[half:]) + ")"


if __name__ == "__main__":
    main()
