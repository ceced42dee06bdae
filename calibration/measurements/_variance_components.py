"""Variance components of repeated tests: scatter between repeats, trend in their order, between specimens.

Repeats are not exchangeable: a specimen that stiffens or recovers from test to test depends on the order of
the tests. A linear trend in the order is removed first and reported; the rest is the repeatability scatter.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from calibration.measurements._basis import legendre

Array = NDArray[np.float64]

REPEATS = 4  # least number of repeats of one test: mean and trend take two degrees of freedom
GRID = 24  # points along the records at which they are compared
NOTABLE = 4.0  # least ratio of the mean square of a trend in the order of repeats to that by chance
DEGREE = 4  # highest polynomial degree of a record's own deviation
WIDEST = 3.0  # most by which the variance of a scatter from few repeats is increased
CERTAIN = 3.0  # standard errors by which the scatter between repeats exceeds what noise makes of it


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """Misfit of one record along its driven quantity.

    Attributes
    ----------
    name, material, specimen : names of the record, its material and its specimen.
    test : key that repeats of one test share; None for a record that is not a repeat.
    x : driven quantity, in the order of the record, shape (k,).
    branch : number of the stroke of each point, shape (k,): loading and unloading are compared separately.
    misfit : simulated minus measured [SI], shape (k,).
    sd : standard deviation of the noise from point to point [SI], shape (k,); what the record shows, if it is
        not stated.
    scale : full scale [SI].
    """

    name: str
    material: str
    specimen: str
    test: Hashable | None
    x: Array
    branch: NDArray[np.int64]
    misfit: Array
    sd: Array
    scale: float


@dataclass(frozen=True, kw_only=True)
class VarianceComponents:
    """Standard deviations as fractions of full scale; None if there are no tests to estimate them.

    Attributes
    ----------
    repeat : standard deviation between repeats on one specimen, without the trend in their order and beyond
        the noise from point to point; 0 if repeats differ by this noise only.
    by_degree : the same by degree of the record's own deviation, 0 to DEGREE (`deviations`); the root of the
        sum of their squares is `repeat`. A scatter of areas or load cells is one of low degrees. Empty
        without repeats.
    order : change of the misfit from the first to the last repeat by that trend: rms along the record, with
        the sign of its mean. None if noise and scatter make as much (NOTABLE).
    specimen : standard deviation between the means of specimens of one material in one test.
    repeats : names of the records that `repeat` and `order` are estimated from.
    dof : degrees of freedom of `repeat`.
    """

    repeat: float | None = None
    by_degree: tuple[float, ...] = ()
    order: float | None = None
    specimen: float | None = None
    repeats: tuple[str, ...] = ()
    dof: float = 0.0

    @property
    def expected(self) -> tuple[float, ...]:
        """`by_degree` of another test, whose scatter is known from few repeats: Student's t distribution.

        Its variance is dof / (dof - 2) times that of the estimate; WIDEST at most, where that is not finite.
        """
        if not self.by_degree:
            return ()
        wider = min(self.dof / (self.dof - 2.0), WIDEST) if self.dof > 2.0 else WIDEST
        return tuple(sqrt(wider) * sd for sd in self.by_degree)

    def to_json(self) -> dict[str, float]:
        found = {"repeat": self.repeat, "order": self.order, "specimen": self.specimen}
        return {name: value for name, value in found.items() if value is not None}

    def sentences(self) -> list[str]:
        if self.repeat is None:
            return []
        text = f"{len(self.repeats)} repeats differ by no more than the noise from point to point"
        if self.repeat > 0.0:
            text = (
                f"{len(self.repeats)} repeats differ by {100.0 * self.repeat:.2g} % of full scale from one to"
                " the next, which counts as noise"
            )
        if self.order is not None:
            text += (
                f"; the order of the tests, taken out first, makes {100.0 * self.order:+.2g} % from the first"
                " to the last"
            )
        if self.specimen is not None:
            text += f"; specimens of a material differ by {100.0 * self.specimen:.2g} %"
        return [text]


def variance_components(curves: Sequence[Curve]) -> VarianceComponents:
    """Estimate the variance components.

    `repeat` and `order` use groups of at least REPEATS records of one test on one specimen; `specimen` uses
    the means of all groups of one test and material.
    """
    groups: dict[Hashable, list[Curve]] = {}
    for c in curves:
        if c.test is not None:
            groups.setdefault((c.material, c.specimen, c.test), []).append(c)
    scatter, orders, dofs, names = np.zeros(DEGREE + 1), [], 0.0, []
    means: dict[Hashable, list[Array]] = {}
    for (material, _, test), group in ((k, g) for k, g in groups.items() if isinstance(k, tuple)):
        common = _on_common_grid(group)
        if common is None:
            continue
        values = common.values
        means.setdefault((material, test), []).append(values.mean(axis=0))
        if len(group) < REPEATS:
            continue
        number = np.arange(len(group)) - 0.5 * (len(group) - 1)
        trend = number @ values / (number @ number)
        left = values - values.mean(axis=0) - number[:, None] * trend
        free = len(group) - 2.0  # after mean and trend
        own = _scatter(left, common, free)
        scatter += free * own
        whole = trend * (len(group) - 1)
        by_chance = (own.sum() + common.noise) * (len(group) - 1) ** 2 / (number @ number)
        if np.mean(whole**2) > NOTABLE * by_chance:
            orders.append(float(np.sign(whole.mean()) * np.sqrt(np.mean(whole**2))))
        dofs += free
        names += [c.name for c in group]
    apart = [np.var(np.array(m), axis=0, ddof=1).mean() for m in means.values() if len(m) > 1]
    by_degree = np.sqrt(scatter / dofs) if dofs else np.zeros(0)
    return VarianceComponents(
        repeat=float(np.linalg.norm(by_degree)) if dofs else None,
        by_degree=tuple(by_degree.tolist()),
        order=float(np.mean(orders)) if orders else None,
        specimen=float(np.sqrt(np.mean(apart))) if apart else None,
        repeats=tuple(names),
        dof=dofs,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _CommonGrid:
    """Misfits of repeats on a common grid, over full scale.

    Attributes
    ----------
    x : positions in the common range of x, branch after branch, shape (m,).
    values : shape (records, m).
    noise : mean variance that the noise from point to point gives them.
    coefficient_noise : variance that it gives a coefficient of an orthonormal function along x.
    """

    x: Array
    values: Array
    noise: float
    coefficient_noise: float


def _scatter(left: Array, common: _CommonGrid, free: float) -> Array:
    """Variance between repeats by degree, shape (DEGREE + 1,), beyond the noise; zeros if it is no larger.

    `left` (records, m): values without mean and trend; `free`: degrees of freedom of each degree.
    """
    functions = _functions(common.x, np.unique(common.x).size)
    fitted = np.linalg.lstsq(functions.T, left.T, rcond=None)[0]
    found = np.zeros(DEGREE + 1)
    found[: len(functions)] = (fitted**2).sum(axis=1) / free
    by_noise = len(functions) * common.coefficient_noise
    if found.sum() <= (1.0 + CERTAIN * sqrt(2.0 / (free * len(functions)))) * by_noise:
        return np.zeros(DEGREE + 1)
    found[: len(functions)] -= common.coefficient_noise
    return np.maximum(found, 0.0)


def _functions(x: Array, positions: int) -> Array:
    """Legendre polynomials over the range of x (k,), at most as many as positions, and up to DEGREE.

    Their mean square over the range is 1; shape (degrees, k).
    """
    return np.array([sqrt(2.0 * d + 1.0) * legendre(x, d) for d in range(min(DEGREE + 1, positions))])


def _on_common_grid(group: Sequence[Curve]) -> _CommonGrid | None:
    """Misfits over full scale on a grid of their common range of x in each branch.

    None if they have no common range in any branch.
    """
    positions, found, noise, independent = [], [], [], 0.0
    for branch in np.unique(group[0].branch):
        own = [c.branch == branch for c in group]
        if not all(mine.any() for mine in own):
            continue
        low = max(float(c.x[mine].min()) for c, mine in zip(group, own, strict=True))
        high = min(float(c.x[mine].max()) for c, mine in zip(group, own, strict=True))
        if not high > low:
            continue
        grid = np.linspace(low, high, GRID)
        values = []
        for c, mine in zip(group, own, strict=True):
            order = np.argsort(c.x[mine], kind="stable")
            x, y, sd = (a[mine][order] for a in (c.x, c.misfit, c.sd))
            values.append(np.interp(grid, x, y) / c.scale)
            # interpolated white noise has two thirds of its variance
            independent += min(float(np.count_nonzero((x >= low) & (x <= high))), 1.5 * GRID) / len(group)
            noise.append(float(np.mean(sd**2)) / c.scale**2)
        positions.append(grid)
        found.append(np.array(values))
    if not found:
        return None
    point = float(np.mean(noise))
    return _CommonGrid(
        x=np.concatenate(positions),
        values=np.concatenate(found, axis=1),
        noise=2.0 / 3.0 * point,
        coefficient_noise=point / independent,
    )


def deviations(curves: Sequence[Curve], by_degree: Sequence[float]) -> list[list[Array]]:
    """Nuisance columns [SI] for the own deviation of each record: Legendre polynomials up to DEGREE.

    Each is one standard deviation: by_degree[d] times full scale is its root mean square over the range of
    x.
    """
    return [
        [
            c.scale * size * column
            for size, column in zip(by_degree, _functions(c.x, c.x.size), strict=False)
            if size
        ]
        for c in curves
    ]
