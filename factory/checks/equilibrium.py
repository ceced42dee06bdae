"""Check the equilibrium of stored frames by an independent assembly of nodal forces.

A frame stores the positions of the surface. With these prescribed, the interior has one equilibrium, found
with the solver's tangent from frame to frame. The internal forces at the nodes are then assembled here, with
shape functions and integration points that share no code with the solver; the stress at a point is that of
`tisim.laws`. In a true equilibrium these forces vanish at interior and free surface nodes, and their sums
balance the stored force on the rod and equal that of the fixed nodes.
"""

from __future__ import annotations

import itertools
import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from factory.checks.interior import Interior, NoInteriorError
from factory.checks.verification import FORCE_FLOOR
from factory.cli import import_plugins
from factory.inspection.features import own_solves
from factory.reader import Dataset, open_dataset
from factory.recipe.model import RodRecipe
from tisim import Block, Material, Rod, laws
from tisim.mesh import Mesh
from tisim.mesh.indentation import poke_mesh

Array = NDArray[np.float64]
Ints = NDArray[np.integer[Any]]

# Integration of a hex20's energy (tisim.discretisation): this fraction at 27 points, the rest at 8; a bulk
# modulus of this many shear moduli at all points, the rest at the 8.
FINE_PART, BULK_EVERYWHERE = 0.3, 2.0
# Limit on forces at nodes without contact, relative to the rod's force, in units of the solver's tolerance:
# covers the single precision of the stored surface and the interior solve (to `INSIDE` of that tolerance).
SLACK = 2.0
# Limit on the difference between sums and stored forces, relative to the rod's force.
SUMS = 0.005
TOUCHES = 5e-6  # m: facets nearer to the rod than this may carry its force
INSIDE = 0.1  # tolerance of the interior solve, relative to the solver's


class NotCheckedError(Exception):
    """A poke cannot be checked; the text states why."""


@dataclass(frozen=True)
class FrameForces:
    """Nodal forces of one frame, relative to the rod's force.

    Attributes
    ----------
    frame : int
    inside, free : float
        Norm over the interior nodes, and over the surface nodes neither fixed nor touched by the rod.
    rod, base : float
        Norm of the imbalance between the nodes' sum and the stored force, at touched and at fixed nodes.
    """

    frame: int
    inside: float
    free: float
    rod: float
    base: float

    def faults(self, tolerance: float) -> list[str]:
        """Violations of equilibrium, one sentence each; `tolerance` is the solver's."""
        found = []
        for what, value, limit in (
            ("forces inside", self.inside, SLACK * tolerance),
            ("forces on the free surface", self.free, SLACK * tolerance),
            ("the nodes' sum less the rod's force", self.rod, SUMS),
            ("the fixed nodes' sum less the base's force", self.base, SUMS),
        ):
            if not value <= limit:
                found.append(f"{what}: {value:.2g} of the rod's force, expected at most {limit:.2g}")
        return found


@dataclass(frozen=True)
class Assembled:
    """Result of `check_assembly`.

    Attributes
    ----------
    pokes, frames : int
        Numbers checked.
    faults : list of str
        Sentences, in the order of the pokes.
    not_checked : dict of int to str
        Reasons why pokes could not be checked, by index.
    no_interior : dict of int to int
        First frame for whose surface no interior equilibrium was found, by poke; its earlier frames are
        checked. Either the surface is wrong or the search has failed.
    largest : FrameForces or None
        Largest values over all frames, with the frame's number 0; None if none was checked.
    """

    pokes: int
    frames: int
    faults: list[str]
    not_checked: dict[int, str]
    no_interior: dict[int, int]
    largest: FrameForces | None


