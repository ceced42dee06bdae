"""Makes the figures of README.md and floor.png.

python -m studies.metrics.floor            (all of it: about three minutes)
python -m studies.metrics.floor shift table nodes volume ceiling     (those parts: seconds)
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.optimize import curve_fit
from scipy.spatial import cKDTree

import tisim
from calibration import metrics
from calibration.experiment.model import Supports, TracedOutline
from calibration.shape import Centreline, body_mesh, centreline, sweep

Array = NDArray[np.float64]

HERE = Path(__file__).parent
PICTURE = HERE / "floor.png"
TABLE = HERE / "paper_calibration_table.csv"

R = 0.010
SECTION = tisim.Circle(radius=R)
BEAMS: tuple[tuple[float, Supports], ...] = (
    (0.050, "clamped-free"),
    (0.100, "clamped-free"),
    (0.150, "clamped-clamped"),
)
SHEAR = {"S0": 30e3, "S0.5": 15e3, "S1": 9e3}  # [Pa], E of about 90, 44 and 27 kPa
PAPER_RINGS, PAPER_LAYERS = 6, 56  # 7,239 nodes whatever the length; the paper: 7,257
CAD_SIDES = 30


@dataclass(frozen=True)
class Row:
    """Figures of one line of a table: distances in mm."""

    dice: float
    sd: float
    hd95: float
    node_sd: float = np.nan
    node_hd95: float = np.nan
    volume: float = np.nan


def straight(
    length: float, height: float = 0.0, *, cad: bool = False, rings: float = 1e-3
) -> trimesh.Trimesh:
    """A straight body, its axis at z = height; cad: 30 inscribed sides and rings so far apart [m]."""
    s = np.linspace(0.0, length, 101)
    line = Centreline(s=s, points=np.column_stack([s, np.full_like(s, height)]), angle=np.zeros_like(s))
    if cad:
        return sweep(line, SECTION, segments=CAD_SIDES, true_area=False, spacing=rings)
    return sweep(line, SECTION)


def shift() -> list[Row]:
    """A 100 mm cylinder against itself displaced sideways: what a Dice means in millimetres."""
    print("\nshift: 100 mm cylinder, R = 10 mm, displaced sideways")
    print("  shift [mm]   Dice   R(1-Dice) [mm]   mean distance, with caps and without [mm]   HD95 [mm]")
    rows = []
    for mm in (0.25, 0.5, 0.79, 1.0, 1.5, 2.0, 4.0, 6.0):
        d = mm * 1e-3
        got = metrics.compare(straight(0.1), straight(0.1, d))
        row = Row(got["dice"], got["surface_distance"] * 1e3, got["hd95"] * 1e3)
        side = row.sd * (R + 0.1) / 0.1  # the caps stay in their planes: they add area, not distance
        print(f"  {mm:8.2f}    {row.dice:.4f}   {10 * (1 - row.dice):8.3f}   {row.sd:20.3f} {side:8.3f}"
              f"   {row.hd95:18.2f}")  # fmt: skip
        rows.append(row)
    return rows


def paper_rows() -> list[Row]:
    with TABLE.open() as file:
        return [
            Row(float(r["dice"]), float(r["surface_distance_mm"]), float(r["hd95_mm"]))
            for r in csv.DictReader(file)
            # its Dice of .57 is out of the range where distance and overlap go together
            if (r["law"], r["mixture"]) != ("arruda-boyce", "S1")
        ]


def floor_and_slope(rows: list[Row]) -> tuple[float, float, float, float]:
    """floor [mm] and c of SD^2 = floor^2 + (c R (1 - Dice))^2 their largest miss [mm], HD95's floor [mm]."""
    x = np.array([10 * (1 - r.dice) for r in rows])

    def curve(x: Array, floor: float, c: float) -> Array:
        return np.sqrt(floor**2 + (c * x) ** 2)

    sd, hd = np.array([r.sd for r in rows]), np.array([r.hd95 for r in rows])
    (floor, c), _ = curve_fit(curve, x, sd, p0=(1.0, 1.0))
    (hd_floor, _), _ = curve_fit(curve, x, hd, p0=(4.0, 2.0))
    return float(floor), float(c), float(np.abs(curve(x, floor, c) - sd).max()), float(hd_floor)


