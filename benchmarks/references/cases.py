"""Values that tisim is verified against, by FElupe and by CalculiX; writes cases.json beside this file.

    python -m benchmarks.references.cases

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

cube: 20 mm cube, base z = 0 fixed, all nodes of the top moved down by 3 mm (15 %), then also 6 mm along x.
    Total force on the top [N]: Fz at the first state, (Fx, Fz) at the second. FElupe, Q2/P-1 hexahedra on the
    half y >= 0, levels as in beams.py, elements graded towards all faces (singular edges).
box_beam: cantilever 50 x 16 x 16 mm along x, face x = 0 fixed, gravity 9.81 m/s2 along -z, 1000 kg/m3,
    displacement [m] of the centre of the face x = 50 mm. CalculiX, C3D10; and FElupe, Q2/P-1, where the law
    is there.

Volumetric energies: FElupe as the paper and SOFA, K/2 ln^2 J (Neo-Hookean: lam/2 ln^2 J - mu ln J, not
split); CalculiX K/2 (J - 1)^2 (Arruda-Boyce: K/2 ((J^2 - 1)/2 - ln J)), Neo-Hookean split.
"volumetric_effect_percent" is what the choice alone makes of the answer, by FElupe: the Ogden value with
K/2 (J - 1)^2 against ln^2 J. Values are Richardson's from three levels with their observed order;
"error_percent" is their distance from the finest level.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import felupe as fe
import numpy as np

from benchmarks.peers import calculix
from benchmarks.references.boxes import box, tetrahedra, two_sided
from benchmarks.references.cylinder import graded
from benchmarks.references.laws import OgdenIsochoric, mixed_law
from benchmarks.references.mixed import MixedModel, clock, mixed_fields
from benchmarks.whole import write_whole

Array = np.ndarray[Any, Any]
FILE = Path(__file__).with_suffix(".json")
SIDE, PUSH, SHEAR = 0.020, 0.003, 0.006
LENGTH, WIDTH, GRAVITY, DENSITY = 0.050, 0.016, 9.81, 1000.0
LAWS: dict[str, tuple[str, float, dict[str, Any]]] = {
    "neo_hookean": ("neo_hookean", 600e3, {"mu": 30e3}),
    "ogden": ("ogden", 600e3, {"mu": (15e3,), "alpha": (4.0,)}),
    "mooney_rivlin": ("mooney_rivlin", 600e3, {"C10": 9e3, "C01": 6e3}),
    "arruda_boyce": ("arruda_boyce", 600e3, {"mu": 30e3, "locking_stretch": 8**0.5}),
}


def richardson(levels: dict[str, list[float]]) -> tuple[list[float], float, float]:
    """Value, its distance in % from the finest level (largest component over the norm), order.

    The order, between 1 and 4, is that of the largest component, u(m) = u + c / m^p.
    """
    m = sorted(map(int, levels))[-3:]
    a, b, c = (np.array(levels[str(k)]) for k in m)
    k = int(np.abs(c).argmax())
    grid = np.linspace(1, 4, 601)
    ratio = (m[0] ** -grid - m[1] ** -grid) / (m[1] ** -grid - m[2] ** -grid)
    p = float(np.interp((a - b)[k] / (b - c)[k], ratio, grid))
    w = (m[1] / m[2]) ** p
    value = (c - w * b) / (1 - w)
    return value.tolist(), round(float(100 * np.abs(value - c).max() / np.linalg.norm(value)), 4), round(p, 2)


def squared(name: str) -> Any:
    """The Ogden law with CalculiX's volumetric energy (FElupe's default)."""
    _, bulk, p = LAWS[name]
    return fe.NearlyIncompressible(OgdenIsochoric(p["mu"], p["alpha"]), bulk)


def law_of(name: str) -> Any:
    """Mixed FElupe law of a row of LAWS."""
    kind, bulk, parameters = LAWS[name]
    return mixed_law(kind, bulk, **parameters)


def cube(law: Any, level: int) -> list[float]:
    """Fz at 3 mm down, then Fx and Fz with 6 mm of shear on top of it [N]."""
    both = two_sided(4 * level, 1.2)
    y = 1 - graded(2 * level, 1.2)[::-1]
    mesh = box([SIDE * (both - 0.5), SIDE * y / 2, SIDE * both])
    region = fe.RegionTriQuadraticHexahedron(mesh)
    field = mixed_fields(region)
    kind = np.full((mesh.npoints, 3), -1)  # 0: held, 1: moved in x, 2: moved in z
    kind[mesh.points[:, 1] < 1e-9, 1] = 0
    kind[mesh.points[:, 2] < 1e-9] = 0
    top = mesh.points[:, 2] > SIDE - 1e-9
    kind[top] = (1, 0, 2)
    fixed = np.flatnonzero(kind.ravel() >= 0)
    which = kind.ravel()[fixed]

    def prescribed(t: float) -> Array:
        return np.array([0.0, SHEAR * max(t - 1, 0.0), -PUSH * min(t, 1.0)])[which]

    model = MixedModel(field, law, fixed, lambda _: np.zeros(field[0].values.size), prescribed)
    out: list[float] = []

    def report(t: float) -> None:
        fx, fz = (2 * float(model.reaction[which == k].sum()) for k in (1, 2))
        out.extend([fz] if t < 1.5 else [fx, fz])
        print(f"  cube level {level}, state {t:.0f}: Fx {fx:.5f} Fz {fz:.5f} N, {clock():.0f} s", flush=True)

    if not model.path(0.0, [1.0, 2.0], report, 0.25):
        raise RuntimeError("the cube found no equilibrium")
    return out


def box_axes(level: int, half: bool) -> list[Array]:
    """Lattice of the box beam, graded towards the clamp and the surface."""
    across = WIDTH * (two_sided(2 * level, 1.2) - 0.5)
    y = across[len(across) // 2 :] if half else across
    return [LENGTH * graded(3 * level, 2.5), y, across]


def beam_felupe(law: Any, level: int) -> list[float]:
    """Tip displacement (dx, dz) [m] on the half y >= 0."""
    mesh = box(box_axes(level, half=True))
    region = fe.RegionTriQuadraticHexahedron(mesh)
    field = mixed_fields(region)
    dof = np.arange(3 * mesh.npoints).reshape(-1, 3)
    fixed = np.concatenate([dof[mesh.points[:, 0] < 1e-9].ravel(), dof[np.abs(mesh.points[:, 1]) < 1e-9, 1]])
    share = np.einsum("aqc,qc->ca", np.broadcast_to(region.h, (27, *region.dV.shape)), region.dV)
    weight = np.zeros((mesh.npoints, 3))
    np.add.at(weight[:, 2], mesh.cells.ravel(), -share.ravel() * DENSITY * GRAVITY)
    model = MixedModel(field, law, np.unique(fixed), lambda t: weight.ravel() * t)
    if not model.path(0.0, [1.0], lambda _: None, 0.5):
        raise RuntimeError("the box beam found no equilibrium")
    tip = int(np.argmin(np.linalg.norm(mesh.points - [LENGTH, 0, 0], axis=1)))
    return field[0].values[tip, [0, 2]].tolist()


def beam_calculix(name: str, level: int) -> list[float]:
    """Tip displacement (dx, dz) [m], C3D10 on the whole beam."""
    mesh = box(box_axes(level, half=False))
    kind, bulk, parameters = LAWS[name]
    cells = tetrahedra(mesh.cells)
    clamp = np.flatnonzero(mesh.points[:, 0] < 1e-9)
    card = calculix.hyperelastic(kind, bulk, **parameters)
    found = calculix.solve(mesh.points, cells, card, calculix.fixed(clamp), (0, 0, -GRAVITY), DENSITY)
    if not found.converged:
        raise RuntimeError(found.log[-500:])
    tip = int(np.argmin(np.linalg.norm(mesh.points - [LENGTH, 0, 0], axis=1)))
    return found.displacement[tip, [0, 2]].tolist()


def main() -> None:
    """Solve all cases and write cases.json."""
    cases: list[dict[str, Any]] = []

    def add(case: str, by: str, name: str, levels: dict[str, list[float]], keys: list[str]) -> None:
        kind, bulk, parameters = LAWS[name]
        value, error, order = richardson(levels)
        entry = {"case": case, "by": by, "law": kind, "parameters": {**parameters, "K": bulk}}
        entry |= dict(zip(keys, value, strict=True))
        entry |= {"levels": levels, "order": order, "error_percent": error}
        if kind == "neo_hookean":
            entry["parameters"]["lambda"] = bulk - 2 * parameters["mu"] / 3
        if by == "felupe" and kind == "ogden":
            coarse = beam_felupe(squared(name), 2) if case == "box_beam" else cube(squared(name), 2)
            effect = np.abs(np.array(coarse) - levels["2"]).max() / np.linalg.norm(levels["2"])
            entry["volumetric_effect_percent"] = round(100 * float(effect), 4)
        cases.append(entry)
        print(case, by, name, value, f"error {error} %, {clock():.0f} s", flush=True)
        about = {"units": "m, N, Pa, kg/m3", "cube": {"side": SIDE, "push": PUSH, "shear": SHEAR},
                 "box_beam": {"length": LENGTH, "width": WIDTH, "gravity": GRAVITY, "density": DENSITY},
                 "calculix": "2.20, K/2 (J-1)^2", "felupe": fe.__version__}  # fmt: skip
        write_whole(FILE, json.dumps({"about": about, "cases": cases}, indent=1) + "\n")

    for name in LAWS:
        levels = {str(m): beam_calculix(name, m) for m in (3, 4, 5)}
        add("box_beam", "calculix", name, levels, ["dx", "dz"])
        if name != "arruda_boyce":
            levels = {str(m): beam_felupe(law_of(name), m) for m in (2, 3, 5)}
            add("box_beam", "felupe", name, levels, ["dx", "dz"])
    for name in ("neo_hookean", "ogden"):
        levels = {str(m): cube(law_of(name), m) for m in (1, 2, 3)}
        add("cube", "felupe", name, levels, ["Fz_pushed", "Fx_sheared", "Fz_sheared"])


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
