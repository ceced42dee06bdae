"""The spread of a fit over specimens, tests or stretches of a record: bootstrap by groups, never over points.

What a model lacks is the same for all points of a record, so that points are no independent witnesses of it;
groups of them are resampled as they are (cluster bootstrap). Each replicate is fitted to first order around
the fit, from sums over the groups, which costs no simulation.
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
    """What is resampled.

    Attributes
    ----------
    over : in words.
    of_row : the group of each row of residuals, shape (m,); -1 for rows of the prior, which always count.
    names : of the groups.
    """

    over: str
    of_row: NDArray[np.intp]
    names: tuple[str, ...]

    @property
    def count(self) -> int:
        return len(self.names)

    def draws(self, count: int, seed: int) -> Array:
        """How often each group is drawn, shape (count, groups); those of one group only are left out."""
        drawn = np.random.default_rng(seed).multinomial(
            self.count, np.full(self.count, 1.0 / self.count), size=count
        )
        several = np.count_nonzero(drawn, axis=1) > min(1, self.count - 1)
        return np.asarray(drawn[several], dtype=float)


def groups_of(model: MeasurementModel) -> Groups:
    """Specimens, or tests where these are few; stretches of the records (fifths) where tests are few too."""
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
    """The test that a record is of."""
    groups = getattr(record, "groups", {})
    return str(groups.get("trial", getattr(record, "name", "")))


@dataclass(frozen=True, eq=False, kw_only=True)
class Replicates:
    """Fits to resampled groups.

    Attributes
    ----------
    chi2 : of each, shape (b,).
    expected : what noise of unit variance would leave of it, shape (b,).
    moves : of the coordinates and amplitudes, shape (b, n).
    """

    chi2: Array
    expected: Array
    moves: Array


class Resampled:
    """A fit, ready to be repeated on resampled groups. expected: chi-square that noise alone would leave."""

    def __init__(self, fit: Fit, groups: Groups) -> None:
        self._z, self._jacobian, self._of_row = fit.z, fit.jacobian, groups.of_row
        self._count = groups.count

    @cached_property
    def _sums(self) -> tuple[Array, Array, Array, Array]:
        """Of each group, the prior last: J^T J, J^T z, z^T z, number of rows."""
        places = [self._of_row == g for g in (*range(self._count), -1)]
        grams = np.array([self._jacobian[p].T @ self._jacobian[p] for p in places])
        slopes = np.array([self._jacobian[p].T @ self._z[p] for p in places])
        squares = np.array([self._z[p] @ self._z[p] for p in places])
        return grams, slopes, squares, np.array([float(np.count_nonzero(p)) for p in places])

    def replicates(self, drawn: Array) -> Replicates:
        """drawn : how often each group counts, shape (b, groups).

        Coordinates that one group alone tells of (its modulus, its deviation) are eliminated in each group,
        once for each number of times that it is drawn: what is solved in each replicate is as small as what
        the groups share.
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
    """The only group that tells of each coordinate, shape (n,); -1 where several do, or where the prior (the
    last of the grams) couples it to others."""
    involved = np.einsum("gii->gi", grams[:-1]) > 0.0
    coupled = np.count_nonzero(grams[-1] - np.diag(np.diag(grams[-1])), axis=0) > 0
    return np.where((involved.sum(axis=0) == 1) & ~coupled, involved.argmax(axis=0), -1)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Eliminated:
    """A group drawn some times, without its own coordinates.

    Attributes
    ----------
    whole, slope : what is left of J^T J (s, s) and of J^T z (s,) for the shared coordinates.
    twice : the same of the squared weights' J^T J, (s, s). taken : what the own ones take of it.
    chi2 : that the own coordinates take.
    alone, beside : minus their moves (l,) where the shared stay, and by each of these (l, s).
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
    """Block elimination of a group's own coordinates, the prior's part of them included."""
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
