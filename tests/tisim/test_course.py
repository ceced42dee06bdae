"""The loading course: its segments, its time steps, and invalid courses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tisim import Course

PIECES = st.lists(
    st.tuples(st.sampled_from(("ramp", "jump", "hold")), st.floats(1e-3, 1e3), st.floats(0.0, 2.0)),
    min_size=1,
    max_size=5,
)


@st.composite
def courses(draw: st.DrawFn) -> Course:
    course = Course(growth=draw(st.floats(0.1, 1.0)))
    for kind, long, value in draw(PIECES):
        if kind == "ramp":
            course = course.ramp(to=value, duration=long)
        else:
            course = course.jump(value) if kind == "jump" else course.hold(long)
    return course


def test_pieces_say_where_they_end() -> None:
    course = (
        Course(start=1.0)
        .ramp(to=1.5, speed=0.1)
        .hold(3.0)
        .jump(1.2)
        .cycles(to=1.4, back=1.0, speed=0.2, count=2)
    )
    assert course.times == pytest.approx((5.0, 8.0, 8.0, 9.0, 11.0, 13.0, 15.0))
    assert course.values == (1.5, 1.5, 1.2, 1.4, 1.0, 1.4, 1.0)
    assert course.value(2.5) == pytest.approx(1.25)
    assert course.value(8.0) == 1.2
    assert course.value(99.0) == 1.0
    course.check()


@given(course=courses(), shortest=st.none() | st.floats(1e-3, 1e3))
def test_steps_meet_corners_and_frames_and_obey_the_rule(course: Course, shortest: float | None) -> None:
    course.check()
    stops = course.stops(shortest)
    times = np.array([s.time for s in stops])
    assert (np.diff(times, prepend=0.0) >= 0.0).all()
    assert set(course.times) <= set(times)
    assert stops[-1].value == course.values[-1]
    kept = [s.time for s in stops if s.frame]
    wanted = course._frame_times()
    close = 1e-11 * max(course.duration, 1e-300)
    assert all(np.abs(wanted - t).min() <= close for t in kept)
    assert all(np.abs(np.array(kept) - t).min() <= close for t in wanted)
    assert all(b > a for a, b in pairwise(kept))
    for stop in stops:
        if stop.time not in course.times:
            assert stop.value == pytest.approx(course.value(stop.time), abs=1e-9)
    if shortest is None:
        return
    corners = np.array((0.0, *course.times))
    for a, b in pairwise((0.0, *times)):
        since = a - corners[corners <= a].max()
        assert b - a <= course.growth * (since + 0.5 * shortest) * (1 + 1e-6) + close


def test_frames_are_where_they_are_asked_for() -> None:
    course = Course(frames=(0.0, 1.0, 60.0)).jump(1.0).hold(60.0)
    course.check()
    stops = course.stops(2.0)
    assert [s.time for s in stops if s.frame] == [0.0, 1.0, 60.0]
    assert [s.value for s in stops if s.frame] == [1.0, 1.0, 1.0]
    # a material without viscosity steps from frame to frame
    assert [s.time for s in course.stops(None)] == [0.0, 1.0, 60.0]


@pytest.mark.parametrize(
    ("course", "sentence"),
    [
        (Course(), "course.times: expected at least one piece"),
        (Course(times=(1.0, 0.5), values=(1.0, 1.0)), "times that never fall: a course cannot go back"),
        (Course(times=(-1.0,), values=(1.0,)), "times of 0 s or more"),
        (Course().hold(-2.0), "times of 0 s or more"),
        (Course().hold(2.0).hold(-1.0), "times that never fall: a course cannot go back"),
        (Course(times=(1.0,), values=(1.0, 2.0)), "each with a time and a value"),
        (Course(times=(1.0,), values=(float("nan"),)), "course.values: expected finite numbers"),
        (Course(growth=0.0).hold(1.0), "course.growth: expected a number above 0 and up to 1"),
        (Course(frames=(2.0,)).hold(1.0), "times within the course, after 0 to 1 s"),
        (Course(frames=(0.0,)).hold(1.0), "times within the course, after 0 to 1 s"),
        (Course(frames=(0.5, 0.5)).hold(1.0), "course.frames: expected times that rise"),
        (Course(frames=(0.5, 0.5 + 5e-13)).hold(1.0), "expected times that rise, each by more than 1e-12"),
        (Course(frames=()).hold(1.0), "at least one time, or None"),
        (Course(frames=0.5).hold(1.0), "course.frames: expected at least one time, or None, got 0.5"),  # type: ignore[arg-type]
        (Course(times=None, values=(1.0,)), "course.times: expected a sequence of numbers, got None"),  # type: ignore[arg-type]
        (Course(times=(1.0,), values=1.0), "course.values: expected a sequence of numbers"),  # type: ignore[arg-type]
    ],
)
def test_a_course_that_cannot_be_is_refused_in_one_sentence(course: Course, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        course.check()


def test_a_frame_at_the_end_of_a_ramp_is_within_the_course() -> None:
    """A duration from a speed is rounded."""
    for speed in (0.2, 0.3, 0.07):
        for to in np.arange(1.1, 2.0, 0.1).tolist():
            course = Course(start=1.0).ramp(to=to, speed=speed)
            exact = round((to - 1.0) / speed, 14)
            whole = replace(course, frames=(exact,))
            whole.check()
            assert [stop.frame for stop in whole.stops(None)][-1]
            assert course.end_at(exact) == course.duration
            assert course.end_at(0.999 * exact) is None


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (lambda c: c.cycles(to=1.3, back=1.0, speed=0.1, count=-2), "course.cycles.count: expected a whole"),
        (lambda c: c.cycles(to=1.3, back=1.0, speed=0.1, count=1.5), "course.cycles.count: expected a whole"),
        (lambda c: c.hold("60"), "course.duration: expected Real, got 'str'"),
        (lambda c: c.ramp(to="1.3", speed=0.1), "course.ramp.to: expected Real, got 'str'"),
    ],
)
def test_a_piece_of_the_wrong_kind_is_refused(wrong: Callable[[Course], Course], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        wrong(Course(start=1.0))


def test_arrays_are_taken_for_tuples() -> None:
    times, values = np.array([1.0, 2.0]), np.array([1.2, 1.3])
    course = Course(start=1.0, times=times, values=values, frames=np.array([0.5, 2.0]))  # type: ignore[arg-type]
    assert course == Course(start=1.0, times=(1.0, 2.0), values=(1.2, 1.3), frames=(0.5, 2.0))
    course.check()
    assert [stop.time for stop in course.stops(None) if stop.frame] == [0.5, 2.0]


def test_a_piece_that_cannot_be_is_refused_as_it_is_written() -> None:
    with pytest.raises(ValueError, match="expected either a speed or a duration"):
        Course().ramp(to=1.0)
    with pytest.raises(ValueError, match="expected a speed other than 0"):
        Course().ramp(to=1.0, speed=0.0)