def check_assembly(
    data: Dataset,
    *,
    pokes: int | None = None,
    workers: int = 1,
    plugins: Sequence[str] = (),
    on_progress: Callable[[int, int], None] | None = None,
) -> Assembled:
    """Check frames of the pokes that have a solve of their own by `nodal_forces`, in worker processes.

    Parameters
    ----------
    data : Dataset
    pokes : int, optional
        Number of pokes to check, spread over the dataset; default: all.
    workers : int
    plugins : sequence of str
        Modules that a worker imports first: they register laws or inclusion shapes.
    on_progress : callable, optional
        Called with the number of pokes done and in total.
    """
    chosen = np.flatnonzero(own_solves(data) & data.table["done"])
    if pokes is not None and pokes < len(chosen):
        chosen = chosen[np.linspace(0, len(chosen) - 1, pokes).round().astype(int)]
    tolerance = float(data.attributes["solver_tolerance"])
    found: dict[int, list[FrameForces]] = {}
    reasons: dict[int, str] = {}
    lost: dict[int, int] = {}
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        waiting = {
            pool.submit(_checked, data.path, int(index), tuple(plugins)): int(index) for index in chosen
        }
        for count, one in enumerate(as_completed(waiting), 1):
            answer, whole = one.result()
            if isinstance(answer, str):
                reasons[waiting[one]] = answer
            else:
                found[waiting[one]] = answer
                if not whole:
                    lost[waiting[one]] = len(answer)
            if on_progress is not None:
                on_progress(count, len(chosen))
    frames = [frame for poke in found.values() for frame in poke]
    faults = [
        f"poke {index}, frame {frame.frame}: {fault}"
        for index in sorted(found)
        for frame in found[index]
        for fault in frame.faults(tolerance)
    ]
    largest = None
    if frames:
        names = ("inside", "free", "rod", "base")
        largest = FrameForces(0, *(max(getattr(frame, name) for frame in frames) for name in names))
    return Assembled(
        len(found), len(frames), faults, dict(sorted(reasons.items())), dict(sorted(lost.items())), largest
    )


def _checked(path: Path, index: int, plugins: tuple[str, ...]) -> tuple[list[FrameForces] | str, bool]:
    """Check a poke in a worker process; return its frames, or the reason why it cannot be checked.

    The second value is False if the frames end at one without an interior equilibrium.
    """
    from tisim.parallel.threads import one_thread

    import_plugins(plugins)
    with one_thread():
        found: list[FrameForces] = []
        try:
            found.extend(check_poke(open_dataset(path), index))
        except NotCheckedError as reason:
            return str(reason), True
        except NoInteriorError:
            return found, False
        return found, True


def check_poke(data: Dataset, index: int) -> Iterator[FrameForces]:
    """Nodal forces of every frame of a poke.

    Raises
    ------
    NotCheckedError
        If the material has more than its law, or the mesh cannot be reproduced.
    NoInteriorError
        If no interior equilibrium is found for a stored surface.
    """
    poke = data.poke(index)
    material = _material(data, index)
    mesh = _mesh(data, index)
    surface = np.unique(mesh.facet_sets["surface"])
    if len(surface) != len(poke.surface_rest) or not np.allclose(
        mesh.nodes[surface], poke.surface_rest, rtol=0.0, atol=1e-9
    ):
        raise NotCheckedError("its mesh is not the one that this version of tisim makes")
    rod = _rod(data)
    tolerance = float(data.attributes["solver_tolerance"])
    # a rod that has been retracted presses with nothing, and forces of stored positions are rounded
    load = np.maximum(np.linalg.norm(poke.rod_force, axis=1), FORCE_FLOOR)
    held = np.zeros(mesh.n_nodes, dtype=bool)
    held[mesh.node_sets["base"]] = True
    on_surface = np.zeros(mesh.n_nodes, dtype=bool)
    on_surface[surface] = True

    def forces_at(frame: int, x: Array) -> FrameForces:
        forces, size = nodal_forces(mesh, material, x), load[frame]
        touched = _touched(mesh, x, poke.rod_tip[frame], poke.direction, rod) & ~held

        def part(vectors: Array) -> float:
            return float(np.linalg.norm(vectors)) / size

        return FrameForces(
            frame=frame,
            inside=part(forces[~on_surface]),
            free=part(forces[on_surface & ~held & ~touched]),
            rod=part(forces[touched].sum(axis=0) + poke.rod_force[frame]),
            base=part(forces[held].sum(axis=0) - poke.base_force[frame]),
        )

    found: dict[int, FrameForces] = {}

    def balanced(frame: int, x: Array) -> bool:
        found[frame] = forces_at(frame, x)
        return not any(found[frame].faults(tolerance))

    inside = Interior(
        mesh,
        material,
        surface,
        poke.surface - poke.surface_rest,
        INSIDE * tolerance * load,
        balanced=balanced,
    )
    for frame, _ in enumerate(inside):
        yield found[frame]


