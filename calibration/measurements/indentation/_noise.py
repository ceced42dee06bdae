"""Noise model of indentation: errors of single points, mesh error of the simulation, error of first touch.

The mesh error was measured on flat and hemispherical indenters up to 4 mm at K/G 300 against another solver
(studies/indentation, 2026-11-23): with quadratic hexahedra the force error is up to 0.7 % at refinement 1 and
1 to 2 % at 0.7, more at depths below 0.4 radii, where few cells are in contact. It oscillates as cells come
into contact, with a period of one cell in contact width, sqrt(radius * depth); and each geometry has a
deviation of its own. All are assumed to decrease with the square of the cell size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._noise import Noise
from calibration.measurements.indentation._curve import COARSE, FINE, Curve
from calibration.measurements.indentation._phases import remaining_noise
from calibration.measurements.indentation._record import Record
from calibration.measurements.indentation._scene import Geometry

Array = NDArray[np.float64]
# Function from elastic forces over the modulus at depths (k,), shape (k,) or (k, m), to forces at a record's
# points [N].
Follow = Callable[[Callable[[Array], Array]], Array]

# Relative sd at refinement 1: common to all indentations, and independent for each point (contact points that
# open and close, interpolation between frames).
TOGETHER, SCATTER = 0.011, 0.001
# (relative sd, correlation length in contact width over the indenter's radius) at refinement 1: oscillation
# with the cells, and a geometry's own deviation at nearly all depths.
WANDERING = ((0.0036, 0.04), (0.0027, 0.5))
SHALLOW = 0.4  # depth over the indenter's radius below which scatter and wandering grow
NEGLIGIBLE = 1e-6  # modes with less than this fraction of the largest variance are left out
# sd of the force in retraction, over the largest force and the fraction of the modulus that relaxes, and its
# exponents of the fraction of retraction. Stress that a viscoelastic material stored at a large strain
# persists as that strain decreases, which a force derived from the elastic curve does not describe: an error
# of a tenth of this, since the powers partly cancel (studies/indentation/over-time.md).
RETRACTION, RETRACTED = 0.3, (1, 2, 3)

GRID = 120  # number of depths at which wandering is evaluated
TOUCH = 3.0  # distance from first touch, in standard deviations of the depth, up to which a point is close
# Mesh error of the force across the indenter over the force along it, where the path over the surface bends.
ACROSS = 0.01


# -- mesh error --


def scatter(depth: Array, radius: float, refinement: float | Array) -> Array:
    """Relative sd of the simulated force at depths (k,) [m], independent from point to point.

    Parameters
    ----------
    depth : [m], shape (k,).
    radius : radius of the indenter [m].
    refinement : refinement of the mesh; one number, or one for each depth.
    """
    return np.asarray(SCATTER / refinement**2 * _shallow(depth, radius))


def wandering_modes(depth: Array, radius: float, refinement: float | Array) -> Array:
    """Independent modes of the wandering, one sd each, relative to the force at depths (k,); shape (k, m).

    Parameters as in `scatter`.
    """
    size = _shallow(depth, radius) / refinement**2
    width = refinement * np.sqrt(depth / radius)
    apart = width[:, None] - width[None, :]
    alike = sum((sd**2 * np.exp(-0.5 * (apart / over) ** 2) for sd, over in WANDERING), np.zeros_like(apart))
    values, vectors = np.linalg.eigh(np.outer(size, size) * alike)
    kept = values > NEGLIGIBLE * values[-1]
    return np.asarray(vectors[:, kept] * np.sqrt(values[kept]))


def _shallow(depth: Array, radius: float) -> Array:
    """Factor on the mesh error at shallow depth: 1 at large depth, about 10 at first touch."""
    shallow = SHALLOW * radius
    return np.asarray(np.sqrt(1.0 + (shallow / np.maximum(depth, 0.1 * shallow)) ** 2))


# -- noise of records --


def noise_of(
    records: Sequence[Record],
    curves: Sequence[Curve],
    forces: Sequence[Array],
    slopes: Sequence[Array],
    follow: Sequence[Follow],
    relaxing: Sequence[float],
) -> Noise:
    """Noise of all forces along the indenter, followed by all forces across it.

    Parameters
    ----------
    records : the records.
    curves : curves of the records, without effects.
    forces, slopes : simulated force [N] and its slope [N/m] at the points of each record.
    follow : for each record, function from elastic forces against depth to forces at its points: at their
        depths, or along its course for a viscoelastic material.
    relaxing : fraction of the instantaneous modulus of each record's material that relaxes.
    """
    along = [point_sd(r, c, f, s) for r, c, f, s in zip(records, curves, forces, slopes, strict=True)]
    across = [
        np.repeat(side_sd(r, f), 2) for r, f in zip(records, forces, strict=True) if r.across is not None
    ]
    columns, names = nuisances(records, curves, forces, slopes, follow, relaxing)
    sd = np.concatenate([*along, *across])
    none = np.zeros((len(sd) - len(columns), columns.shape[1]))  # nuisances are along the indenter
    return Noise.independent(sd).with_nuisances(np.vstack([columns, none]), names)


def point_sd(record: Record, curve: Curve, force: Array, slope: Array) -> Array:
    """Independent standard deviation of each point [N], shape (k,).

    It combines errors of the load cell, of the depth through the slope, of contact close to first touch, and
    of the simulation.
    """
    through_depth = slope * record.depth_error
    # close to first touch a record can be in contact or not, which the slope does not represent
    near = np.abs(record.depth) < TOUCH * record.depth_sd
    kink = np.where(near, 2.0 * record.depth_sd * float(slope[near].max(initial=0.0)), 0.0)
    own = np.abs(force) * scatter(
        np.maximum(record.depth, 0.0),
        record.geometry.rod.radius,
        _refinement(record.depth, curve, record.geometry),
    )
    return np.sqrt(record.own_sd**2 + through_depth**2 + own**2 + kink**2)


def side_sd(record: Record, force: Array) -> Array:
    """Standard deviation of the forces across the indenter [N], shape (k,)."""
    return np.hypot(record.own_sd, ACROSS * np.abs(force))


def nuisances(
    records: Sequence[Record],
    curves: Sequence[Curve],
    forces: Sequence[Array],
    slopes: Sequence[Array],
    follow: Sequence[Follow],
    relaxing: Sequence[float],
) -> tuple[Array, list[str]]:
    """Nuisances of simulated minus measured force, one sd each [N], shape (points, n), and their names.

    In this order: the mesh error common to all indentations; the wandering of each geometry; for each record
    the error of first touch (positive if it is deeper than recorded) and the noise that smoothing leaves in
    the depth of its phases; and for each record of a viscoelastic material the error of its force in
    retraction. Parameters as in `noise_of`.
    """
    starts = np.cumsum([0, *(r.points for r in records)])
    rows = [np.arange(int(a), int(b)) for a, b in pairwise(starts)]
    whole = np.concatenate(list(forces))
    meshes = [_refinement(r.depth, c, r.geometry) for r, c in zip(records, curves, strict=True)]
    found = [TOGETHER / np.concatenate(meshes) ** 2 * whole]
    names = ["mesh of all indentations"]

    def add(name: str, where: NDArray[np.intp], values: Array) -> None:
        column = np.zeros(whole.size)
        column[where] = values
        found.append(column)
        names.append(name)

    for geometry in dict.fromkeys(r.geometry for r in records):
        mine = [k for k, r in enumerate(records) if r.geometry == geometry]
        # records of one geometry share a curve, up to its extension to larger depths
        curve = max((curves[k] for k in mine), key=lambda c: c.finer)
        where = np.concatenate([rows[k] for k in mine])
        label = ", ".join(records[k].name for k in mine)
        deepest = max(float(records[k].depth.max()) for k in mine)
        modes = _modes(max(deepest, 0.0), curve, geometry)
        wandering = np.concatenate([follow[k](partial(_wandered, modes, curves[k])) for k in mine])
        for m, column in enumerate(wandering.T, 1):
            add(f"mesh {m} of {label}", where, column)
    for r, own, slope in zip(records, rows, slopes, strict=True):
        if r.depth_sd > 0.0:
            add(f"touch of {r.name}", own, -r.depth_sd * slope)
        for n, degree in enumerate(r.degrees):
            phase = r.phase == n
            if degree < 0 or not phase.any():
                continue
            left = r.depth_sd * remaining_noise(r.time[phase], int(r.count[phase].sum()), degree)
            for m, part in enumerate(left.T, 1):
                add(f"depth {m} of {r.labels[n]} of {r.name}", own[phase], part * slope[phase])
    for r, own, force, fraction in zip(records, rows, forces, relaxing, strict=True):
        reached = np.maximum.accumulate(np.maximum(r.depth, 1e-9))
        turned = np.logical_or.accumulate(r.direction < 0.0)
        back = np.where(turned, np.clip(1.0 - r.depth / reached, 0.0, 1.0), 0.0)
        for power in RETRACTED if fraction > 0.0 and back.any() else ():
            size = RETRACTION * fraction * float(np.abs(force).max())
            add(f"retraction {power} of {r.name}", own, size * back**power)
    return np.column_stack(found), names


def _refinement(depth: Array, curve: Curve, geometry: Geometry) -> Array:
    """Refinement of the mesh of a curve's forces at depths (k,)."""
    return np.where(depth <= curve.finer, FINE, COARSE) * geometry.refinement


def _modes(deepest: float, curve: Curve, geometry: Geometry) -> tuple[Array, Array]:
    """A grid of depths (g,) and the wandering modes there (g, m), for interpolation at long records."""
    grid = np.linspace(0.0, float(np.sqrt(deepest)), GRID)[1:] ** 2
    return grid, wandering_modes(grid, geometry.rod.radius, _refinement(grid, curve, geometry))


def _wandered(modes: tuple[Array, Array], curve: Curve, depth: Array) -> Array:
    """Change of the elastic force over the modulus by modes on a grid, at depths (k,); shape (k, m)."""
    own = np.maximum(depth, 0.0)
    return np.column_stack([np.interp(own, modes[0], mode) for mode in modes[1].T]) * curve.at(depth)[:, None]
