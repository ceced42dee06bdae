"""Force of an indenter on a layer, loading and unloading, by axisymmetric FEM (FElupe): writes `forces.json`.

    python -m benchmarks.blind.indentation.make_table      # adds what is missing; some minutes of CPU a case

9-node quadrilaterals with discontinuous pressure, penalty contact with Coulomb friction (the solver of
`benchmarks/references`). Neo-Hookean, K/G = 300; a disc of 50 mm radius replaces the block of 100 x 100 mm.
Forces are over the shear modulus [mm2], depths in mm. `rigid` holds, for each geometry, the factor by which
its forces, and those of its variants, are multiplied to correct the penalty contact to a rigid one.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.references.laws import mixed_law
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.references.quadrilaterals import quadrilaterals, with_middles
from benchmarks.references.rod import FlatRod
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]
FILE = Path(__file__).with_name("forces.json")
MU, RATIO, PENALTY, SIDE = 30e3, 300.0, 6e9, 0.050
SOFT = 1e-5  # penetration over which the contact sets in [m]
STIFFER = 2.0  # factor of the penalty in the runs from which rigid contact is extrapolated
# Step sizes, tried in turn until a run reaches the end: first, longest, shortest [m], and
# iterations.
STEPS = ((1e-4, 3e-4, 2e-6, 14), (2e-5, 5e-5, 1e-7, 30))
FRAMES = 16  # depths in loading, and one fewer in unloading (equal forces if nothing slides under the rod)


@dataclass(frozen=True, kw_only=True)
class Setup:
    """A geometry; lengths in mm.

    Attributes
    ----------
    height : of the layer.
    rod, tip : radius of the indenter, and "flat" or "hemisphere".
    depth : largest depth.
    friction : Coulomb coefficient.
    skin : relative excess of the shear modulus in the outer millimetre.
    slips : True if the base slides freely.
    cylinder : radius, lower and upper end of a rigid bonded cylinder on the axis.
    """

    height: float
    rod: float
    tip: str
    depth: float
    friction: float = 0.6
    skin: float = 0.0
    slips: bool = False
    cylinder: tuple[float, float, float] | None = None


BASES = {
    "thick": Setup(height=32.0, rod=2.5, tip="flat", depth=3.0),
    "thin": Setup(height=12.0, rod=4.0, tip="flat", depth=3.0),
    "ball": Setup(height=20.0, rod=4.0, tip="hemisphere", depth=4.0),
    "core": Setup(height=30.0, rod=3.0, tip="flat", depth=3.5, cylinder=(9.0, 8.0, 20.0)),
}


def setups() -> dict[str, Setup]:
    """Geometries by name: each of BASES, and variants with one cause."""
    found: dict[str, Setup] = {}
    for name, s in BASES.items():
        found[name] = s
        for mu in (0.0, 0.1, 0.25):
            found[f"{name} friction {mu:g}"] = replace(s, friction=mu)
        for part in (0.85, 1.15) if name == "thin" else ():
            found[f"{name} height {part:g}"] = replace(s, height=part * s.height)
        found[f"{name} skin 1"] = replace(s, skin=1.0)
        if name == "thin":
            found[f"{name} slips"] = replace(s, slips=True)
        if s.cylinder is not None:
            radius, low, high = s.cylinder
            for up in (-3.0, 3.0):
                found[f"{name} up {up:g}"] = replace(s, cylinder=(radius, low + up, high + up))
            found[f"{name} none"] = replace(s, cylinder=None)
    return found


def _span(a: float, b: float, first: float, growth: float) -> Array:
    """Element boundaries from a to b: first interval about `first`, growing by `growth`, at most 3 mm."""
    steps = [first]
    while sum(steps) < b - a:
        steps.append(min(steps[-1] * growth, 3.0))
    return np.asarray(a + (b - a) * np.r_[0.0, np.cumsum(steps)] / sum(steps))


def layer(s: Setup) -> fe.Mesh:
    """Mesh (axial, radial) [m], fine under the indenter, with element boundaries at the cylinder's ends."""
    r = s.rod
    inner = [np.linspace(0.0, 0.48 * r, 3), np.linspace(0.48 * r, 1.44 * r, 9)[1:]]
    last = 0.12 * r
    at = 1.44 * r
    for stop in (*([s.cylinder[0]] if s.cylinder else []), 1e3 * SIDE):
        part = _span(at, stop, 1.35 * last, 1.35)
        inner.append(part[1:])
        at, last = stop, part[-1] - part[-2]
    radial = np.concatenate(inner)
    stops = sorted({s.height, *([s.height - z for z in s.cylinder[1:] if z > 0] if s.cylinder else [])})
    down, at, last = [np.array([0.0])], 0.0, 0.15 * r / 1.3
    if s.skin:
        down.append(np.linspace(0.0, 1.0, 4)[1:])
        at, last = 1.0, 1.0 / 3.0
    for stop in stops:
        part = _span(at, stop, 1.3 * last, 1.3)
        down.append(part[1:])
        at, last = stop, part[-1] - part[-2]
    axial = s.height - np.concatenate(down)[::-1]
    axial[0] = 0.0
    return quadrilaterals(1e-3 * with_middles(axial), 1e-3 * with_middles(radial))