def table() -> list[Row]:
    rows = paper_rows()
    floor, c, miss, hd_floor = floor_and_slope(rows)
    print(f"\ntable: the paper's {len(rows)} rows (all but Arruda-Boyce at S1)")
    print(f"  SD^2 = {floor:.3f}^2 + ({c:.2f} R (1 - Dice))^2 [mm], largest miss {miss:.3f} mm")
    print(f"  HD95 the same way: floor {hd_floor:.2f} mm")
    return rows


def paper_mesh(length: float, supports: Supports) -> tisim.Mesh:
    return tisim.mesh.beam_mesh(
        length=length, section=SECTION, supports=supports, kind="tet4", radial_elements=PAPER_RINGS,
        axial_element_size=length / PAPER_LAYERS, grading=(1.0,),
    )  # fmt: skip


def nodes_against_surface(nodes: Array, body: trimesh.Trimesh) -> tuple[float, float, float]:
    """Mean distance, HD95 (mean of both directions) and HD95 (the larger direction) [mm]: every node is taken
    for a point of the surface, the other body is points spread over its surface."""
    there = metrics.point_to_surface(nodes, body)
    back = np.asarray(cKDTree(nodes).query(metrics.surface_points(body))[0])
    p = np.percentile(there, 95), np.percentile(back, 95)
    return (there.mean() + back.mean()) * 500, float(sum(p)) * 500, float(max(p)) * 1e3


def nodes() -> None:
    """Two identical straight beams, so that the true distance is zero: what nodes make of it."""
    print("\nnodes: straight beams of 7,239 nodes against their own CAD bodies (30 sides), mean of 3 lengths")
    lines: dict[str, list[tuple[float, float, float]]] = {}

    def note(name: str, values: tuple[float, float, float]) -> None:
        lines.setdefault(name, []).append(values)

    def pairs(a: Array, b: Array) -> tuple[float, float, float]:
        p = [np.percentile(cKDTree(v).query(u)[0], 95) for u, v in ((a, b), (b, a))]
        return metrics.vertex_distance(a, b) * 1e3, metrics.vertex_hd95(a, b) * 1e3, float(max(p)) * 1e3

    for length, supports in BEAMS:
        mesh = paper_mesh(length, supports)
        cad = straight(length, cad=True)
        skin = mesh.nodes[np.unique(tisim.surface_triangles(mesh))]
        same, worst = metrics.surface_distance(cad, cad) * 1e3, metrics.hd95(cad, cad) * 1e3
        note("surface to surface (the metric of this package)", (same, worst, worst))
        note("all nodes and CAD surface", nodes_against_surface(mesh.nodes, cad))
        note("all nodes and CAD vertices, rings 1 mm apart", pairs(mesh.nodes, np.asarray(cad.vertices)))
        note("surface nodes and CAD surface", nodes_against_surface(skin, cad))
        for mm in (8, 9, 10):
            coarse = straight(length, cad=True, rings=mm * 1e-3)
            vertices = np.asarray(coarse.vertices)
            note(f"surface nodes and CAD vertices, rings {mm} mm apart", pairs(skin, vertices))
    print("  mean distance [mm] (each length)   HD95, mean of directions, larger one [mm]")
    for name, values in lines.items():
        sd, hd, larger = np.mean(values, axis=0)
        each = " ".join(f"{v[0]:.2f}" for v in values)
        print(f"  {sd:6.3f} ({each})   {hd:6.2f} {larger:6.2f}   {name}")


def soft(
    shear: float, length: float, supports: Supports, *, ratio: float, paper: bool = False
) -> tisim.Result:
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=shear, bulk_modulus=ratio * shear)
    mesh = paper_mesh(length, supports) if paper else None
    beam = tisim.Beam(material=material, length=length, supports=supports, mesh=mesh)
    (result,) = tisim.simulate([beam])
    if not result.ok:
        raise SystemExit(f"{shear:.0f} Pa, {length * 1e3:.0f} mm: {result.status}: {result.message}")
    return result


