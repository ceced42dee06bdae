"""Two or three causes at once, to first order: which candidates explain most together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.screening import Screen

Array = NDArray[np.float64]

ALIKE = 0.98  # cosine from which two candidates are one
KEPT = (
    200  # threes with each candidate, of which those are dropped that have a forbidden sign, or a name twice
)


def best_pairs(screened: Screen, z: Array, *, count: int) -> list[tuple[int, int]]:
    """Pairs of candidates (by index) of different effects with the largest improvement of chi-square, the
    best one of each pair of names, best first."""
    score = screened.directions.T @ z
    cosine = screened.directions.T @ screened.directions
    a, b = np.triu_indices(len(score), 1)
    names = np.array([c.effect for c in screened.candidates])
    sound = (np.abs(cosine[a, b]) < ALIKE) & (screened.sizes[a] > 0) & (screened.sizes[b] > 0)
    sound &= names[a] != names[b]
    a, b = a[sound], b[sound]
    c = cosine[a, b]
    first = (score[a] - c * score[b]) / (1.0 - c**2)  # minus the amplitudes, in directions of unit length
    second = (score[b] - c * score[a]) / (1.0 - c**2)
    forbidden = (screened.upwards[a] & (first > 0.0)) | (screened.upwards[b] & (second > 0.0))
    gain = (score[a] ** 2 + score[b] ** 2 - 2.0 * c * score[a] * score[b]) / (1.0 - c**2)
    gain = np.where(forbidden, 0.0, gain)
    rivals = np.array([2.0 * np.log(k.rivals) for k in screened.candidates])
    found: list[tuple[int, int]] = []
    seen: set[frozenset[str]] = set()
    for k in np.argsort(-(gain - rivals[a] - rivals[b])):
        pair = frozenset((str(names[a[k]]), str(names[b[k]])))
        if pair not in seen:
            seen.add(pair)
            found.append((int(a[k]), int(b[k])))
            if len(found) == count:
                break
    return found


def best_threes(screened: Screen, z: Array, *, count: int) -> list[tuple[int, int, int]]:
    """The same of three: all are looked at, by what the other two leave once the first is projected out."""
    used = np.flatnonzero(screened.sizes > 0.0)
    directions = screened.directions[:, used]
    score, cosine = directions.T @ z, directions.T @ directions
    worths = np.array([2.0 * np.log(screened.candidates[k].rivals) for k in used])
    gains, threes = [np.zeros(0)], [np.zeros((0, 3), dtype=int)]
    for first in range(len(used) - 2):
        rest = np.arange(first + 1, len(used))
        part = cosine[first, rest]
        rest, part = rest[np.abs(part) < ALIKE], part[np.abs(part) < ALIKE]
        size = np.sqrt(1.0 - part**2)
        left = (score[rest] - part * score[first]) / size
        between = (cosine[np.ix_(rest, rest)] - np.outer(part, part)) / np.outer(size, size)
        b, c = np.triu_indices(len(rest), 1)
        apart = np.abs(between[b, c]) < ALIKE
        b, c = b[apart], c[apart]
        both = left[b] ** 2 + left[c] ** 2 - 2.0 * between[b, c] * left[b] * left[c]
        gain = score[first] ** 2 + both / (1.0 - between[b, c] ** 2)
        gain -= worths[first] + worths[rest[b]] + worths[rest[c]]
        most = np.argsort(-gain)[:KEPT]
        gains.append(gain[most])
        threes.append(np.column_stack([np.full(len(most), first), rest[b[most]], rest[c[most]]]))
    ordered = np.concatenate(threes)[np.argsort(-np.concatenate(gains))]
    found: list[tuple[int, int, int]] = []
    seen: set[frozenset[str]] = set()
    for three in ordered:
        names = frozenset(screened.candidates[k].effect for k in used[three])
        amplitudes = -np.linalg.solve(cosine[np.ix_(three, three)], score[three])
        if len(names) < 3 or names in seen or (screened.upwards[used[three]] & (amplitudes < 0.0)).any():
            continue
        seen.add(names)
        found.append((int(used[three[0]]), int(used[three[1]]), int(used[three[2]])))
        if len(found) == count:
            break
    return found
