"""The course of a test: the prescribed value over time, piece by piece.

>>> from tisim.course import Course
>>> pull = Course(start=1.0).ramp(to=1.5, speed=0.05).hold(60.0).ramp(to=1.0, speed=0.05).hold(60.0)
>>> pull.duration
140.0
>>> pull.value(35.0)
1.5
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np

from tisim._checks import FieldError, check_number, check_type, check_whole

FRAMES_A_PIECE = 10
STEPS_A_RAMP = 10
SAME = 1e-12  # difference below which two times are equal, relative to the duration


@dataclass(frozen=True, kw_only=True)
class Stop:
    """The end of a time step.

    Attributes
    ----------
    time : float
        Time [s].
    value : float
        Prescribed value.
    frame : bool
        True if the state is kept as a frame.
    """

    time: float
    value: float
    frame: bool


@dataclass(frozen=True, kw_only=True)
class Course:
    """The prescribed value of a test over time, piecewise linear with jumps; quasi-static, without inertia.

    The value is the stretch of a homogeneous or a compression test, the depth of a poke [m], or the fraction
    of a beam's load.

    Time steps follow from the course and the material alone. A step is at most `growth` times the sum of the
    time since the last corner and half of the shortest relaxation time, so that steps are short after a
    corner and grow by a constant ratio in a hold. A ramp has at least STEPS_A_RAMP steps, and steps end
    exactly at frames and corners. The error falls with the square of `growth`. For a material without
    viscosity there is one step from frame to frame.

    Attributes
    ----------
    start : float
        Value at time 0.
    times : tuple of float
        End of each piece [s], never falling; a piece of duration 0 is a jump.
    values : tuple of float
        Value at the end of each piece.
    frames : tuple of float, optional
        Times at which frames are kept [s], rising. By default FRAMES_A_PIECE equidistant ones per piece. A
        frame at the time of a jump is after the jump.
    growth : float
        Factor of the step length, see above; above 0 and up to 1.
    """

    start: float = 0.0
    times: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    frames: tuple[float, ...] | None = None
    growth: float = 0.7

    def __post_init__(self) -> None:
        for name in ("times", "values", "frames"):  # an array has no truth value
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, name, tuple(value.tolist()))

    def ramp(self, *, to: float, speed: float | None = None, duration: float | None = None) -> Course:
        """This course, then a ramp to a value, at a speed [value/s] (of either sign) or in a duration [s]."""
        if (speed is None) == (duration is None):
            raise ValueError("course.ramp: expected either a speed or a duration")
        check_type("course.ramp.to", to, (Real,))
        if duration is None:
            check_number("course.ramp.speed", speed, "a speed other than 0", lambda v: v != 0.0)
            duration = abs((to - self._last) / float(speed))  # type: ignore[arg-type]
        return self._then(duration, to)

    def jump(self, to: float) -> Course:
        """This course, then a jump to a value."""
        return self._then(0.0, to)

    def hold(self, duration: float) -> Course:
        """This course, then a constant value for a duration [s]."""
        return self._then(duration, self._last)

    def cycles(self, *, to: float, back: float, speed: float, count: int) -> Course:
        """This course, then `count` times a ramp to `to` and a ramp to `back`, at a speed [value/s]."""
        check_whole("course.cycles.count", count)
        course = self
        for _ in range(count):
            course = course.ramp(to=to, speed=speed).ramp(to=back, speed=speed)
        return course

    def _then(self, duration: float, to: float) -> Course:
        check_type("course.duration", duration, (Real,))
        end = self.duration + duration
        return replace(self, times=(*self.times, end), values=(*self.values, to))

    @property
    def duration(self) -> float:
        """Length of the course [s]."""
        return self.times[-1] if self.times else 0.0

    @property
    def _last(self) -> float:
        return self.values[-1] if self.values else self.start

    def value(self, time: float) -> float:
        """The value at a time [s]; at a jump, that after it."""
        at, before = 0.0, self.start
        found = self.start
        for end, value in zip(self.times, self.values, strict=True):
            if time >= end:
                found = value
            elif time >= at:
                return before + (value - before) * (time - at) / (end - at)
            at, before = end, value
        return found

    def check(self, field: str = "course", *, start: float | None = None) -> None:
        """Raise FieldError for an invalid course, or one that does not begin at `start` (if given)."""
        for name, given in (("times", self.times), ("values", self.values)):
            if not isinstance(given, Sequence):
                raise FieldError(f"{field}.{name}", "a sequence of numbers", given)
        if len(self.times) != len(self.values) or not self.times:
            raise FieldError(f"{field}.times", "at least one piece, each with a time and a value", self.times)
        for value in (self.start, *self.values):
            check_number(f"{field}.values", value, "finite numbers", lambda _: True)
        if start is not None and self.start != start:
            raise FieldError(f"{field}.start", f"{start:g}, where the body is at rest", self.start)
        for time in self.times:
            check_number(f"{field}.times", time, "times of 0 s or more", lambda v: v >= 0.0)
        if any(b < a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise FieldError(f"{field}.times", "times that never fall: a course cannot go back", self.times)
        check_number(f"{field}.growth", self.growth, "a number above 0 and up to 1", lambda v: 0.0 < v <= 1.0)
        if self.frames is None:
            return
        first = 0.0 if self.times[0] == 0.0 else np.nextafter(0.0, 1.0)
        last = self.duration * (1.0 + SAME)  # a ramp's duration is rounded
        within = f"times within the course, {'from' if first == 0.0 else 'after'} 0 to {self.duration:g} s"
        if not isinstance(self.frames, Sequence) or not self.frames:
            raise FieldError(f"{field}.frames", "at least one time, or None", self.frames)
        for time in self.frames:
            check_number(f"{field}.frames", time, within, lambda v: first <= v <= last)
        for pair in zip(self.frames, self.frames[1:], strict=False):
            if pair[1] - pair[0] <= SAME * self.duration:  # closer ones would be one stop, and so one frame
                wanted = f"times that rise, each by more than {SAME:g} of the course's {self.duration:g} s"
                raise FieldError(f"{field}.frames", wanted, pair)

    def end_at(self, time: float) -> float | None:
        """End of a piece that is equal to `time` [s] but for rounding; None if there is none."""
        same = SAME * max(self.duration, 1e-300)
        return next((end for end in self.times if abs(end - time) <= same), None)

    def stops(self, shortest: float | None) -> list[Stop]:
        """The ends of all time steps.

        Parameters
        ----------
        shortest : float or None
            Shortest relaxation time of the material [s]. None, without viscosity, gives steps from frame to
            frame.
        """
        found = list(self._steps(shortest))
        frames = self._frame_times()
        same = SAME * max(self.duration, 1e-300)
        stops = []
        for i, (time, value) in enumerate(found):
            last = i + 1 == len(found) or found[i + 1][0] - time > same  # the last stop at this time
            kept = last and bool((np.abs(frames - time) <= same).any())
            stops.append(Stop(time=time, value=value, frame=kept))
        return stops

    def _frame_times(self) -> np.ndarray:
        if self.frames is not None:
            return np.array(self.frames, dtype=float)
        parts = np.arange(1, FRAMES_A_PIECE + 1) / FRAMES_A_PIECE
        begins = np.array((0.0, *self.times[:-1]))
        return np.unique(
            np.concatenate([b + parts * (e - b) for b, e in zip(begins, self.times, strict=True)])
        )

    def _steps(self, shortest: float | None) -> Iterator[tuple[float, float]]:
        frames = self._frame_times()
        same = SAME * max(self.duration, 1e-300)
        begin, before = 0.0, self.start
        for end, value in zip(self.times, self.values, strict=True):
            long = end - begin
            if long <= same:
                yield end, value
                begin, before = end, value
                continue
            slope = (value - before) / long
            inside = frames[(frames > begin + same) & (frames < end - same)]
            now = begin
            for must in (*inside, end):
                while must - now > same:
                    gap = must - now
                    step = gap
                    if shortest is not None:
                        step = self.growth * (now - begin + 0.5 * shortest)
                        if slope:
                            step = min(step, long / STEPS_A_RAMP)
                    if gap <= step * (1.0 + 1e-9):
                        now = must
                    else:
                        now = now + (0.5 * gap if gap < 2.0 * step else step)
                    yield float(now), value if now == end else before + slope * (now - begin)
            begin, before = end, value
