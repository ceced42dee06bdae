"""Cluster bootstrap of a fit over specimens, tests or segments of records, never over single points.

Errors of a model are correlated between the points of a record, so the points are not independent; whole
groups of them are resampled (cluster bootstrap). Each replicate is fitted to first order around the fit, from
sums over the groups, without any simulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.engine.fitting import Fit
from calibration.measurements._folds import PARTS
from calibration.measurements._model import MeasurementModel

Array = NDArray[np.float64]

ENOUGH = 6  # groups from which on resampling them says something
RIDGE = 1e-9  # of a coordinate's own information, so that one that no drawn group tells of stays


@dataclass(frozen=True, eq=False, kw_only=True)
class Groups:
    """Groups of residuals that are resampled together.

    Attributes
    ----------
    over : description of the groups ("specimens", "tests", "fifths of each record").
    of_row : group of each row of residuals, shape (m,); -1 for rows of the prior, which are never dropped.
    names : names of the groups.
    """

    over: str
    of_row: NDArray[np.intp]
    names: tuple[str, ...]

    @property
    def count(self) -> int:
        return len(self.names)

    def draws(self, count: int, seed: int) -> Array:
        """Multiplicity of each group in each replicate, shape (b, groups), b <= count.

        Replicates of one single group are dropped, unless there is one group only.
        """
        drawn = np.random.default_rng(seed).multinomial(
            self.count, np.full(self.count, 1.0 / self.count), size=count
        )
        several = np.count_nonzero(drawn, axis=1) > min(1, self.count - 1)
        return np.asarray(drawn[several], dtype=float)


def groups_of(model: MeasurementModel) -> Groups:
    """Specimens if there are `ENOUGH` of them, else tests if there are `ENOUGH`, else fifths of each record.

    Tests, whatever their number, if errors are correlated from row to row.
    """
    record = model.row_record[model.noise.used]
    prior = np.full(len(model.baseline.prior), -1)
    tests = [test_of(r) for r in model.records]
    specimens = [f"{r.material} {r.specimen}" for r in model.records]
    for over, labels in (("specimens", specimens), ("tests", tests)):
        there = list(dict.fromkeys(labels[k] for k in np.unique(record)))
        if len(there) >= ENOUGH:
            number = np.array([there.index(x) if x in there else -1 for x in labels])
            return Groups(over=over, of_row=np.concatenate([number[record], prior]), names=tuple(there))
    if model.noise.covariance is not None:  # rows are no points along a record
        there = list(dict.fromkeys(tests[k] for k in np.unique(record)))
        number = np.array([there.index(x) if x in there else -1 for x in tests])
        return Groups(over="tests", of_row=np.concatenate([number[record], prior]), names=tuple(there))
    of_row = np.zeros(len(record), dtype=np.intp)
    names: list[str] = []
    for k in np.unique(record):
        for n, part in enumerate(np.array_split(np.flatnonzero(record == k), PARTS)):
            if part.size:
                of_row[part] = len(names)
                names.append(f"{model.records[k].name}, part {n + 1}")
    rows = np.concatenate([of_row, prior]).astype(np.intp)
    return Groups(over="fifths of each record", of_row=rows, names=tuple(names))


def test_of(record: object) -> str:
    """Label of the test that a record belongs to; the record's name if it has no label."""
    groups = getattr(record, "groups", {})
    return str(groups.get("trial", getattr(record, "name", "")))


@dataclass(frozen=True, eq=False, kw_only=True)
class Replicates:
    """Fits to resampled groups.

    Attributes
    ----------
    chi2 : chi-square of each replicate, shape (b,).
    expected : its expectation under noise of unit variance, shape (b,).
    moves : change of the coordinates and amplitudes from the fit, shape (b, n).
    """

    chi2: Array
    expected: Array
    moves: Array