def nodal_forces(mesh: Mesh, material: Material, x: Array) -> Array:
    """Internal nodal forces (n, 3) [N] of a hex20 mesh at positions x (n, 3) [m]."""
    law = laws.get(material.law)
    moduli, kappa = law.moduli(material.parameters), law.kappa(material.parameters)
    everywhere = min(max(BULK_EVERYWHERE * moduli.shear_modulus - (moduli.bulk_modulus - kappa), 0.0), kappa)
    at_eight = (kappa - FINE_PART * everywhere) / (1.0 - FINE_PART)
    forces = np.zeros_like(x)
    for order, share, bulk in ((2, 1.0 - FINE_PART, at_eight), (3, FINE_PART, everywhere)):
        slopes, weights = _hex20(order)
        rest = np.einsum("qad,eai->eqid", slopes, mesh.nodes[mesh.elements], optimize=True)
        now = np.einsum("qad,eai->eqid", slopes, x[mesh.elements], optimize=True)
        inverse = np.linalg.inv(rest)
        F = now @ inverse
        stress = _stress(material, F.reshape(-1, 3, 3), bulk - kappa).reshape(F.shape)
        volume = share * weights * np.linalg.det(rest)
        # f_a = sum_q V_q P dN_a/dX
        pulled = (volume[..., None, None] * stress) @ np.swapaxes(inverse, 2, 3)
        np.add.at(forces, mesh.elements, np.einsum("eqid,qad->eai", pulled, slopes, optimize=True))
    return forces


def _stress(material: Material, F: Array, more: float) -> Array:
    """First Piola-Kirchhoff stress (n, 3, 3) [Pa] of the law, its bulk modulus increased by `more` [Pa]."""
    stress = np.empty_like(F)
    for begin in range(0, len(F), 8192):  # in blocks: the law also returns tangents, 0.6 kB per point
        some = slice(begin, begin + 8192)
        stress[some] = laws.evaluate(material.law, material.parameters, F[some])[1]
    J = np.linalg.det(F)
    theta = laws.get(material.law).theta
    if theta == "trace":  # theta = tr E, d theta / dF = F
        trace = 0.5 * (np.einsum("nij,nij->n", F, F) - 3.0)
        return stress + more * trace[:, None, None] * F
    slope = np.log(J) if theta == "log" else (J - 1.0) * J  # theta d theta / dJ times J
    return stress + more * slope[:, None, None] * np.swapaxes(np.linalg.inv(F), 1, 2)


@cache
def _hex20(order: int) -> tuple[Array, Array]:
    """Gradients (q, 20, 3) of a hex20's shape functions at order^3 Gauss points, and the weights (q,).

    The functions are those combinations of the twenty monomials r^i s^j t^k with at most one square that are
    1 at one node and 0 at the others.
    """
    corners = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)]
    corners += [(r, s, 1) for r, s, _ in corners]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    places = np.array(corners + [tuple(np.add(corners[a], corners[b]) / 2) for a, b in edges], dtype=float)
    powers = np.array([p for p in itertools.product(range(3), repeat=3) if sum(k == 2 for k in p) < 2])
    to_nodes = np.linalg.inv(_monomials(places, powers))  # (monomial, node)
    g, w = np.polynomial.legendre.leggauss(order)
    points = np.array(list(itertools.product(g, repeat=3)))
    weights = np.array([a * b * c for a, b, c in itertools.product(w, repeat=3)])
    slopes = []
    for axis in range(3):
        lower = powers.copy()
        lower[:, axis] = np.maximum(lower[:, axis] - 1, 0)
        slopes.append((powers[:, axis] * _monomials(points, lower)) @ to_nodes)
    return np.stack(slopes, axis=2), weights


