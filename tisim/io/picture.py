"""One frame of a result as a PNG, drawn by matplotlib without a display or graphics card."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tisim import laws
from tisim.bodies import Vector
from tisim.io.export import checked_path
from tisim.io.whole import whole_file
from tisim.mesh import FACET_OUTLINE, Mesh, boundary_facets, unfold
from tisim.problems import kind_of
from tisim.problems.indentation.rod import rod_surface
from tisim.problems.indentation.turning import axis_at
from tisim.result import Result, frame_index
from tisim.scene import Poke

Array = NDArray[np.float64]

# Node order of facets as polygons, with middle nodes between the corners.
_COLOURS = "viridis"
_STEEL = np.array([0.62, 0.65, 0.70])
_EDGE = 0.82  # brightness of an element's edges relative to its face


@dataclass(frozen=True, eq=False)
class Camera:
    """Orthographic view: unit vectors to the right, up and towards the viewer."""

    right: Array
    up: Array
    towards: Array

    @staticmethod
    def at(towards: Array) -> Camera:
        w = np.asarray(towards, dtype=float) / np.linalg.norm(towards)
        right = np.cross([0.0, 0.0, 1.0], w)
        right /= np.linalg.norm(right)
        return Camera(right, np.cross(w, right), w)

    def flat(self, points: Array) -> Array:
        return np.stack([points @ self.right, points @ self.up], axis=-1)


def picture(
    result: Result,
    path: str | Path,
    frame: int = -1,
    *,
    cut: bool | None = None,
    title: str | None = None,
    dpi: int = 150,
) -> Path:
    """Draw the deformed body at one frame into a PNG, coloured by displacement [mm].

    Parameters
    ----------
    result : Result
    path : path
        The PNG file.
    frame : int
        Index of the frame; negative ones count from the end.
    cut : bool, optional
        Omit the half towards the viewer, to show the inside; the default for pokes, which are cut through the
        rod's axis. Other bodies are drawn whole by default, with their rest shape in the background.
    title : str, optional
        Title; by default a line that describes the scene.
    dpi : int
        Resolution [dots per inch].

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        For another extension than .png, or if the result does not have the frame.
    FileNotFoundError
        If the folder does not exist.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    path = Path(path)
    if path.suffix.lower() != ".png":
        raise ValueError(f"{path.name}: expected a name that ends in .png")
    checked_path(path)
    frame = frame_index(result, frame)
    mesh, x = unfold(result.mesh, result.positions[frame])
    rest = unfold(result.mesh, result.rest_positions)[1]
    scene = result.scene
    poke = scene if result.rod_tip is not None else None
    cut = poke is not None if cut is None else cut
    sideways = across(None if poke is None else poke.direction)
    camera = camera_of(sideways, poke)
    facets = _visible_facets(mesh, sideways, poke, cut=cut)
    moved = 1e3 * np.linalg.norm(x - rest, axis=1)
    scale = Normalize(0.0, max(float(moved.max()), 1e-9))

    polygons = x[facets]
    colours = _colour_map()(scale(moved[facets].mean(axis=1)))[:, :3]
    sheets = [shaded(polygons, colours, camera, edges=True)]
    if poke is not None and result.rod_tip is not None:
        time = 0.0 if result.time is None else float(result.time[frame])
        rod = rod_surface(poke.rod, result.rod_tip[frame], axis_at(poke, time))
        sheets.append(shaded(rod, np.tile(_STEEL, (len(rod), 1)), camera, edges=False))
    figure = Figure(figsize=(8.0, 5.2), layout="constrained")
    axes = figure.add_subplot()
    if not cut:
        ghost = rest[facets]
        front = _normals(ghost) @ camera.towards > 0
        flat = camera.flat(1e3 * ghost[front])
        axes.add_collection(PolyCollection(list(flat), facecolors="#e9ebee", edgecolors="#e9ebee", zorder=0))
    flat_polygons, faces, edges = painted(sheets, camera)
    axes.add_collection(
        PolyCollection(flat_polygons, facecolors=faces, edgecolors=edges, linewidths=0.25, zorder=1)
    )
    _finish(figure, axes, flat_polygons, scale, title or describe(result, frame), whole=not cut)
    with whole_file(path) as part:
        figure.savefig(part, dpi=dpi, format="png")
    return path


def describe(result: Result, frame: int = -1) -> str:
    """Description of a frame in one line: scene, law, shear modulus, time of a dynamic scene."""
    frame = frame_index(result, frame)
    scene, load = result.scene, float(result.load[frame])
    law = laws.get(scene.material.law)
    shear = law.moduli(scene.material.parameters).shear_modulus
    name = kind_of(scene).describe(result, frame)
    time = f"; t = {load:.3f} s" if scene.solver.method != "static" else ""
    return f"{name}; {law.title}, G = {shear * 1e-3:.3g} kPa{time}"


