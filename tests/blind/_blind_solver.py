"""Equilibrium of a heavy silicone beam with faults: the solver that makes the blind data.

Bricks of degree 2 with discontinuous pressures (`_blind_element`), Newton on positions and pressures, and
elimination layer by layer (`_blind_elimination`): a beam's matrix is block tridiagonal. It shares no code
with `tisim`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from _blind_beam import Beam, Resolution
from _blind_element import assemble, smallest_volume
from _blind_elimination import newton_step
from _blind_mesh import lagrange, lobatto
from _blind_model import Model, held_face, mesh
from numpy.typing import NDArray

Array = NDArray[np.float64]


class NoEquilibriumError(RuntimeError):
    """No equilibrium was found."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A solved beam: positions (planes, n, 3) [m], the clamps' turns [rad] (positive: slope up), Newton
    steps."""

    model: Model
    x: Array
    turn: Array
    steps: int

    def edges(self, s: Array) -> Array:
        """Silhouette (2, len(s), 2): x, z [m] of the upper and lower edge at s in [0, 1], the ideal prism's x
        over its free length."""
        planes = self.model.ideal[:, 0, 0]
        degree, at = self.model.degree, s * self.model.beam.length
        layer = np.clip(np.searchsorted(planes[::degree], at, side="right") - 1, 0, len(planes) // degree - 1)
        low, high = planes[layer * degree], planes[(layer + 1) * degree]
        value, _ = lagrange(lobatto(degree), 2 * (at - low) / (high - low) - 1)
        columns = layer[:, None] * degree + np.arange(degree + 1)
        ends = [self.model.section.top, self.model.section.bottom]
        edges = np.einsum("sk,skec->esc", value, self.x[columns][:, :, ends][..., [0, 2]])
        # a grip that reaches out over its face holds what lies in it straight
        for end, beyond in ((0, np.minimum(at - planes[0], 0)), (-1, np.maximum(at - planes[-1], 0))):
            turn = self.turn[end] if len(self.turn) == 2 or end == 0 else 0.0
            held = beyond != 0
            ray = beyond[held, None] * np.array([np.cos(turn), np.sin(turn)])
            edges[:, held] = self.x[end, ends][:, None, [0, 2]] + ray
        return edges


def solve(beam: Beam, *, start: Array | None = None, resolution: Resolution | None = None) -> Shape:
    """Equilibrium. start (k, 4): x, z, slope angle of the axis at the ideal x in column 0, to begin from;
    without it the load is raised in steps. Raises NoEquilibriumError."""
    model = mesh(beam, resolution or Resolution())
    if start is not None:
        try:
            return _newton(model, _from_axis(model, start), 1.0)
        except NoEquilibriumError:
            pass
    x, factor, step = model.ideal.copy(), 0.0, 0.25
    x[0] = held_face(model, 0, beam.near_tilt)[0]
    shape: Shape | None = None
    while factor < 1.0:
        try:
            shape = _newton(model, x, min(1.0, factor + step))
        except NoEquilibriumError:
            step /= 2
            if step < 0.01:
                raise
            continue
        x, factor, step = shape.x, min(1.0, factor + step), 1.5 * step
    assert shape is not None
    return shape


def axis_of(shape: Shape) -> Array:
    """(planes, 4): ideal x, then x, z and slope angle of the axis, as `solve` takes for its start."""
    flat = shape.model.section.flat
    x = shape.x[:, flat]
    up = x[:, shape.model.section.nodes[flat, 1].argmax()] - x[:, shape.model.section.nodes[flat, 1].argmin()]
    centre = x.mean(axis=1)
    return np.stack(
        [shape.model.ideal[:, 0, 0], centre[:, 0], centre[:, 2], np.arctan2(-up[:, 0], up[:, 2])], axis=1
    )


def _from_axis(model: Model, start: Array) -> Array:
    """The prism bent along an axis, turned by the tilt (a bridge's tilt fades), closed by the gap."""
    ideal, beam = model.ideal, model.beam
    at = ideal[:, 0, 0]
    cx, cz, slope = (np.interp(at, start[:, 0], start[:, k]) for k in (1, 2, 3))
    cx += np.minimum(at - start[0, 0], 0) + np.maximum(at - start[-1, 0], 0)
    share = np.clip(at / beam.length, 0, 1)
    if beam.bridge:
        cz = cz + beam.near_tilt * beam.length * share * (1 - share) ** 2
        slope = slope + beam.near_tilt * (1 - share) * (1 - 3 * share)
        cx = cx - beam.gap * share
    else:
        turn = beam.near_tilt + beam.curvature * at * 0.5
        c, s = np.cos(turn), np.sin(turn)
        cx, cz, slope = c * cx - s * cz, s * cx + c * cz, slope + turn
    # bent, an incompressible section narrows where it is stretched: Newton starts near J = 1
    bend = np.gradient(slope, at)[:, None] - beam.curvature
    y = ideal[..., 1] * (1 + bend * ideal[..., 2] / 2)
    z = ideal[..., 2] + bend * (ideal[..., 2] ** 2 - ideal[..., 1] ** 2) / 4
    return np.stack(
        [cx[:, None] - z * np.sin(slope)[:, None], y, cz[:, None] + z * np.cos(slope)[:, None]], axis=-1
    )


def _newton(model: Model, x: Array, factor: float) -> Shape:
    """Newton at `factor` of the load, on positions, pressures and the turns of clamps that yield."""
    beam, x = model.beam, x.copy()
    ends = (0, -1) if beam.bridge else (0,)
    base = np.array([beam.near_tilt, 0.0][: len(ends)])
    spring = np.full(len(ends), np.inf)  # clamp's stiffness over mu, for the half beam
    if beam.compliance:
        spring[:] = 0.5 / (beam.compliance * beam.mu)
    if beam.far_pinned and beam.bridge:
        spring[1] = 0.0
    loose = np.flatnonzero(np.isfinite(spring))
    turn = base.copy()
    p = np.zeros((len(model.element), model.bricks.pressure.shape[1]))
    if smallest_volume(model.bricks, x.reshape(-1, 3)[model.element]) <= 0.0:
        raise NoEquilibriumError("the start is turned inside out")
    for step in range(1, 13):
        slopes = []
        moves = np.zeros_like(x)
        for k, end in enumerate(ends):
            face, slope = held_face(model, end, float(turn[k]))
            moves[end] = face - x[end]
            slopes.append(slope)
        parts = assemble(
            model.bricks, x.reshape(-1, 3)[model.element], p, model.mu, beam.stiffening, beam.bulk_ratio
        )
        dx, dturn = newton_step(
            model, parts.force, parts.matrix, factor, moves, slopes, loose, spring, turn - base
        )
        largest = np.abs(dx).max()
        if not np.isfinite(largest) or largest > 20 * beam.length:
            break
        part = _admissible(model, x, dx)
        x = x + part * dx
        turn = turn + part * dturn
        du = dx.reshape(-1, 3)[model.element].reshape(len(p), -1)
        p = p + part * (parts.shift + np.einsum("ebk,ek->eb", parts.recover, du))
        if largest < 2e-7 and part == 1.0:
            return Shape(model, x, turn, step)
    raise NoEquilibriumError(f"no equilibrium within {step} Newton steps: {beam}")


def _admissible(model: Model, x: Array, dx: Array) -> float:
    """Part of a step after which no element is turned inside out."""
    part = 1.0
    while smallest_volume(model.bricks, (x + part * dx).reshape(-1, 3)[model.element]) <= 0.0:
        part /= 2
        if part < 1e-2:
            raise NoEquilibriumError("elements turn inside out")
    return part
