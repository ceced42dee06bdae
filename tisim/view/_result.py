"""View of a result of `tisim.simulate`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tisim.bodies import Rod
from tisim.fields import Quantities, fields_of_frames, unfold_quantities
from tisim.io.picture import across, describe
from tisim.mesh import Mesh, boundary_facets, triangles, unfold
from tisim.problems.indentation.rod import rod_surface
from tisim.problems.indentation.turning import axis_at
from tisim.result import Result
from tisim.view._quantities import Quantity, curve, frames_shown, label, thinned
from tisim.view._view import REST, STEEL, Array, Field, Surface, View, outlines

PIECE = 2e-3  # length of the pieces of a rod's shaft, short for the painter's algorithm [m]
# name, attribute of `Quantities`, component, unit in SI
COLOURINGS: tuple[tuple[str, str, int | None, str], ...] = (
    ("von Mises stress", "von_mises", None, "Pa"),
    ("strain energy density", "energy_density", None, "J/m³"),
    ("pressure", "pressure", None, "Pa"),
    ("largest principal stress", "principal_stresses", 0, "Pa"),
    ("largest principal stretch", "principal_stretches", 0, ""),
    ("smallest principal stretch", "principal_stretches", 2, ""),
)


def view_of_result(result: Result, *, title: str | None = None) -> View:
    """View of a result, see `tisim.show`."""
    count = len(result.positions)
    if not count:
        why = f": {result.message}" if result.message else ""
        raise ValueError(f"the result has no frame{why}")
    kept = frames_shown(count)
    mesh, positions = unfold(result.mesh, result.positions[kept])
    mesh = replace(mesh, nodes=unfold(result.mesh, result.rest_positions)[1])
    poke = result.scene if result.rod_tip is not None else None
    sideways = across(None if poke is None else poke.direction)
    centre = np.array([*poke.site, 0.0]) if poke is not None else mesh.nodes.mean(axis=0)
    found = [
        unfold_quantities(result.mesh, f.nodes, nodes=True)
        for f in fields_of_frames(result)
        if f.frame in kept
    ]
    surfaces = body_surfaces(mesh, positions, colourings(mesh.nodes, positions, found), sideways, centre)
    if result.rod_tip is not None:
        times = np.zeros(count) if result.time is None else result.time
        axes = [axis_at(result.scene, float(times[k])) for k in kept]
        surfaces.append(rod(result.scene.rod, result.rod_tip[kept], np.array(axes)))
    ended = (f"The simulation ended early: {result.message}.",) if result.message else ()
    places, forces = [_place(result, int(k)) for k in kept], [_force(result, int(k)) for k in kept]
    return View(
        title=title or describe(result),
        labels=tuple(label([*at, force]) for at, force in zip(places, forces, strict=True)),
        surfaces=tuple(surfaces),
        curve=curve([at[0] for at in places], forces),
        towards=towards(sideways, steep=poke is not None),
        opened=poke is not None,
        rest=poke is None and count == 1,
        notes=thinned(count) + ended,
    )


def towards(sideways: Array, *, steep: bool) -> tuple[float, float, float]:
    """Direction from a body to a viewer who looks at its cut face; steeper from above if `steep`."""
    x, y, z = -sideways + 0.35 * np.cross(sideways, [0.0, 0.0, 1.0]) + [0.0, 0.0, 0.6 if steep else 0.35]
    return float(x), float(y), float(z)


def body_surfaces(
    mesh: Mesh, positions: Array, coloured: tuple[Field, ...], sideways: Array, centre: Array
) -> list[Surface]:
    """Surfaces of a body, with a cut normal to `sideways` through `centre`, and of its rest shape."""
    whole = mesh.facet_sets.get("surface")
    whole = boundary_facets(mesh.kind, mesh.elements) if whole is None else whole
    behind = (mesh.nodes[mesh.elements].mean(axis=1) - centre) @ sideways > -1e-9
    half = boundary_facets(mesh.kind, mesh.elements[behind])
    used, place = np.unique(np.concatenate([whole.ravel(), half.ravel()]), return_inverse=True)
    number = np.asarray(place, dtype=np.int32).ravel()
    whole, half = number[: whole.size].reshape(whole.shape), number[whole.size :].reshape(half.shape)
    body = Surface(
        positions=positions[:, used],
        triangles=triangles(whole),
        edges=outlines(whole),
        opened=triangles(half),
        opened_edges=outlines(half),
        fields=tuple(Field(name=f.name, unit=f.unit, values=f.values[:, used]) for f in coloured),
    )
    rest = Surface(
        positions=mesh.nodes[None, used],
        triangles=body.triangles,
        opened=body.opened,
        colour=REST,
        rest=True,
    )
    return [body, rest]


def colourings(rest: Array, positions: Array, found: list[Quantities]) -> tuple[Field, ...]:
    """Fields of the displacement [mm] and of the quantities in COLOURINGS, in units suited to their size."""
    moved = [Field(name="displacement", unit="mm", values=1e3 * np.linalg.norm(positions - rest, axis=2))]
    for name, attribute, component, unit in COLOURINGS:
        rows = [getattr(q, attribute) for q in found]
        values = np.array(rows if component is None else [r[:, component] for r in rows])
        moved.append(handy(name, unit, values))
    return tuple(moved)


def handy(name: str, unit: str, values: Array) -> Field:
    """Field of values in SI units, with a prefix of the unit suited to their size."""
    if not unit:
        return Field(name=name, unit=unit, values=values)
    size = float(np.percentile(np.abs(values), 99.0))
    factor, prefix = next(((f, p) for f, p in ((1e6, "M"), (1e3, "k")) if size >= f), (1.0, ""))
    return Field(name=name, unit=prefix + unit, values=values / factor)


def rod(shape: Rod, tips: Array, axes: Array) -> Surface:
    """Surface of a rod at poses given by tip centres (f, 3) [m] and unit vectors towards the tip (f, 3)."""
    poses = zip(tips, axes, strict=True)
    quads = np.array([rod_surface(shape, tip, axis, around=24, piece=PIECE) for tip, axis in poses])
    corners = quads.reshape(len(quads), -1, 3)
    _, kept, place = np.unique(np.round(corners[0], 9), axis=0, return_index=True, return_inverse=True)
    return Surface(
        positions=corners[:, kept], triangles=triangles(place.reshape(-1, 4).astype(np.int32)), colour=STEEL
    )


def _place(result: Result, frame: int) -> list[Quantity]:
    """Load parameter (depth, stretch or fraction of the load) and time of a frame."""
    load = float(result.load[frame])
    found: list[Quantity] = []
    if result.rod_tip is not None:
        found.append(("depth", 1e3 * load, "mm"))
    elif result.nominal_stress is not None:
        shears = getattr(result.scene, "mode", "") == "simple-shear"
        found.append(("amount of shear", load - 1.0, "") if shears else ("stretch", load, ""))
    elif result.time is None:
        found.append(("part of the load", load, ""))
    if result.time is not None:
        found.append(("time", float(result.time[frame]), "s"))
    return found


def _force(result: Result, frame: int) -> Quantity:
    if result.rod_force is not None:
        return "force on the rod", float(np.linalg.norm(result.rod_force[frame])), "N"
    if result.nominal_stress is not None:
        return "nominal stress", 1e-3 * float(result.nominal_stress[frame]), "kPa"
    return "force of the supports", float(np.linalg.norm(result.support_force[frame])), "N"
