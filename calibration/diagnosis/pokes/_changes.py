"""What changes make of a curve, and what deeper frames of a coarser mesh make of a finer one's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.pokes._curve import Curve

Array = NDArray[np.float64]

# Width of contact over rod radius over which a change is taken to be smooth, at refinement 1: some quarter of
# what a cell's coming to touch makes the force go up and down over (0.2 under a ball, 0.4 under a flat rod).
SMOOTH = 0.08


def deepened(fine: Curve, coarse: Curve) -> Curve:
    """The finer mesh's forces, and below where it was followed to the coarser one's, in the ratio of both
    there."""
    below = coarse.depth > fine.reached
    end = np.array([fine.reached])
    ratio = float((fine.at(end) / coarse.at(end))[0])
    # forces across the rod start from none where nothing tilts: what they are off by is no ratio
    aside = fine.sides(end)[0] - ratio * coarse.sides(end)[0]
    return replace(
        coarse,
        depth=np.concatenate([fine.depth, coarse.depth[below]]),
        along=np.concatenate([fine.along, ratio * coarse.along[below]]),
        across=np.concatenate([fine.across, ratio * coarse.across[below] + aside]),
        finer=fine.reached,
    )


def changed(base: Curve, pairs: Sequence[tuple[Curve, Curve, float]], radius: float) -> Curve:
    """A curve by what a change makes of one on the same mesh: pairs of both and their refinement, the finest
    first, each used below where those before end.

    The ratio of the two is made smooth in the width of contact: cells that come to touch at other depths
    with the change than without it are no change.
    """
    depth, ratio, aside = np.zeros(0), np.zeros(0), np.zeros((0, 2))
    for with_it, plain, refinement in pairs:
        below = with_it.depth > (depth[-1] if depth.size else 0.0)
        at = with_it.depth[below]
        unit = plain.at(with_it.depth)
        width = np.sqrt(with_it.depth / radius)
        part = smoothed(width, with_it.along / unit, SMOOTH / refinement)
        moved = (with_it.across - plain.sides(with_it.depth)) / unit[:, None]
        depth, ratio = np.concatenate([depth, at]), np.concatenate([ratio, part[below]])
        aside = np.concatenate([aside, moved[below]])
    unit = base.at(depth)
    return replace(
        pairs[-1][0],
        depth=depth,
        along=ratio * unit,
        across=base.sides(depth) + aside * unit[:, None],
        reached=float(depth[-1]),
        finer=base.finer,
    )


def smoothed(x: Array, values: Array, width: float) -> Array:
    """Values at x (k,) by lines through their neighbours, weighted by a Gaussian of that sd."""
    found = np.empty(x.size)
    for k in range(x.size):
        apart = x - x[k]
        weight = np.exp(-0.5 * (apart / width) ** 2)
        mean = weight @ apart / weight.sum()
        spread = weight @ (apart - mean) ** 2
        middle = weight @ values / weight.sum()
        slope = weight @ ((apart - mean) * values) / spread if spread > 1e-6 * width**2 else 0.0
        found[k] = middle - slope * mean
    return found
