"""What of a poke decides its force over the shear modulus: block, rod, site and direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import PokeTrial, Vector
from calibration.pokes import poke_scene
from tisim import Block, Material, Poke, Rod, material_from_moduli

Array = NDArray[np.float64]

FRICTION = 0.6  # the belief, as in `calibration.pokes`
BULK_RATIO = 300.0  # K/G: held, since no poke of one rod tells it from the modulus
SPACING = 0.125e-3  # of frames [m]: some five a wave of the mesh's error
SHEAR = 1e4  # at which pokes are simulated [Pa]; the force is in proportion


@dataclass(frozen=True, kw_only=True)
class Geometry:
    """Pokes alike in it share a simulation."""

    block: Block
    rod: Rod
    site: tuple[float, float]
    direction: Vector

    @property
    def axis(self) -> Array:
        """Unit vector of the push."""
        axis = np.asarray(self.direction, dtype=float)
        return np.asarray(axis / np.linalg.norm(axis))

    @property
    def across(self) -> Array:
        """(2, 3): unit vectors across the rod, the first in the plane of its tilt (of x and z if upright)."""
        axis = self.axis
        level = np.array([axis[0], axis[1], 0.0])
        first = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(level) < 1e-9 else level
        first = first - (first @ axis) * axis
        first /= np.linalg.norm(first)
        return np.stack([first, np.cross(axis, first)])

    def scene(self, depth: float, *, refinement: float = 1.0) -> Poke:
        """The baseline's poke to `depth` [m], on a mesh so much finer."""
        return Poke(
            material=material(),
            site=self.site,
            direction=self.direction,
            depth=depth,
            block=self.block,
            rod=self.rod,
            friction=FRICTION,
            frame_spacing=max(min(SPACING, depth / 6.0), 1e-5),
            refinement=refinement,
        )


def material() -> Material:
    return material_from_moduli("neo-hookean", shear=SHEAR, bulk=BULK_RATIO * SHEAR)


def geometry_of(trial: PokeTrial) -> Geometry:
    """InputError for an inclusion given as a mesh, which a poke cannot take."""
    scene = poke_scene(trial, material(), depth=1e-3)
    return Geometry(
        block=scene.block,
        rod=scene.rod,
        site=(round(scene.site[0], 9), round(scene.site[1], 9)),
        direction=trial.direction,
    )