def push(s: Setup, *, stiffer: float = 1.0) -> dict[str, list[float]]:
    """Depth [mm], and force over G [mm2] in loading and unloading, at the same depths.

    Unloading ends where the indenter separates. The steps are the longest ones that reach the end, or the
    shortest ones if none do.
    """
    for steps in STEPS:
        found = _push(s, stiffer, steps)
        if len(found["in"]) + len(found["out"]) == 2 * FRAMES - 1:
            break
    return found


def _push(s: Setup, stiffer: float, steps: tuple[float, float, float, int]) -> dict[str, list[float]]:
    mesh = layer(s)
    field = mixed_fields(fe.RegionBiQuadraticQuad(mesh), axisymmetric=True)
    dof = np.arange(2 * mesh.npoints).reshape(-1, 2)
    z, x = mesh.points[:, 0], mesh.points[:, 1]
    held = [dof[z < 1e-9, 0], dof[x < 1e-9, 1]]
    if not s.slips:
        held.append(dof[z < 1e-9, 1])
    if s.cylinder is not None:
        radius, low, high = (1e-3 * v for v in s.cylinder)
        held.append(dof[(x < radius + 1e-9) & (z > low - 1e-9) & (z < high + 1e-9)].ravel())
    fixed = np.unique(np.concatenate(held))
    top = np.flatnonzero(z > 1e-3 * s.height - 1e-9)
    top = top[np.argsort(x[top])]
    top = top[x[top] < 5e-3 * s.rod]
    top = top[: len(top) - 1 + len(top) % 2]
    edges = np.stack([top[:-2:2], top[2::2], top[1:-1:2]], -1)
    edge = 1e-3 * s.rod * (0.4 if s.tip == "flat" else 1.0)
    rod = FlatRod(
        mesh, edges, 1e-3 * s.height, 1e-3 * s.rod, edge, s.friction, stiffer * PENALTY, SOFT / stiffer
    )
    mu: Any = MU
    if s.skin:
        middle = z[mesh.cells].mean(axis=1)
        mu = MU * (1.0 + s.skin * (middle > 1e-3 * s.height - 1e-3))
    zero = np.zeros(field[0].values.size)
    law = mixed_law("neo_hookean", RATIO * mu, mu=mu)
    model = MixedModel(field, law, fixed, lambda _: zero, tolerance=1e-6, contact=rod)
    depths = 1e-3 * s.depth * (np.arange(1, FRAMES + 1) / FRAMES) ** 1.3
    there, deepest = _follow(model, rod, 0.0, depths, steps)
    back, _ = _follow(model, rod, deepest, depths[: len(there) - 1][::-1], steps)
    done = f"{len(there)} + {len(back)} of {FRAMES} + {FRAMES - 1} depths"
    print(f"  {done}, {model.solves} solves, {clock():.0f} s", flush=True)
    scale = 1e6 / MU
    return {
        "depth": [round(1e3 * d, 5) for d in depths[: len(there)]],
        "in": [float(f"{scale * f:.6g}") for f in there],
        "out": [float(f"{scale * f:.6g}") for f in (back[::-1])],
    }


def _follow(
    model: MixedModel, rod: FlatRod, at: float, targets: Array, steps: tuple[float, float, float, int]
) -> tuple[list[float], float]:
    """Forces at the targets in turn, by a secant predictor, and the depth where Newton's method stopped."""
    forces: list[float] = []
    last: tuple[float, list[Array]] | None = None
    step, longest, shortest, iterations = steps
    for target in targets:
        while abs(target - at) > 1e-12:
            move = float(np.clip(target - at, -step, step))
            if abs(target - at - move) < 0.3 * step:
                move = target - at
            here = model.state()
            if last is not None:
                ratio = move / (at - last[0])
                model.restore([h + ratio * (h - p) for h, p in zip(here, last[1], strict=True)])
            before = model.solves
            if model.newton(at + move, iterations):
                last, at = (at, here), at + move
                rod.accept(model.field[0].values, at)
                step = min(step * 1.6, longest) if model.solves - before < 7 else step
            else:
                model.restore(here)
                last = None
                step = 0.5 * abs(move)
                if step < shortest:
                    return forces, at
        forces.append(rod.force)
    return forces, at


def rigid(s: Setup, soft: list[float]) -> list[float]:
    """Factors from the forces of the penalty contact to those of a rigid one, by extrapolation in 1/penalty.

    RuntimeError if the run with the stiffer contact does not reach the end.
    """
    stiff = push(s, stiffer=STIFFER)["in"]
    if len(stiff) < len(soft):
        raise RuntimeError("the stiffer contact did not converge to the end")
    gain = [b / a - 1.0 for a, b in zip(soft, stiff, strict=True)]
    return [float(f"{1.0 + g * STIFFER / (STIFFER - 1.0):.5g}") for g in gain]


def main() -> None:
    """Solve the geometries that are not in the file yet."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--only", default="", help="names that hold this")
    asked = parser.parse_args()
    found: dict[str, Any] = json.loads(FILE.read_text()) if FILE.exists() else {}
    for name, s in setups().items():
        if asked.only not in name:
            continue
        if name not in found:
            print(name, flush=True)
            found[name] = {"setup": asdict(s), **push(s)}
        if name in BASES and "rigid" not in found[name]:
            print(f"{name}, stiffer contact", flush=True)
            found[name]["rigid"] = rigid(s, found[name]["in"])
        lines = ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in found.items())
        write_whole(FILE, "{\n" + lines + "\n}\n")


if __name__ == "__main__":
    main()
