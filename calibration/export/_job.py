"""Input of a target, and the losses that it states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calibration.export._convert import Conversion
from calibration.export._forms import Form
from calibration.export._scene import BeamScene, Prediction
from tisim import Material

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Job:
    """A card for one program, SI.

    Attributes
    ----------
    name : str
        Of the material.
    material : Material
        As the card has it, with its parts; its law's moduli are long-time ones.
    conversion : Conversion
        What the program gets for the law.
    keeps : frozenset of str
        Those of "viscosity", "softening", "fibres" that the material has and the program takes.
    scene : BeamScene, optional
        The beam; None where it is not asked for.
    prediction : Prediction, optional
        What to expect of it.
    """

    name: str
    material: Material
    conversion: Conversion
    keeps: frozenset[str]
    scene: BeamScene | None = None
    prediction: Prediction | None = None

    @property
    def form(self) -> Form:
        """The strain energy that the program gets."""
        return self.conversion.form

    @property
    def docstring(self) -> str:
        """Names of material and beam, as they can stand in the docstring of a Python scene."""
        name = self.name if self.scene is None else f"{self.name}: {self.scene.name}"
        return name.replace("\\", "/").replace('"', "'")


@dataclass(frozen=True, kw_only=True)
class Written:
    """Output of a target.

    Attributes
    ----------
    files : dict of Path to str
        Files, and what each is.
    run : str
        The command that runs the scene, "" without one.
    remarks : tuple of str
        Sentences on what is lost beyond law, parts and mesh.
    """

    files: dict[Path, str]
    run: str = ""
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Target:
    """A program that a card can be exported to.

    Attributes
    ----------
    name : str
        On the command line: lower case, digits and hyphens.
    title : str
        What people call it, with the version that the files are for.
    writes : callable (Form, Material) -> Form or None
        A strain energy as the program has it (with its own volumetric part); None where it has none such.
        The material says what else has to go with it.
    keeps : callable (Material, Form) -> set of str
        Which of the material's parts ("viscosity", "softening", "fibres") go along with that form.
    write : callable (Job, Path) -> Written
        Writes the files into a folder that is there.
    element : "tet10" or "tet4"
        Of the scene's mesh.
    element_error : float
        Of a "tet10" scene: how far the program's element may be from tisim's on the same mesh, a fraction
        of the beam's displacement, at refinement 1; coarser, it grows with the cube of the element size.
        Linear ones are simulated by tisim instead.
    most_poisson : float, optional
        Larger Poisson's ratios are lowered to this one, Young's modulus kept: plain linear tetrahedra lock.
    tip_force : bool
        Whether its scenes have one.
    check : callable (Path) -> ndarray of shape (n, 3), optional
        Runs the scene of a folder, and gives the displacement of its nodes in the mesh's order [m];
        InputError where the program is not installed.
    results : tuple of str
        Names of the files that a run leaves beside the scene; a new export into the folder removes them.
    """

    name: str
    title: str
    writes: Callable[[Form, Material], Form | None]
    keeps: Callable[[Material, Form], set[str]]
    write: Callable[[Job, Path], Written]
    element: str = "tet10"
    element_error: float = 0.0
    most_poisson: float | None = None
    tip_force: bool = True
    check: Callable[[Path], Array] | None = None
    results: tuple[str, ...] = ()

    def element_share(self, refinement: float) -> float:
        """`element_error` on a mesh of that refinement; 0 for linear elements."""
        return self.element_error * max(1.0, 1.0 / refinement) ** 3 if self.element == "tet10" else 0.0