class Resampled:
    """A fit that can be repeated, to first order, on resampled groups."""

    def __init__(self, fit: Fit, groups: Groups) -> None:
        self._z, self._jacobian, self._of_row = fit.z, fit.jacobian, groups.of_row
        self._count = groups.count

    @cached_property
    def _sums(self) -> tuple[Array, Array, Array, Array]:
        """J^T J, J^T z, z^T z and number of rows of each group, the prior last."""
        places = [self._of_row == g for g in (*range(self._count), -1)]
        grams = np.array([self._jacobian[p].T @ self._jacobian[p] for p in places])
        slopes = np.array([self._jacobian[p].T @ self._z[p] for p in places])
        squares = np.array([self._z[p] @ self._z[p] for p in places])
        return grams, slopes, squares, np.array([float(np.count_nonzero(p)) for p in places])

    def replicates(self, drawn: Array) -> Replicates:
        """Fit each replicate; `drawn` is the multiplicity of each group, shape (b, groups).

        Coordinates that one group alone constrains (its modulus, its deviation) are eliminated in that group,
        once for each multiplicity that occurs. The system solved for each replicate contains the shared
        coordinates only.
        """
        grams, slopes, squares, rows = self._sums
        n = grams.shape[1]
        size = np.sqrt(np.einsum("gii->i", grams))
        size[size == 0.0] = 1.0
        grams, slopes = grams / np.outer(size, size), slopes / size
        prior, owner = grams[-1], _owners(grams)
        shared = np.flatnonzero(owner < 0)
        whole = np.zeros((len(drawn), shared.size, shared.size)) + prior[np.ix_(shared, shared)]
        twice = whole.copy()
        whole += RIDGE * np.eye(shared.size)
        slope = np.zeros((len(drawn), shared.size)) + slopes[-1, shared]
        chi2 = drawn @ squares[:-1] + squares[-1]
        taken = np.zeros(len(drawn))
        local: list[tuple[NDArray[np.intp], Array, Array]] = []  # which, and their answers to the shared ones
        for g in range(self._count):
            own = np.flatnonzero(owner == g)
            times, which = np.unique(drawn[:, g], return_inverse=True)
            parts = [_eliminated(grams[g], slopes[g], prior, slopes[-1], own, shared, w) for w in times]
            whole += np.array([p.whole for p in parts])[which]
            twice += np.array([p.twice for p in parts])[which]
            slope += np.array([p.slope for p in parts])[which]
            chi2 -= np.array([p.chi2 for p in parts])[which]
            taken += np.array([p.taken for p in parts])[which]
            local.append(
                (own, np.array([p.alone for p in parts])[which], np.array([p.beside for p in parts])[which])
            )
        moves = np.zeros((len(drawn), n))
        solved = np.linalg.solve(whole, np.concatenate([slope[:, :, None], twice], axis=2))
        moves[:, shared] = -solved[:, :, 0]
        for own, alone, beside in local:
            moves[:, own] = -alone - np.einsum("bls,bs->bl", beside, moves[:, shared])
        return Replicates(
            chi2=chi2 + np.einsum("bi,bi->b", slope, moves[:, shared]),
            expected=drawn @ rows[:-1] + rows[-1] - taken - np.einsum("bii->b", solved[:, :, 1:]),
            moves=moves / size,
        )


def _owners(grams: Array) -> NDArray[np.intp]:
    """Index of the only group that constrains each coordinate, shape (n,).

    -1 if none or several do, or if the prior (the last of the Gram matrices) couples it to other coordinates.
    """
    involved = np.einsum("gii->gi", grams[:-1]) > 0.0
    coupled = np.count_nonzero(grams[-1] - np.diag(np.diag(grams[-1])), axis=0) > 0
    return np.where((involved.sum(axis=0) == 1) & ~coupled, involved.argmax(axis=0), -1)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Eliminated:
    """Contribution of a group, drawn w times, to the shared system after its own coordinates are eliminated.

    The s shared coordinates remain; l own coordinates are eliminated. The normal matrix weights rows by w,
    the expected chi-square by w^2.

    Attributes
    ----------
    whole, slope : Schur complements of w J^T J, shape (s, s), and of w J^T z, shape (s,).
    twice : the corresponding matrix of w^2 J^T J, shape (s, s).
    taken : expected chi-square that the own coordinates absorb (trace).
    chi2 : reduction of chi-square by the own coordinates alone.
    alone : minus the change of the own coordinates at fixed shared ones, shape (l,).
    beside : minus its derivatives by the shared coordinates, shape (l, s).
    """

    whole: Array
    twice: Array
    slope: Array
    chi2: float
    taken: float
    alone: Array
    beside: Array


def _eliminated(
    gram: Array,
    slope: Array,
    prior: Array,
    prior_slope: Array,
    own: NDArray[np.intp],
    shared: NDArray[np.intp],
    times: float,
) -> _Eliminated:
    """Eliminate a group's own coordinates by blocks, including the prior's contribution to them."""
    ll, ls, ss = np.ix_(own, own), np.ix_(own, shared), np.ix_(shared, shared)
    inner = np.linalg.inv(times * gram[ll] + prior[ll] + RIDGE * np.eye(own.size))
    across = times * gram[ls]
    towards = times * slope[own] + prior_slope[own]
    alone, beside = inner @ towards, inner @ across
    mixed = times**2 * gram[ls].T @ beside
    own_twice = times**2 * gram[ll] + prior[ll]
    return _Eliminated(
        whole=times * gram[ss] - across.T @ beside,
        twice=times**2 * gram[ss] - mixed - mixed.T + beside.T @ own_twice @ beside,
        slope=times * slope[shared] - across.T @ alone,
        chi2=float(towards @ alone),
        taken=float(np.sum(inner * own_twice)),
        alone=alone,
        beside=beside,
    )
