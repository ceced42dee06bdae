"""Shared by the static tests: small distorted meshes, bodies with fixed nodes, beams of the references."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from tisim import laws
from tisim.discretisation.body import Discretisation, DiscretisedBody
from tisim.material import Material
from tisim.mesh import Mesh, boundary_facets
from tisim.mesh.refine import to_quadratic
from tisim.nonlinear.newton import newton
from tisim.problems.beam.system import BeamSystem
from tisim.result import Result, Status
from tisim.scene import Beam

REFERENCES = Path(__file__).parents[2] / "benchmarks" / "references"
# the six tetrahedra of a hexahedron about its long diagonal (Kuhn)
_KUHN = np.array([[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]])


def neo_hookean(mu: float, ratio: float) -> Material:
    """Neo-Hookean material of shear modulus `mu` [Pa] and bulk modulus ratio * mu."""
    return Material(law="neo-hookean", parameters={"mu": mu, "lam": (ratio - 2 / 3) * mu})


def of_reference(entry: dict[str, Any]) -> Material:
    """Material of an entry of benchmarks/references/*.json."""
    p = entry["parameters"]
    known: dict[str, dict[str, str]] = {
        "neo_hookean": {"mu": "mu", "lam": "lambda"},
        "mooney_rivlin": {"c10": "C10", "c01": "C01", "bulk": "K"},
        "ogden": {"mu": "mu", "alpha": "alpha", "bulk": "K"},
        "arruda_boyce": {"mu": "mu", "locking": "locking_stretch", "bulk": "K"},
    }
    values = {ours: p[theirs] for ours, theirs in known[entry["law"]].items()}
    return Material(
        law=entry["law"].replace("_", "-"),
        parameters={k: tuple(v) if isinstance(v, list) else v for k, v in values.items()},
    )


def references(name: str) -> dict[str, Any]:
    return json.loads((REFERENCES / name).read_text())


def beam_of(entry: dict[str, Any], **changes: Any) -> Beam:
    """The scene of an entry of beams.json."""
    kind, length = entry["case"].split("-")
    supports: Any = "clamped-clamped" if kind == "bridge" else "clamped-free"
    return Beam(material=of_reference(entry), length=float(length) / 1e3, supports=supports, **changes)


def deflection(result: Result) -> np.ndarray:
    """Displacement (3,) [m] of the centre of the end, or of mid-span if both ends are clamped."""
    scene = result.scene
    assert isinstance(scene, Beam)
    assert result.ok, result.message
    place = [scene.length / (2 if scene.supports == "clamped-clamped" else 1), 0.0, 0.0]
    distance = np.linalg.norm(result.mesh.nodes - place, axis=1)
    assert distance.min() < 1e-9
    return (result.positions[-1] - result.mesh.nodes)[distance.argmin()]


def awkward(kind: str, cells: tuple[int, int, int] = (3, 3, 2), *, bend: float = 0.0, seed: int = 3) -> Mesh:
    """Box of distorted elements, cells of 10 mm; hexahedra with every third column split into wedges.

    `bend` [m] is the largest offset of the mid-side nodes of a tet10, per component.
    """
    rng = np.random.default_rng(seed)
    shape = np.array(cells) + 1
    number = np.arange(shape.prod()).reshape(shape)
    i, j, k = (c.ravel() for c in np.meshgrid(*(np.arange(n) for n in cells), indexing="ij"))
    ring = ((0, 0), (1, 0), (1, 1), (0, 1))
    hexes = np.stack([number[i + a, j + b, k + c] for c in (0, 1) for a, b in ring], axis=1)
    nodes = 0.01 * np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), -1).reshape(-1, 3)
    nodes += rng.uniform(-0.0015, 0.0015, nodes.shape)
    if kind in ("hex8", "hex20"):
        split = (i + j) % 3 == 0
        wedges = [hexes[split][:, list(c)] for c in ((0, 1, 2, 2, 4, 5, 6, 6), (0, 2, 3, 3, 4, 6, 7, 7))]
        mesh = Mesh(kind="hex8", nodes=nodes, elements=np.concatenate([hexes[~split], *wedges]))
        return mesh if kind == "hex8" else to_quadratic(mesh)
    mesh = Mesh(kind="tet4", nodes=nodes, elements=hexes[:, _KUHN].reshape(-1, 4))
    if kind == "tet4":
        return mesh
    mesh = to_quadratic(mesh)
    moved = mesh.nodes.copy()
    moved[len(nodes) :] += rng.uniform(-bend, bend, moved[len(nodes) :].shape)
    return Mesh(kind="tet10", nodes=moved, elements=mesh.elements)


def boundary(mesh: Mesh) -> np.ndarray:
    """Numbers of the boundary nodes."""
    return np.unique(boundary_facets(mesh.kind, mesh.elements))


def body_of(
    mesh: Mesh, law: str, fixed: Any, *, ratio: float = 50.0, held: Any = None, **kw: Any
) -> DiscretisedBody:
    """Body with G = 10 kPa and K = ratio * G."""
    material = Material(law=law, parameters=laws.get(law).from_moduli(1e4, ratio * 1e4))
    return DiscretisedBody(
        Discretisation.build(mesh, np.asarray(fixed, dtype=np.int32), held), material, **kw
    )


def settle(body: DiscretisedBody, start: np.ndarray, pressure: np.ndarray | None = None) -> np.ndarray:
    """Equilibrium without load from `start`, to rounding; fixed nodes keep their positions in `start`.

    If element pressures are given, they are first iterated as unknowns (quick); then the potential is
    minimised.
    """
    system = BeamSystem(body, tolerance=1e-9)
    for way in (pressure, None):
        system.free_pressures(way)
        outcome = newton(system, start, tolerance=1e-9, max_iterations=40 if way is None else 12)
        if outcome.status is Status.CONVERGED:
            return outcome.x
    raise AssertionError(outcome)