def cad_line(truth: tisim.Result, length: float, supports: Supports) -> Centreline:
    """The mid line between the upper and lower edge of a simulated beam, traced without error."""
    from scipy.interpolate import CubicSpline

    rest, x = truth.mesh.nodes, truth.positions[-1]
    edges = []
    for sign in (1.0, -1.0):
        on = np.flatnonzero((np.abs(rest[:, 1]) < 1e-9) & (sign * rest[:, 2] > 0.99 * R))
        on = on[np.argsort(rest[on, 0])]
        last = length if supports == "clamped-free" else length - 1e-3
        edges.append(CubicSpline(rest[on, 0], x[on][:, [0, 2]])(np.linspace(1e-3, last, 80)))
    traced = TracedOutline(upper=edges[0], lower=edges[1], sd=0.0, correlation=0.0)
    return centreline(traced, supports=supports, free_length=length)


@dataclass(frozen=True)
class Reference:
    """A beam as it truly hangs (mixed quadratic elements, K = 1000 mu), its mid line and its CAD body."""

    length: float
    supports: Supports
    truth: tisim.Result
    line: Centreline
    cad: trimesh.Trimesh


def references(mixture: str) -> list[Reference]:
    found = []
    for length, supports in BEAMS:
        truth = soft(SHEAR[mixture], length, supports, ratio=1000.0)
        line = cad_line(truth, length, supports)
        cad = sweep(line, SECTION, segments=CAD_SIDES, true_area=False)
        found.append(Reference(length, supports, truth, line, cad))
    return found


def volume() -> None:
    """Errors of the CAD body's volume by its facets and by the stretch of its mid line."""
    sides = 2 * np.pi / CAD_SIDES
    print(f"\nvolume: a section of {CAD_SIDES} sides has {100 * (1 - np.sin(sides) / sides):.2f} % less area")
    print("  mixture: mid line longer than the rest length [%], each length, mean; CAD body against the rest")
    print("  volume, 30 sides; the same, true area")
    for mixture in SHEAR:
        longer, faceted, true = [], [], []
        for known in references(mixture):
            rest = np.pi * R**2 * known.length
            longer.append(100 * (known.line.length / known.length - 1))
            faceted.append(100 * (known.cad.volume / rest - 1))
            true.append(100 * (sweep(known.line, SECTION).volume / rest - 1))
        each = " ".join(f"{v:.2f}" for v in longer)
        print(f"  {mixture:5s} {each}   {np.mean(longer):.2f}   {np.mean(faceted):.2f}   {np.mean(true):.2f}")


def ceiling() -> None:
    """A simulation without any error against its own CAD body."""
    print("\nceiling: the truth itself against the CAD body swept along its own mid line (true area)")
    print("  mixture  length [mm]   Dice   mean distance [mm]   HD95 [mm]   volume difference [%]"
          "   mid line off the axis [mm]")  # fmt: skip
    for mixture in SHEAR:
        for known in references(mixture):
            got = metrics.compare(body_mesh(known.truth), sweep(known.line, SECTION))
            print(f"  {mixture:5s} {known.length * 1e3:10.0f} {got['dice']:14.4f}"
                  f" {got['surface_distance'] * 1e3:12.3f} {got['hd95'] * 1e3:15.2f}"
                  f" {got['volume_difference'] * 100:14.2f} {off_axis(known) * 1e3:20.2f}")  # fmt: skip


def off_axis(known: Reference) -> float:
    """Largest distance [m] of the mid line from the deformed axis, beyond one section height of the clamp."""
    from scipy.interpolate import CubicSpline

    rest, x = known.truth.mesh.nodes, known.truth.positions[-1]
    on = np.flatnonzero(np.hypot(rest[:, 1], rest[:, 2]) < 1e-9)
    on = on[np.argsort(rest[on, 0])]
    axis = CubicSpline(rest[on, 0], x[on][:, [0, 2]])(np.linspace(0.0, known.length, 3001))
    inner = known.line.points[(known.line.s > 2 * R) & (known.line.s < known.line.length - 1e-3)]
    return float(np.max(cKDTree(axis).query(inner)[0]))


