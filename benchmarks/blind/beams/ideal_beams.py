"""Silhouettes of the ideal beam (without faults) at any modulus, by interpolation in a table.

The shape of a nearly incompressible neo-Hookean beam depends on rho g / mu, length and radius, and
dimensionless only on two ratios of these, so that a table over load and length (at one radius) suffices.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.model import GRAVITY, Beam, Resolution
from benchmarks.blind.beams.solver import axis_of, solve
from benchmarks.whole import whole_file

Array = NDArray[np.float64]
RADIUS = 0.010
LENGTHS = ((0.050, False), (0.100, False), (0.150, True))  # free length [m], bridge
STRETCH = np.array([0.965, 1.0, 1.035])  # lengths of the table over the nominal one
LOAD = (0.15, 1.22)  # rho g / mu [1/m]
LOADS = 14
POINTS = 33
START = 0.0008  # distance of an edge's first point from the clamp face [m]


def chebyshev(low: float, high: float, count: int) -> Array:
    """Chebyshev-Lobatto points, ascending."""
    return low + (high - low) * (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2


def barycentric(nodes: Array, at: Array) -> Array:
    """Matrix (len(at), len(nodes)) of polynomial interpolation from nodes, which should be Chebyshev-like."""
    gap = at[:, None] - nodes
    hit = gap == 0
    share = _weights(nodes.tobytes()) / np.where(hit, 1.0, gap)
    share[hit.any(axis=1)] = hit[hit.any(axis=1)]
    return np.asarray(share / share.sum(axis=1, keepdims=True))


@lru_cache(maxsize=32)
def _weights(raw: bytes) -> Array:
    nodes = np.frombuffer(raw)
    apart = (nodes[:, None] - nodes) / (np.ptp(nodes) / 4)
    np.fill_diagonal(apart, 1.0)
    return np.asarray(1 / apart.prod(axis=1))


def edge_points(kind: int) -> Array:
    """Positions s of the stored edge points of a kind (index of LENGTHS), as fractions of the length."""
    length, bridge = LENGTHS[kind]
    first = START / length
    return chebyshev(first, 1 - first if bridge else 1.0, POINTS)


def interpolate(kind: int, edges: Array, s: Array) -> Array:
    """Edges (2, POINTS, 2) interpolated to positions s: (2, len(s), 2)."""
    return np.einsum("sk,ekc->esc", barycentric(edge_points(kind), s), edges)


@dataclass(frozen=True, eq=False)
class Table:
    """Table of ideal beams.

    Attributes ---------- edges : silhouettes [m], shape (kinds, lengths, loads, 2, POINTS, 2). axes : for
    each kind the axes at the nominal length, shape (loads, planes, 4), as `solver.axis_of`; initial
        guesses for beams with faults.
    """

    edges: Array
    axes: tuple[Array, ...]

    @cached_property
    def loads(self) -> Array:
        return np.exp(chebyshev(np.log(LOAD[0]), np.log(LOAD[1]), LOADS))

    def covers(self, beam: Beam, kind: int) -> bool:
        length, load = self._place(beam, kind)
        return bool(STRETCH[0] <= length <= STRETCH[-1] and LOAD[0] <= load <= LOAD[1])

    def ideal_edges(self, beam: Beam, kind: int) -> Array:
        """Silhouette (2, POINTS, 2) [m] for a beam's length, radius, modulus and density, without faults.

        ValueError if the length or the load is outside the table.
        """
        length, load = self._place(beam, kind)
        if not self.covers(beam, kind):
            raise ValueError(
                f"length or load beyond the table: {length:.4f} of nominal, {load:.3f} per metre"
            )
        return (beam.radius / RADIUS) * np.einsum(
            "i,j,ijesc->esc",
            barycentric(STRETCH, np.array([length]))[0],
            barycentric(np.log(self.loads), np.log([load]))[0],
            self.edges[kind],
        )

    def start(self, beam: Beam, kind: int) -> Array:
        """Axis of the ideal beam at the nearest load of the table, scaled to the beam's length."""
        _, load = self._place(beam, kind)
        near = int(np.abs(np.log(self.loads / load)).argmin())
        axis = self.axes[kind][near].copy()
        axis[:, :3] *= beam.length / LENGTHS[kind][0]
        return axis

    @staticmethod
    def _place(beam: Beam, kind: int) -> tuple[float, float]:
        size = beam.radius / RADIUS
        return beam.length / size / LENGTHS[kind][0], beam.density * GRAVITY / beam.mu * size


def make_table(resolution: Resolution) -> Table:
    """Solve all beams of the table, from stiff to soft."""
    loads = np.exp(chebyshev(np.log(LOAD[0]), np.log(LOAD[1]), LOADS))
    edges = np.empty((len(LENGTHS), len(STRETCH), LOADS, 2, POINTS, 2))
    axes = []
    for kind, (nominal, bridge) in enumerate(LENGTHS):
        kept = []
        for column, stretch in enumerate(STRETCH):
            start = None
            for row, load in enumerate(loads):
                beam = Beam(length=nominal * stretch, bridge=bridge, mu=1000.0 * GRAVITY / load)
                shape = solve(beam, start=start, resolution=resolution)
                start = axis_of(shape)
                edges[kind, column, row] = shape.edges(edge_points(kind))
                if stretch == 1.0:
                    kept.append(start)
        axes.append(np.array(kept))
    return Table(edges, tuple(axes))


def table(path: Path, resolution: Resolution) -> Table:
    """Table stored at `path`; computed and stored if there is none."""
    if path.exists():
        with np.load(path) as kept:
            return Table(kept["edges"], tuple(kept[f"axis_{k}"] for k in range(len(LENGTHS))))
    made = make_table(resolution)
    path.parent.mkdir(parents=True, exist_ok=True)
    axes = {f"axis_{k}": axis for k, axis in enumerate(made.axes)}
    with whole_file(path) as file:
        np.savez_compressed(file, allow_pickle=False, edges=made.edges, **axes)
    return made


def true_edges(kept: Table, beam: Beam, kind: int, resolution: Resolution) -> Array:
    """Silhouette (2, POINTS, 2) [m]: interpolated if the beam has no fault and is in range, else solved."""
    plain = Beam(length=beam.length, bridge=beam.bridge, mu=beam.mu, density=beam.density, radius=beam.radius)
    if plain == beam and kept.covers(beam, kind):
        return kept.ideal_edges(beam, kind)
    shape = solve(beam, start=kept.start(beam, kind), resolution=resolution)
    return shape.edges(edge_points(kind))
