"""Materials by what people know of them: their small-strain moduli."""

from __future__ import annotations

from tisim import laws
from tisim.scene import Material


def material_from_moduli(law: str, *, shear: float, bulk: float, density: float = 1000.0) -> Material:
    """Material of the named law with these small-strain moduli [Pa] and density [kg/m3].

    Constants that small strains say nothing of stand at the law's plain default; see its `from_moduli`.
    """
    chosen = laws.get(law)
    parameters = chosen.from_moduli(shear, bulk)
    chosen.check(parameters)
    return Material(law=law, parameters=parameters, density=density)