def fit() -> list[Row]:
    """The paper's way from end to end: linear tetrahedra at moduli off by a factor against CAD bodies."""
    print("\nfit: linear tetrahedra, 7,239 nodes, K = 20 mu, modulus off by a factor; mean of three lengths")
    print("  mixture  factor   Dice   R(1-Dice)   mean distance, HD95 [mm]   from all nodes: the same [mm]"
          "   volume [%]")  # fmt: skip
    rows = []
    for mixture, shear in SHEAR.items():
        known = references(mixture)  # traced once, whatever is simulated
        for factor in (0.8, 0.9, 1.0, 1.2, 1.5):
            got = []
            for one in known:
                result = soft(factor * shear, one.length, one.supports, ratio=20.0, paper=True)
                m = metrics.compare(body_mesh(result), one.cad)
                sd, hd, _ = nodes_against_surface(result.positions[-1], one.cad)
                got.append((m["dice"], m["surface_distance"] * 1e3, m["hd95"] * 1e3, sd, hd,
                            m["volume_difference"] * 100))  # fmt: skip
            row = Row(*(float(v) for v in np.mean(got, axis=0)))
            print(
                f"  {mixture:7s} {factor:6.1f}  {row.dice:7.3f} {10 * (1 - row.dice):9.2f} {row.sd:12.2f}"
                f" {row.hd95:7.2f} {row.node_sd:20.2f} {row.node_hd95:7.2f} {row.volume:16.2f}"
            )
            rows.append(row)
    near = [r for r in rows if r.dice > 0.7]
    floor, c, miss, hd_floor = floor_and_slope([Row(r.dice, r.node_sd, r.node_hd95) for r in near])
    print(
        f"  {len(near)} rows with Dice above 0.7, from all nodes: SD^2 = {floor:.3f}^2 +"
        f" ({c:.2f} R (1 - Dice))^2, largest miss {miss:.3f} mm; HD95's floor {hd_floor:.2f} mm"
    )
    return rows


def picture(shifted: list[Row], printed: list[Row], made: list[Row]) -> None:
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    x = np.linspace(0, 3.0, 100)
    floor, c, _, _ = floor_and_slope(printed)
    curve = np.sqrt(floor**2 + (c * x) ** 2)
    left.plot(x, curve, color="0.6", lw=1, label=f"{floor:.2f} mm floor, c = {c:.2f}")
    left.plot(x, x, color="0.6", lw=1, ls=":", label="R (1 - Dice)")
    styles = (("o", "C3", "printed in the paper", printed, False), ("s", "C1", "ours, all nodes", made, True),
              ("^", "C0", "ours, surface to surface", made, False),
              ("x", "C2", "cylinder displaced sideways", shifted, False))  # fmt: skip
    for marker, colour, label, rows, from_nodes in styles:
        d = np.array([10 * (1 - r.dice) for r in rows])
        for axes, values in (
            (left, [r.node_sd if from_nodes else r.sd for r in rows]),
            (right, [r.node_hd95 if from_nodes else r.hd95 for r in rows]),
        ):
            axes.plot(d, values, marker, color=colour, ms=5, label=label, mfc="none")
    left.set(xlim=(0, 3.0), ylim=(0, 4), ylabel="mean surface distance [mm]")
    right.set(xlim=(0, 3.0), ylim=(0, 10), ylabel="HD95 [mm]")
    for axes in (left, right):
        axes.set_xlabel("R (1 - Dice) [mm], R = 10 mm")
        axes.grid(alpha=0.3)
    left.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURE, dpi=130)
    print(f"\n{PICTURE.relative_to(HERE.parents[1])}")


def main() -> None:
    parts: dict[str, Callable[[], object]] = {
        "shift": shift, "table": table, "nodes": nodes, "volume": volume, "ceiling": ceiling, "fit": fit,
    }  # fmt: skip
    wanted = sys.argv[1:] or list(parts)
    if unknown := [name for name in wanted if name not in parts]:
        raise SystemExit(f"no such part: {', '.join(unknown)}; there are {', '.join(parts)}")
    made = {name: parts[name]() for name in wanted}
    if {"shift", "table", "fit"} <= made.keys():
        picture(made["shift"], made["table"], made["fit"])  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