def _monomials(places: Array, powers: Ints) -> Array:
    return np.asarray((places[:, None, :] ** powers).prod(axis=2))


def _touched(mesh: Mesh, x: Array, tip: Array, direction: Array, rod: Rod) -> NDArray[np.bool_]:
    """Mask (n,) of the nodes of top facets that the rod touches."""
    facets = mesh.facet_sets["top"]
    side = np.linspace(-1.0, 1.0, 9)
    r, s = (values.ravel() for values in np.meshgrid(side, side))
    corner = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    along = 1.0 + r[:, None] * corner[:, 0], 1.0 + s[:, None] * corner[:, 1]
    at_corner = along[0] * along[1] * (along[0] + along[1] - 3.0) / 4.0
    in_r, in_s = 0.5 * (1 - r**2), 0.5 * (1 - s**2)
    shape = np.column_stack([at_corner, in_r * (1 - s), (1 + r) * in_s, in_r * (1 + s), (1 - r) * in_s])
    points = np.einsum("qa,fai->fqi", shape, x[facets])
    near = (_distance(points, tip, direction, rod) < TOUCHES).any(axis=1)
    touched = np.zeros(len(x), dtype=bool)
    touched[facets[near].ravel()] = True
    return touched


def _distance(points: Array, tip: Array, direction: Array, rod: Rod) -> Array:
    """Signed distance (...,) [m] of points (..., 3) from a rod whose tip's lowest point is `tip`."""
    away = points - tip
    up = -(away @ direction)
    off = np.linalg.norm(away + up[..., None] * direction, axis=-1)
    edge = rod.radius if rod.tip == "hemisphere" else rod.edge_radius
    core = rod.radius - edge
    below, beyond = np.maximum(edge - up, 0.0), np.maximum(off - core, 0.0)
    rounded = np.hypot(below, beyond) - edge
    within = np.maximum(-up, off - rod.radius)  # where it is nearer to the flat end or the shaft
    corner = (up < edge) & (off > core)
    return np.asarray(np.where(corner, rounded, within))


def _rod(data: Dataset) -> Rod:
    return RodRecipe.model_validate(data.attributes["identity"]["recipe"]["rod"]).rod


def _mesh(data: Dataset, index: int) -> Mesh:
    recipe = data.attributes["identity"]["recipe"]
    element = data.attributes["identity"].get("element")
    if element != "hex20":
        raise NotCheckedError(f"its elements are {element}, not hex20")
    geometry = int(data.table["poke_geometry"][index])
    site, direction = data.table["site"][index], data.table["direction"][index]
    return poke_mesh(
        block=Block(size=data.block(geometry), inclusion=data.inclusion(geometry)),
        site=(float(site[0]), float(site[1])),
        direction=(float(direction[0]), float(direction[1]), float(direction[2])),
        rod=_rod(data),
        friction=recipe["friction"],
        refinement=recipe["refinement"],
    )


def _material(data: Dataset, index: int) -> Material:
    level = data.levels[int(data.table["poke_softness"][index])]
    stated = data.attributes["identity"]["materials"][level]
    beside = stated.keys() - {"law", "parameters", "density", "stiffness", "effects"}
    if beside:
        raise NotCheckedError(f"its material has {', '.join(sorted(beside))} beside its law")
    parameters = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in stated["parameters"].items()
    }
    return Material(law=stated["law"], parameters=parameters, density=stated["density"])