def _colour_map() -> Any:
    from matplotlib import colormaps

    return colormaps[_COLOURS]


def across(direction: Vector | None) -> Array:
    """Horizontal unit vector normal to the vertical plane of a push direction, and to the cut."""
    if direction is None or np.hypot(direction[0], direction[1]) < 1e-9:
        return np.array([0.0, 1.0, 0.0])
    d = np.array([direction[0], direction[1], 0.0])
    d /= np.linalg.norm(d)
    sideways = np.array([-d[1], d[0], 0.0])
    return sideways if sideways[1] >= 0 else -sideways


def camera_of(sideways: Array, poke: Poke | None) -> Camera:
    along = np.cross(sideways, [0.0, 0.0, 1.0])
    if poke is not None:
        return Camera.at(-sideways + 0.30 * along + 0.55 * np.array([0.0, 0.0, 1.0]))
    return Camera.at(-sideways + 0.35 * along + 0.35 * np.array([0.0, 0.0, 1.0]))


def _visible_facets(mesh: Mesh, sideways: Array, poke: Poke | None, *, cut: bool) -> NDArray[np.int32]:
    if not cut:
        facets = mesh.facet_sets.get("surface")
        return boundary_facets(mesh.kind, mesh.elements) if facets is None else facets
    centre = mesh.nodes.mean(axis=0) if poke is None else np.array([*poke.site, 0.0])
    side = (mesh.nodes[mesh.elements].mean(axis=1) - centre) @ sideways
    kept = mesh.elements[side > -1e-9]
    return boundary_facets(mesh.kind, kept)


def _normals(polygons: Array) -> Array:
    """Unit normals (k, 3) of polygons (k, p, 3), from their area vectors."""
    after = np.roll(polygons, -1, axis=1)
    area = np.cross(polygons - polygons[:, :1], after - polygons[:, :1]).sum(axis=1)
    size = np.linalg.norm(area, axis=1, keepdims=True)
    return area / np.where(size > 0, size, 1.0)


@dataclass(frozen=True, eq=False)
class Sheet:
    polygons: Array
    faces: Array
    edges: Array


def shaded(polygons: Array, colours: Array, camera: Camera, *, edges: bool) -> Sheet:
    """The polygons that face the viewer, lit from above the viewer's left shoulder."""
    if polygons.shape[1] in FACET_OUTLINE:
        polygons = polygons[:, FACET_OUTLINE[polygons.shape[1]]]
    normals = _normals(polygons)
    front = normals @ camera.towards > 0
    light = camera.towards + 0.9 * camera.up - 0.5 * camera.right
    light /= np.linalg.norm(light)
    lit = 0.55 + 0.45 * np.clip(normals[front] @ light, 0.0, 1.0)
    faces = np.clip(colours[front] * lit[:, None], 0.0, 1.0)
    return Sheet(polygons[front], faces, faces * _EDGE if edges else faces)


def painted(sheets: list[Sheet], camera: Camera) -> tuple[list[Array], Array, Array]:
    """Projected polygons [mm] of all sheets from the farthest to the nearest, with face and edge colours."""
    depth = np.concatenate([s.polygons.mean(axis=1) @ camera.towards for s in sheets])
    flat = [p for s in sheets for p in camera.flat(1e3 * s.polygons)]
    order = np.argsort(depth, kind="stable")
    faces = np.concatenate([s.faces for s in sheets])[order]
    edges = np.concatenate([s.edges for s in sheets])[order]
    return [flat[i] for i in order], faces, edges


def _finish(figure: Any, axes: Any, flat: list[Array], scale: Any, title: str, *, whole: bool) -> None:
    from matplotlib.cm import ScalarMappable

    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.margins(0.04)
    axes.axis("off")
    points = np.concatenate(flat)
    width = float(np.ptp(points[:, 0]))
    bar = next((b for b in (100, 50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1) if b <= 0.3 * width), 0.1)
    low, left = float(axes.dataLim.y0), float(axes.dataLim.x0)
    y = low - 0.06 * width
    axes.plot([left, left + bar], [y, y], color="#333333", linewidth=2.0, solid_capstyle="butt")
    axes.text(left + 0.5 * bar, y - 0.012 * width, f"{bar:g} mm", ha="center", va="top", color="#333333")
    if whole:
        axes.text(axes.dataLim.x1, y - 0.012 * width, "grey: at rest", ha="right", va="top", color="#888888")
    axes.set_title(title, fontsize=11, parse_math=False)
    mappable = ScalarMappable(norm=scale, cmap=_colour_map())
    figure.colorbar(mappable, ax=axes, label="displacement [mm]", shrink=0.75, pad=0.02)
