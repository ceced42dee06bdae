"""Simulated scene of a measured indentation: contact point, travel to first touch, geometry."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.errors import InputError
from calibration.experiment.model import PokeTrial, Vector
from tisim import Block, Material, Poke, Rod, material_from_moduli

Array = NDArray[np.float64]

# A start within this distance of the top counts as on it [m].
ON_TOP = 1e-5
# Radius of a flat indenter's round edge over its radius, as in `tisim.Rod`; the data format does not have it.
EDGE = 0.4
FRICTION = 0.6  # assumed coefficient of friction between indenter and block
BULK_RATIO = 300.0  # fixed K/G, since indentations by one indenter do not separate it from the modulus
SPACING = 0.125e-3  # spacing of frames [m]: about five per period of the mesh error
SHEAR = 1e4  # shear modulus of simulated indentations [Pa]; the force is proportional to it


def approach(trial: PokeTrial) -> float:
    """Travel from the start of a record to first touch.

    Returns
    -------
    float
        Travel [m]: 0 for a start on the block's top, from which depth is counted; for a start above it, the
        way along the indenter's axis to where its tip touches, a tilted one with its rim.

    Raises
    ------
    InputError
        If the start is inside the block.
    """
    above = trial.start[2] - trial.block.size[2]
    if above < -ON_TOP:
        raise InputError(
            f"trial {trial.id}: start_mm: expected a start on or above the block's top, got one"
            f" {-above * 1e3:.3g} mm below it"
        )
    if above <= ON_TOP:
        return 0.0
    down = abs(trial.direction[2])
    return max(0.0, (above - _rod(trial).reach(down)) / down)


def _site(trial: PokeTrial) -> tuple[float, float]:
    """Contact point: intersection (x, y) of the indenter's axis with the plane of the block's top [m]."""
    way = (trial.start[2] - trial.block.size[2]) / abs(trial.direction[2])
    return trial.start[0] + way * trial.direction[0], trial.start[1] + way * trial.direction[1]


def _rod(trial: PokeTrial, edge_radius: float | None = None) -> Rod:
    edge = EDGE * trial.rod_radius if edge_radius is None else edge_radius
    return Rod(radius=trial.rod_radius, tip=trial.rod_tip, edge_radius=edge)


def poke_scene(
    trial: PokeTrial,
    material: Material,
    *,
    depth: float,
    friction: float = FRICTION,
    refinement: float = 1.0,
    edge_radius: float | None = None,
) -> Poke:
    """Scene of a trial, with the indenter's axis through the record's start.

    Parameters
    ----------
    trial : the trial.
    material : material of the block.
    depth : depth from first touch [m].
    friction : coefficient of friction between indenter and block.
    refinement : refinement of the mesh, as in `tisim.Poke`.
    edge_radius : radius of the edge of a flat indenter [m]; None for 0.4 of its radius.

    Raises
    ------
    InputError
        If the inclusion is given as a mesh, which `Poke` does not support.
    """
    if trial.inclusion_mesh is not None:
        raise InputError(
            f"trial {trial.id}: inclusion.mesh: expected a sphere, box or cylinder; a mesh cannot be fitted"
        )
    return Poke(
        material=material,
        site=_site(trial),
        direction=trial.direction,
        depth=depth,
        block=trial.block,
        rod=_rod(trial, edge_radius),
        friction=friction,
        frame_spacing=max(min(0.5e-3, depth / 6.0), 1e-5),
        refinement=refinement,
    )


def block_names(trial: PokeTrial) -> tuple[str, str]:
    """Names of a trial's block for reports: by size, and by material and size."""
    size = " x ".join(f"{1e3 * x:g}" for x in trial.block.size)
    return f"block {size} mm", f"{trial.material} block {size} mm"


@dataclass(frozen=True, kw_only=True)
class Geometry:
    """All parameters of the force over the shear modulus. Indentations of equal geometry share a simulation.

    Attributes
    ----------
    block, rod : block and indenter.
    site : contact point on the block's top, x and y [m].
    direction : direction of the indenter's travel.
    friction : coefficient of friction between indenter and block.
    refinement : factor on the refinement of all its meshes.
    """

    block: Block
    rod: Rod
    site: tuple[float, float]
    direction: Vector
    friction: float = FRICTION
    refinement: float = 1.0

    @property
    def axis(self) -> Array:
        """Unit vector of the indenter's travel, shape (3,)."""
        axis = np.asarray(self.direction, dtype=float)
        return np.asarray(axis / np.linalg.norm(axis))

    @property
    def across(self) -> Array:
        """Unit vectors across the indenter, shape (2, 3).

        The first is in the plane of its tilt (of x and z if it is upright).
        """
        axis = self.axis
        level = np.array([axis[0], axis[1], 0.0])
        first = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(level) < 1e-9 else level
        first = first - (first @ axis) * axis
        first /= np.linalg.norm(first)
        return np.stack([first, np.cross(axis, first)])

    def scene(self, depth: float, *, refinement: float = 1.0) -> Poke:
        """Scene of the baseline to a depth [m]. refinement : refinement of the mesh."""
        return Poke(
            material=reference_material(),
            site=self.site,
            direction=self.direction,
            depth=depth,
            block=self.block,
            rod=self.rod,
            friction=self.friction,
            frame_spacing=max(min(SPACING, depth / 6.0), 1e-5),
            refinement=refinement * self.refinement,
        )


def reference_material() -> Material:
    """Material of simulated indentations; forces scale with the shear modulus."""
    return material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=BULK_RATIO * SHEAR)


def geometry_of(
    trial: PokeTrial,
    *,
    friction: float = FRICTION,
    edge_radius: float | None = None,
    refinement: float = 1.0,
) -> Geometry:
    """Geometry of a trial; parameters as in `poke_scene` and `Geometry`.

    InputError for an inclusion given as a mesh, which `Poke` does not support.
    """
    scene = poke_scene(trial, reference_material(), depth=1e-3, friction=friction, edge_radius=edge_radius)
    return Geometry(
        block=scene.block,
        rod=scene.rod,
        site=(round(scene.site[0], 9), round(scene.site[1], 9)),
        direction=trial.direction,
        friction=friction,
        refinement=refinement,
    )
