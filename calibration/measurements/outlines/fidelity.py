"""Discretisation of a trial's beam: for a search, and for references."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from calibration.experiment.model import BeamTrial, beam_as_stated
from tisim import Beam, Material, Solver


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """Discretisation of a beam.

    Attributes
    ----------
    element : element type of `tisim.Beam`.
    axial_element_size : length of the elements along the beam [m].
    radial_elements : number of elements from the axis to the surface.
    solver : solver settings.
    """

    element: str = "default"
    axial_element_size: float = 0.007
    radial_elements: int = 2
    solver: Solver = field(default_factory=lambda: Solver(tolerance=1e-6))


# COARSE is for a search (14 core-ms per beam), REFERENCE for the comparison of bodies (`paper_table`). The
# number of iterations is small: a beam with an equilibrium takes 4, and one without costs 50 times as much
# anyway. The error of COARSE (up to 1.2 % of the deflection, oscillations of 10 to 20 micrometres along a
# strongly bent edge) is small and hardly depends on the material, but the likelihood of nine photographs is
# sensitive to it: it is corrected by the beams of `simulators.CORRECTING`. The error of REFERENCE is at most
# a fifth of it (15 micrometres on the 100 mm beam).
COARSE = Fidelity(radial_elements=1, solver=Solver(max_iterations=12))
REFERENCE = Fidelity(axial_element_size=0.00175, radial_elements=3, solver=Solver(max_iterations=12))


def beam_scene(trial: BeamTrial, material: Material, *, density: float, fidelity: Fidelity) -> Beam:
    """Scene of a trial as the lab states it; `density` [kg/m3] replaces the material's."""
    return beam_as_stated(
        trial,
        replace(material, density=density),
        element=fidelity.element,
        axial_element_size=fidelity.axial_element_size,
        radial_elements=fidelity.radial_elements,
        solver=fidelity.solver,
    )
