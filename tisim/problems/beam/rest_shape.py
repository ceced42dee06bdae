"""Imperfect beams on the ideal prism's mesh: rest shape, and stiffness and density by quadrature point.

Sparsity and symbolic factor are those of the ideal beam; only the quadrature differs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tisim.bodies import Circle
from tisim.discretisation.quadrature import reference
from tisim.mesh import Mesh
from tisim.scene import Beam, ClampImperfections, Imperfections, Void

if TYPE_CHECKING:  # scipy is imported when a scene is solved
    from tisim.discretisation.body import Discretisation

Array = NDArray[np.float64]


def is_ideal(scene: Beam) -> bool:
    """True if neither the specimen nor the clamps have imperfections."""
    return ideal_specimen(scene.imperfections) and scene.clamp_imperfections == ClampImperfections()


def is_planar(scene: Beam) -> bool:
    """True if loads and fibres have the mirror plane y = 0, so that half a beam suffices."""
    if scene.material.fibres is not None:
        along = np.abs(scene.material.fibres.axis())
        if along[1] > 1e-9 and max(along[0], along[2]) > 1e-9:
            return False
    return scene.gravity[1] == 0.0 and scene.tip_force[1] == 0.0


def ideal_specimen(specimen: Imperfections) -> bool:
    """True for the ideal prism; depth of an absent skin and position of an absent void are ignored."""
    void = specimen.void if specimen.void is not None and specimen.void.fraction else None
    depth = specimen.skin_thickness if specimen.skin else Imperfections().skin_thickness
    return replace(specimen, void=void, skin_thickness=depth) == Imperfections()


def rest_positions(scene: Beam, mesh: Mesh) -> Array:
    """Stress-free node positions of a beam out of its clamps [m], shape (n, 3).

    Parameters
    ----------
    scene : Beam
    mesh : Mesh
        The result's mesh, or any mesh of the ideal prism, x from 0 to scene.length. Parts beyond the ends (in
        the grips) continue straight.
    """
    specimen = scene.imperfections
    x, y, z = mesh.nodes.T
    inside = np.clip(x, 0.0, scene.length)
    size = scale(scene, inside)
    nodes = np.column_stack([x, size * y, size * z])
    if specimen.curvature == 0.0:
        return nodes
    angle = specimen.curvature * inside
    beyond = x - inside
    axis = np.column_stack([np.sin(angle), 1.0 - np.cos(angle)]) / specimen.curvature
    nodes[:, 0] = axis[:, 0] - nodes[:, 2] * np.sin(angle) + beyond * np.cos(angle)
    nodes[:, 2] = axis[:, 1] + nodes[:, 2] * np.cos(angle) + beyond * np.sin(angle)
    return nodes


def scale(scene: Beam, x: Array) -> Array:
    """Size of the section at x [m], relative to the ideal one: 1 + taper (x - L/2)."""
    return np.asarray(1.0 + scene.imperfections.taper * (x - 0.5 * scene.length))


def specimen_discretisation(scene: Beam, discretisation: Discretisation) -> Discretisation:
    """The ideal beam's discretisation with the imperfect specimen's quadrature; itself for an ideal one."""
    specimen = scene.imperfections
    if ideal_specimen(specimen):
        return discretisation
    changes: dict[str, object] = {}
    if specimen.curvature or specimen.taper:
        rest = replace(discretisation.mesh, nodes=rest_positions(scene, discretisation.mesh))
        changes["reference"] = reference(rest)
    points = np.einsum(
        "qa,eai->eqi",
        discretisation.reference.values,
        discretisation.mesh.nodes[discretisation.mesh.elements],
    )
    x, _, z = np.moveaxis(points, 2, 0)
    stiffness = along(scene, x) * (1.0 + specimen.transverse_gradient * z)
    if specimen.skin:
        stiffness = stiffness * _skin(scene, points, discretisation.reference.weights)
    if specimen.axial_gradient or specimen.transverse_gradient or specimen.skin or specimen.void:
        changes["stiffness"] = np.ascontiguousarray(stiffness)
    if specimen.density_gradient or specimen.void:
        changes["density"] = np.ascontiguousarray(heaviness(scene, x))
    return replace(discretisation, **changes)  # type: ignore[arg-type]


def along(scene: Beam, x: Array) -> Array:
    """Factor of the modulus at x [m], from the axial gradient and the void."""
    gradient = scene.imperfections.axial_gradient
    return np.asarray(
        (1.0 + gradient * (x - 0.5 * scene.length)) * (1.0 - missing(scene.imperfections.void, x))
    )


def heaviness(scene: Beam, x: Array) -> Array:
    """Factor of the density at x [m], from the density gradient and the void."""
    gradient = scene.imperfections.density_gradient
    return np.asarray(
        (1.0 + gradient * (x - 0.5 * scene.length)) * (1.0 - missing(scene.imperfections.void, x))
    )


def missing(void: Void | None, x: Array) -> Array:
    """Fraction of the section that the void removes at x [m]."""
    if void is None:
        return np.zeros_like(x)
    beyond = np.abs(x - void.position) - 0.5 * (void.length - void.edge)
    phase = np.clip(beyond / void.edge, 0.0, 1.0)
    return np.asarray(0.5 * void.fraction * (1.0 + np.cos(np.pi * phase)))


def skin_factors(scene: Beam) -> tuple[float, float, float]:
    """Ratios of the section's stiffness with and without skin: stretching, bending about y and about z."""
    excess, depth = scene.imperfections.skin, scene.imperfections.skin_thickness
    if isinstance(scene.section, Circle):
        core = 1.0 - depth / scene.section.radius
        bending = 1.0 + excess * (1.0 - core**4)
        return 1.0 + excess * (1.0 - core**2), bending, bending
    wide, high = 1.0 - 2.0 * depth / scene.section.width, 1.0 - 2.0 * depth / scene.section.height
    return (
        1.0 + excess * (1.0 - wide * high),
        1.0 + excess * (1.0 - wide * high**3),
        1.0 + excess * (1.0 - wide**3 * high),
    )


def skin_profile(scene: Beam) -> tuple[float, float, float]:
    """Coefficients (c0, cy, cz) of a stiffness c0 + cy (y/b)^2 + cz (z/h)^2 that has the `skin_factors`.

    b and h are the half width and half height (the radius of a circle). The moments are those of the
    continuous section.
    """
    if isinstance(scene.section, Circle):
        square, fourth, mixed = 1.0 / 4.0, 1.0 / 8.0, 1.0 / 24.0
    else:
        square, fourth, mixed = 1.0 / 3.0, 1.0 / 5.0, 1.0 / 9.0
    stretching, about_y, about_z = skin_factors(scene)
    matrix = np.array([[1.0, square, square], [square, fourth, mixed], [square, mixed, fourth]])
    wanted = np.array([stretching, square * about_z, square * about_y])
    c0, cy, cz = np.linalg.solve(matrix, wanted)
    return float(c0), float(cy), float(cz)


def _skin(scene: Beam, points: Array, weights: Array) -> Array:
    """`skin_profile` at the points, exact for the mesh since the moments are those of its quadrature."""
    b, h = scene.section.half_width, scene.section.half_height
    basis = np.stack([np.ones_like(weights), (points[..., 1] / b) ** 2, (points[..., 2] / h) ** 2])
    moments = np.einsum("ieq,jeq,eq->ij", basis, basis, weights)
    stretching, about_y, about_z = skin_factors(scene)
    wanted = moments[0] * [stretching, about_z, about_y]
    return np.asarray(np.einsum("i,ieq->eq", np.linalg.solve(moments, wanted), basis))
