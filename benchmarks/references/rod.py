"""A rigid round rod, flat with a rounded edge, against an axisymmetric surface: penalty, Coulomb friction.

Coordinates as FElupe has them: component 0 axial (upwards here), component 1 radial [m]. The rod is the set
of points within the edge radius of {r <= flat, z >= tip + edge radius}: the gap is a distance minus that
radius. The tangential coordinate s is the arc length along the rod's outline from its axis. Traction on the
reference area: p = penalty <-gap>, rounded off over the first `soft` of penetration; t = tangential penalty
(s - anchor), held below friction p by return mapping. The anchor is where the point first touched (at the end
of the step it touched in).
"""

from __future__ import annotations

from typing import Any

import felupe as fe
import numpy as np
import scipy.sparse as sp

Array = np.ndarray[Any, Any]


def pressure(gap: Array, penalty: float, soft: float) -> Array:
    """Linear in the penetration past `soft` [m], quadratic before; penalty [Pa/m]."""
    d = np.maximum(-gap, 0.0)
    return penalty * np.where(d < soft, d**2 / (2 * soft), d - soft / 2)


class FlatRod:
    """Contact term of `mixed.MixedModel`; the load factor is the rod's travel [m]."""

    def __init__(
        self,
        mesh: fe.Mesh,
        edges: Array,
        top: float,
        radius: float,
        edge_radius: float,
        friction: float,
        penalty: float,
        soft: float = 1e-5,
        order: int = 7,
    ) -> None:
        """edges: (n, 3) nodes of quadratic edges (two ends, middle); penalty [Pa/m], soft [m].

        friction inf sticks (it is taken as 1e6).
        """
        self.nodes, self.top, self.flat, self.edge = edges, top, radius - edge_radius, edge_radius
        self.friction, self.penalty, self.stick = min(friction, 1e6), penalty, 0.5 * penalty
        self.soft, self.size = soft, mesh.points.size
        a, w = np.polynomial.legendre.leggauss(order)
        self.shape = np.stack([a * (a - 1) / 2, a * (a + 1) / 2, 1 - a**2], -1)  # (q, 3)
        slope = np.stack([a - 0.5, a + 0.5, -2 * a], -1)
        self.rest = mesh.points
        X = mesh.points[edges]
        self.weight = 2 * np.pi * (X[..., 1] @ self.shape.T) * np.abs(X[..., 1] @ slope.T) * w  # (e, q)
        self.anchor = np.full(self.weight.shape, np.nan)
        self.force, self.deepest = 0.0, 0.0
        self.accept(np.zeros_like(mesh.points), 0.0)

    def _place(self, x: Array, travel: float) -> tuple[Array, Array, Array, Array]:
        """gap, s, outward normal and tangent (d s/d x) of points (..., 2)."""
        height, r = x[..., 0] - (self.top - travel), x[..., 1]
        dr, dz = np.maximum(r - self.flat, 0.0), np.maximum(self.edge - height, 0.0)
        distance = np.maximum(np.hypot(dr, dz), 1e-12)
        normal = np.stack([-dz, dr], -1) / distance[..., None]
        angle = np.arctan2(dr, dz)
        s = np.minimum(r, self.flat) + self.edge * angle + np.maximum(height - self.edge, 0.0)
        along = np.where((dr > 0) & (dz > 0), self.edge / distance, 1.0)
        tangent = np.stack([normal[..., 1], -normal[..., 0]], -1) * along[..., None]
        return distance - self.edge, s, normal, tangent

    def traction(self, x: Array, travel: float) -> Array:
        """Force a reference area on the surface [Pa], (..., 2)."""
        gap, s, normal, tangent = self._place(x, travel)
        p = pressure(gap, self.penalty, self.soft)
        t = np.where(np.isnan(self.anchor), 0.0, self.stick * (s - np.nan_to_num(self.anchor)))
        limit = self.friction * p
        return p[..., None] * normal - np.clip(t, -limit, limit)[..., None] * tangent

    def assemble(self, u: Array, factor: float) -> tuple[Array, sp.csr_matrix]:
        """Residual and tangent (central differences of the traction in the plane)."""
        x = np.einsum("qa,eai->eqi", self.shape, (self.rest + u)[self.nodes])
        f = self.traction(x, factor) * self.weight[..., None]
        dof = 2 * self.nodes[..., None] + np.arange(2)
        residual = np.zeros(self.size)
        np.add.at(residual, dof, -np.einsum("qa,eqi->eai", self.shape, f))
        h, columns = 1e-10, []
        for k in range(2):
            d = h * np.eye(2)[k]
            columns.append((self.traction(x + d, factor) - self.traction(x - d, factor)) / (2 * h))
        slope = np.stack(columns, -1) * self.weight[..., None, None]
        block = -np.einsum("qa,eqij,qb->eaibj", self.shape, slope, self.shape).reshape(len(dof), -1)
        index = dof.reshape(len(dof), 6)
        rows, cols = np.repeat(index, 6, axis=1), np.tile(index, (1, 6))
        matrix = sp.csr_matrix((block.ravel(), (rows.ravel(), cols.ravel())), shape=(self.size, self.size))
        return residual, matrix

    def accept(self, u: Array, factor: float) -> None:
        """Anchors of new touches, slip of old ones; force on the rod and deepest penetration."""
        x = np.einsum("qa,eai->eqi", self.shape, (self.rest + u)[self.nodes])
        gap, s, _, _ = self._place(x, factor)
        self.force = -float((self.traction(x, factor)[..., 0] * self.weight).sum())
        self.deepest = float(np.maximum(-gap, 0.0).max())
        p = pressure(gap, self.penalty, self.soft)
        limit = self.friction * p / self.stick
        held = s - np.clip(s - self.anchor, -limit, limit)
        touching = gap < (1e-12 if factor == 0 else 0.0)
        self.anchor = np.where(touching, np.where(np.isnan(self.anchor), s, held), np.nan)
