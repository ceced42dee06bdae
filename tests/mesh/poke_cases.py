"""Random indentations of blocks with inclusions, and assertions on their meshes."""

import numpy as np

from tisim.bodies import Block, BoxInclusion, CylinderInclusion, SphereInclusion
from tisim.mesh._elements import det_jacobian, quadrature
from tisim.mesh._mesh import ELEMENT_FACETS, HEXAHEDRA, Mesh, boundary_facets


def gauss_jacobians(mesh: Mesh) -> np.ndarray:
    """Weighted determinants det J w at the quadrature points (elements, points); a row sums to the volume."""
    places, weights = quadrature(mesh.kind)
    return det_jacobian(mesh.kind, mesh.nodes, mesh.elements, places) * weights


def random_poke(rng: np.random.Generator) -> dict:
    """Random arguments of `poke_mesh` except the indenter; inclusions lie on, above or below the base."""
    x, y = rng.uniform(-0.030, 0.030, 2)
    kind = rng.integers(3)
    if kind == 0:
        a, b, h = rng.uniform(0.008, 0.026, 3)
        z = h / 2 + rng.choice([0.0, 0.0, -0.002, 0.003])
        inclusion = BoxInclusion(size=(a, b, h), centre=(x, y, z), angle=rng.uniform(-4, 4))
    elif kind == 1:
        r = rng.uniform(0.004, 0.0135)
        inclusion = SphereInclusion(radius=r, centre=(x, y, r * rng.choice([1.0, 1.0, 0.5, 0.0, -0.4, 1.2])))
    else:
        r, h = rng.uniform(0.004, 0.014), rng.uniform(0.005, 0.026)
        inclusion = CylinderInclusion(radius=r, height=h, centre=(x, y, h / 2 + rng.choice([0.0, 0.003])))
    tilt, azimuth = rng.uniform(0, np.pi / 4), rng.uniform(-np.pi, np.pi)
    s = np.sin(tilt)
    direction = (s * np.cos(azimuth), s * np.sin(azimuth), -np.cos(tilt))
    return {
        "block": Block(inclusion=inclusion),
        "site": tuple(rng.uniform(-0.030, 0.030, 2)),
        "direction": direction,
    }


def gap_to_rigid(inclusion: object, points: np.ndarray) -> np.ndarray:
    """Unsigned distance (n,) [m] of points (n, 3) from the inclusion's surface, along the nearest face."""
    p = points - np.array(inclusion.centre)
    if isinstance(inclusion, SphereInclusion):
        return np.abs(np.linalg.norm(p, axis=1) - inclusion.radius)
    if isinstance(inclusion, CylinderInclusion):
        across, half = np.hypot(p[:, 0], p[:, 1]) - inclusion.radius, inclusion.height / 2
    else:
        c, s = np.cos(inclusion.angle), np.sin(inclusion.angle)
        q = np.abs(p[:, :2] @ np.array([[c, -s], [s, c]]))
        across, half = (q - np.array(inclusion.size[:2]) / 2).max(axis=1), inclusion.size[2] / 2
    return np.abs(np.maximum(across, np.abs(p[:, 2]) - half))


def true_volume(inclusion: object) -> float:
    """Volume of the inclusion above z = 0 [m3]."""
    z = inclusion.centre[2]
    if isinstance(inclusion, SphereInclusion):
        r = inclusion.radius
        t = min(z, r)
        return np.pi * (r**3 * 2 / 3 + r**2 * t - t**3 / 3)
    if isinstance(inclusion, CylinderInclusion):
        h, area = inclusion.height, np.pi * inclusion.radius**2
    else:
        h, area = inclusion.size[2], inclusion.size[0] * inclusion.size[1]
    return area * (z + h / 2 - max(0.0, z - h / 2))


