"""The course of a test: ramps and holds of the driven quantity, and the times of the record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Linear change to the value `to` in `duration` [s]."""

    to: float
    duration: float


@dataclass(frozen=True, kw_only=True)
class Course:
    """Consecutive pieces, from `start` at time 0.

    Attributes
    ----------
    start : float
        Initial value (stretch 1, depth 0).
    pieces : tuple of Piece
    samples : int
        Rows of the record per ramp; a hold has half as many, denser at its start.
    """

    start: float
    pieces: tuple[Piece, ...] = ()
    samples: int = 40

    def ramp(self, to: float, speed: float) -> Course:
        """This course followed by a ramp at a speed [1/s for a stretch, m/s for a depth]."""
        return self._then(to, abs(to - self.last) / speed)

    def hold(self, duration: float) -> Course:
        """This course followed by a hold [s]."""
        return self._then(self.last, duration)

    def _then(self, to: float, duration: float) -> Course:
        if not duration > 0.0:
            raise ValueError(f"course: a piece takes time, got {duration} s")
        pieces = (*self.pieces, Piece(to=to, duration=duration))
        return Course(start=self.start, pieces=pieces, samples=self.samples)

    @property
    def last(self) -> float:
        """Value at the end."""
        return self.pieces[-1].to if self.pieces else self.start

    def corners(self) -> tuple[Array, Array]:
        """Times [s] and values of the start and of the ends of all pieces."""
        times = np.concatenate([[0.0], np.cumsum([p.duration for p in self.pieces])])
        return times, np.array([self.start, *(p.to for p in self.pieces)])

    def value(self, time: ArrayLike) -> Array:
        """Driven value at times [s]."""
        return np.asarray(np.interp(np.asarray(time), *self.corners()))

    def record_times(self) -> Array:
        """Times of the record's rows [s], including the corners."""
        found, now, at = [np.zeros(1)], 0.0, self.start
        for piece in self.pieces:
            ramp = piece.to != at
            count = self.samples if ramp else max(self.samples // 2, 4)
            part = np.arange(1, count + 1) / count
            found.append(now + piece.duration * (part if ramp else part**3))
            now, at = now + piece.duration, piece.to
        return np.concatenate(found)


def cycles(course: Course, tops: tuple[float, ...], back: float, speed: float) -> Course:
    """The course followed by a ramp to each of `tops` and back to `back`, at a speed."""
    for top in tops:
        course = course.ramp(top, speed).ramp(back, speed)
    return course
