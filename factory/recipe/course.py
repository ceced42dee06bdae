"""The rod's course over time: its form in a recipe, the course of one poke, and the phase of each frame.

course:
  - {to_mm: 6, speed_mm_per_s: [1, 20]}    # drawn log-uniformly for each poke
  - {hold_s: 10}
  - {to_mm: 0, speed_mm_per_s: 5}
  - {hold_s: 5, frames: 4}
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, ValidationError
from pydantic_core import PydanticCustomError

from factory.strict_yaml import Strict, nested_problems
from tisim import Poke
from tisim.course import Course

PHASES = ("load", "hold", "retract", "reload", "rest")
_MM = 1e-3
_SAME = 1e-9  # relative to a ramp: closer points coincide
_ROUNDED = 1e-15  # relative error of a stored time
_LONGEST = 1e9  # s


def _speeds(value: object) -> object:
    """Convert a single speed to an interval."""
    return (value, value) if isinstance(value, int | float) and not isinstance(value, bool) else value


class RampRecipe(Strict):
    """The rod moves to a depth at a speed.

    Attributes
    ----------
    to_mm : float
        Depth at its end.
    speed_mm_per_s : (float, float)
        Interval from which the speed of each poke is drawn log-uniformly; one number in a recipe is the speed
        of all pokes.
    """

    to_mm: Annotated[float, Field(ge=0, le=1e6)]
    speed_mm_per_s: Annotated[
        tuple[Annotated[float, Field(gt=0, le=1e6)], Annotated[float, Field(gt=0, le=1e6)]],
        BeforeValidator(_speeds),
    ]


class HoldRecipe(Strict):
    """The rod is held at its depth.

    Attributes
    ----------
    hold_s : float
        Duration.
    frames : int
        Number of frames: one at the end, each earlier one at half the time of the next (relaxation).
    """

    hold_s: Annotated[float, Field(gt=0, le=_LONGEST)]
    frames: Annotated[int, Field(ge=1, le=60)] = 8


def _piece(value: object) -> object:
    """Validate a recipe's entry as a ramp or a hold."""
    if not isinstance(value, Mapping):
        raise PydanticCustomError("piece", "expected the keys to_mm and speed_mm_per_s, or hold_s")
    try:
        return (HoldRecipe if "hold_s" in value else RampRecipe).model_validate(value)
    except ValidationError as error:
        raise nested_problems(error) from None


Piece = Annotated[RampRecipe | HoldRecipe, BeforeValidator(_piece)]


def check_pieces(pieces: Sequence[RampRecipe | HoldRecipe], depth_mm: float) -> None:
    """Raise ValueError if a course begins with a hold, has a bad ramp, or another depth than `depth_mm`."""
    now = deepest = 0.0
    for number, piece in enumerate(pieces):
        if isinstance(piece, HoldRecipe):
            if number == 0:
                raise ValueError("course.0: expected a ramp from the first touch, to_mm and speed_mm_per_s")
            continue
        low, high = piece.speed_mm_per_s
        if low > high:
            raise ValueError(
                f"course.{number}.speed_mm_per_s: expected speeds that rise, got {low:g}, {high:g}"
            )
        if piece.to_mm == now:
            raise ValueError(f"course.{number}.to_mm: expected another depth than {now:g}, where the rod is")
        now = piece.to_mm
        deepest = max(deepest, now)
    if pieces and deepest != depth_mm:
        raise ValueError(f"depth_mm: expected the course's largest depth of {deepest:g}, got {depth_mm:g}")


def travel(pieces: Sequence[RampRecipe | HoldRecipe], depth_mm: float) -> float:
    """Way of the rod [mm]: the sum of a course's ramps, or the depth without a course."""
    ends = [0.0, *(piece.to_mm for piece in pieces if isinstance(piece, RampRecipe))]
    return sum(abs(b - a) for a, b in pairwise(ends)) if pieces else depth_mm


def draw_course(
    pieces: Sequence[RampRecipe | HoldRecipe], spacing_mm: float, random: np.random.Generator
) -> Course:
    """Draw the course of one poke [m, s]; frames are a spacing apart in ramps, at doubling times in holds."""
    course, frames = Course(), []
    for piece in pieces:
        begin, before = course.duration, course.values[-1] if course.values else 0.0
        if isinstance(piece, HoldRecipe):
            course = course.hold(piece.hold_s)
            frames += [begin + piece.hold_s * 0.5**k for k in reversed(range(1, piece.frames))]
        else:
            speed = _drawn(piece.speed_mm_per_s, random) * _MM
            course = course.ramp(to=piece.to_mm * _MM, speed=speed)
            travel = abs(piece.to_mm * _MM - before)
            steps = np.arange(1, int(travel / (spacing_mm * _MM) * (1.0 - _SAME)) + 1)
            frames += [begin + float(step) * spacing_mm * _MM / speed for step in steps]
        frames.append(course.duration)
    return Course(times=course.times, values=course.values, frames=tuple(frames))


def _drawn(speeds: tuple[float, float], random: np.random.Generator) -> float:
    low, high = speeds
    return low if low == high else float(np.exp(random.uniform(np.log(low), np.log(high))))


def deepest(scene: Poke) -> float:
    """Requested travel [m], with or without a course."""
    return scene.depth if scene.course is None else float(max(scene.course.values))


def phases(depths: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Phase of each piece of a course, as an index into PHASES, from the depths at their ends.

    Deeper is "load", or "reload" once the rod has been retracted; a hold at depth 0 is a "rest".
    """
    moves = np.diff(depths, prepend=0.0)
    found = np.where(moves > 0.0, 0, 2)
    found[(moves > 0.0) & (np.cumsum(moves < 0.0) > 0)] = 3
    found[moves == 0.0] = 1
    found[(moves == 0.0) & (depths == 0.0)] = 4
    return found.astype(np.uint8)


def pieces_at(times: NDArray[np.float64], moments: NDArray[np.float64]) -> NDArray[np.int64]:
    """Index of the piece of a course at each moment; a corner belongs to the piece that ends there."""
    found = np.searchsorted(times * (1.0 + _ROUNDED), moments)
    return np.minimum(found, len(times) - 1).astype(np.int64)


def states_at(
    times: NDArray[np.float64], depths: NDArray[np.float64], moments: NDArray[np.float64]
) -> dict[str, NDArray[Any]]:
    """Arrays phase, depth [m] and rod_speed [m/s] at moments [s] of the course with these corners."""
    piece = pieces_at(times, moments)
    ends, values = np.append(0.0, times), np.append(0.0, depths)
    speeds = np.diff(values) / np.diff(ends)
    return {
        "phase": phases(depths)[piece],
        "depth": np.interp(moments, ends, values),
        "rod_speed": speeds[piece],
    }