def assert_matching_facets(mesh: Mesh) -> None:
    """Assert that each facet, as a set of nodes, lies in one or two elements, and single ones close the body.

    A set of nodes, unlike a list of four, distinguishes a triangle of a wedge from half of a quadrilateral.
    """
    n = 4 if mesh.kind in HEXAHEDRA else 3
    local = np.array([f[:n] for f in ELEMENT_FACETS[mesh.kind]])
    facets = _sets_of_nodes(mesh.elements[:, local].reshape(-1, local.shape[1]))
    facets = facets[facets[:, -3] >= 0]  # of three nodes at least
    sets, count = np.unique(facets, axis=0, return_counts=True)
    assert count.max() <= 2
    surface = boundary_facets(mesh.kind, mesh.elements)
    corners = surface[:, :n]
    assert np.array_equal(np.unique(_sets_of_nodes(corners), axis=0), sets[count == 1])
    directed = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1).reshape(-1, 2)
    directed = directed[directed[:, 0] != directed[:, 1]]
    # closed and consistently oriented: each edge is traversed equally often in both directions
    directed = directed.astype(np.int64)
    key = directed.min(axis=1) * mesh.n_nodes + directed.max(axis=1)
    _, edge = np.unique(key, return_inverse=True)
    assert not np.bincount(edge, np.sign(directed[:, 1] - directed[:, 0])).any()
    assert np.array_equal(np.unique(mesh.elements), np.arange(mesh.n_nodes))


def _sets_of_nodes(facets: np.ndarray) -> np.ndarray:
    """Each row's nodes in ascending order, a repeated one once; -1 fills up from the left."""
    rows = np.sort(facets, axis=1)
    rows[:, 1:][rows[:, 1:] == rows[:, :-1]] = -1
    return np.sort(rows, axis=1)


def assert_good(mesh: Mesh, block: Block) -> None:
    """Assert positive determinants, the volume of block minus inclusion, fixed nodes on rigid surfaces."""
    determinants = gauss_jacobians(mesh)
    assert determinants.min() > 0
    # near a wedge's collapsed edge the 27 points of a hex20 have smaller determinants
    least = 0.01 if mesh.kind == "hex20" else 0.03
    assert (determinants.min(axis=1) > least * determinants.max(axis=1)).all()
    inclusion = block.inclusion
    lost = np.prod(block.size) - determinants.sum()
    ratio = lost / true_volume(inclusion)
    corners = np.unique(mesh.elements[:, :8] if mesh.kind in HEXAHEDRA else mesh.elements)
    held = mesh.nodes[np.intersect1d(mesh.node_sets["base"], corners)]  # mid-side nodes lie on chords
    off = np.minimum(np.abs(held[:, 2]), gap_to_rigid(inclusion, held))
    if isinstance(inclusion, BoxInclusion):
        assert abs(ratio - 1) < 1e-9
    elif isinstance(inclusion, CylinderInclusion):
        assert (0.95 if mesh.kind == "hex20" else 0.90 - 1e-9) < ratio < 1 + 1e-3
    else:
        # facets under the dome, and a rigid fill if the gap to the base is thin
        assert (0.75 if mesh.kind == "hex20" else 0.65) < ratio < (1.15 if mesh.kind == "hex20" else 1.10)
        p = held - np.array(inclusion.centre)
        in_fill = (p[:, 2] < 0) & (np.hypot(p[:, 0], p[:, 1]) < inclusion.radius * (1 + 1e-9))
        off[in_fill] = 0.0
    assert off.max() < 1e-9
    # all nodes on the rigid surface are fixed: the rest of the boundary is the top and the sides
    facets = mesh.facet_sets["surface"]
    free = ~np.isin(facets, mesh.node_sets["base"]).all(axis=1)
    at = mesh.nodes[facets[free]]
    walls = [np.abs(at[..., k] - e * block.size[k] / 2).max(axis=1) < 1e-9 for k in (0, 1) for e in (-1, 1)]
    walls.append(np.abs(at[..., 2] - block.size[2]).max(axis=1) < 1e-9)
    assert np.any(walls, axis=0).all()
    assert np.isin(facets[~free], mesh.node_sets["base"]).all()
