"""Materials: a constitutive law with its parameters, and parts with time, damage and fibres. SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from tisim import laws, parts
from tisim._checks import check_positive


@dataclass(frozen=True, kw_only=True)
class Material:
    """A constitutive law with its parameters, and optional viscosity, softening and fibres.

    `tisim.parts` states how they combine.

    Attributes
    ----------
    law : str
        A name in `tisim.laws.all_names()`.
    parameters : mapping
        Parameters by name, as in the law's docstring, moduli in Pa; a tuple for a series (Ogden).
    density : float
        Rest density [kg/m3].
    viscosity : tisim.parts.Viscosity, optional
        Relaxation of the isochoric stress (`tisim.Prony`).
    softening : tisim.parts.Softening, optional
        Softening by the largest energy so far (`tisim.OgdenRoxburgh`).
    fibres : tisim.parts.Fibres, optional
        One family of fibres (`tisim.HolzapfelGasserOgden`).
    """

    law: str
    parameters: Mapping[str, float | tuple[float, ...]]
    density: float = 1000.0
    viscosity: parts.Viscosity | None = None
    softening: parts.Softening | None = None
    fibres: parts.Fibres | None = None

    @property
    def has_parts(self) -> bool:
        """True if the material has viscosity, softening or fibres in addition to its law."""
        return bool(parts.of(self))

    @property
    def remembers(self) -> bool:
        """True if the stress depends on the history of deformation."""
        return self.viscosity is not None or self.softening is not None


def material_from_moduli(
    law: str, *, shear_modulus: float, bulk_modulus: float, density: float = 1000.0
) -> Material:
    """Material of a law with given small-strain moduli.

    Constants that do not affect the small-strain moduli have the default of the law's `from_moduli`.

    Parameters
    ----------
    law : str
        A name in `tisim.laws.all_names()`.
    shear_modulus, bulk_modulus : float
        Small-strain moduli [Pa].
    density : float
        Rest density [kg/m3].

    Returns
    -------
    Material

    Raises
    ------
    ValueError
        For an unknown law, or moduli or a density that no material or not this law can have.
    """
    chosen = laws.get(law)
    check_positive("shear_modulus", shear_modulus, "a modulus above 0 Pa")
    check_positive("bulk_modulus", bulk_modulus, "a modulus above 0 Pa")
    check_positive("density", density, "a density above 0 kg/m3")
    parameters = chosen.from_moduli(shear_modulus, bulk_modulus)
    chosen.check(parameters)
    return Material(law=law, parameters=parameters, density=density)
