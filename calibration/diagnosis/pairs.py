"""Two causes at once, to first order: which pairs of candidates explain most together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.diagnosis.screening import Screen

Array = NDArray[np.float64]

ALIKE = 0.98  # cosine from which two candidates are one


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
