"""How a trial's beam is simulated: the beams that a search solves, and fine ones."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from calibration.experiment.model import BeamTrial
from tisim import Beam, Material, Solver


@dataclass(frozen=True, kw_only=True)
class Fidelity:
    """How beams are simulated in a search: `tisim.Beam`'s element, layer [m], rings and solver."""

    element: str = "default"
    layer: float = 0.007
    rings: int = 2
    solver: Solver = field(default_factory=lambda: Solver(tolerance=1e-6))


# The beams that a search solves (14 core-ms each), and those that bodies are compared by (`paper_table`). Few
# iterations: a beam that has an equilibrium takes 4, and one that has none costs 50 times as much anyway.
# What the search's mesh gets wrong (1.2 % of the deflection at most, waves of 10 to 20 micrometres along a
# strongly bent edge) is small and hardly depends on the material, but nine photographs' likelihood sees it:
# `simulators.CORRECTING` are the beams that correct it. The error of REFERENCE is a fifth of that at most (15
# micrometres on the 100 mm beam).
COARSE = Fidelity(rings=1, solver=Solver(max_iterations=12))
REFERENCE = Fidelity(layer=0.00175, rings=3, solver=Solver(max_iterations=12))


def beam_scene(trial: BeamTrial, material: Material, *, density: float, fidelity: Fidelity) -> Beam:
    """A trial as the lab states it, in a material; density [kg/m3] replaces the material's."""
    return Beam(
        material=replace(material, density=density),
        length=trial.free_length,
        section=trial.section,
        supports=trial.supports,
        grip_length=trial.grip_length,
        gravity=trial.gravity,
        tip_force=trial.tip_force,
        element=fidelity.element,  # type: ignore[arg-type]
        axial_element_size=fidelity.layer,
        radial_elements=fidelity.rings,
        solver=fidelity.solver,
    )
