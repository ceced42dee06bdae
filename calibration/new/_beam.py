"""A beam: photographs, traced outlines or markers, and what the lab knows of it."""

from __future__ import annotations

from typing import Any

from calibration.new._answers import BeamAnswers, CaptureAnswers
from calibration.new._asking import SD, Question, above_zero, numbers, one_of
from calibration.new._plausible import Bar
from calibration.new._trial import Work

# what callipers and rulers give, and the outlines of photographs traced by hand
_LENGTH_SD, _SIDE_SD = 0.2, 0.05  # mm
_OUTLINE = {"outline_sd_mm": 0.2, "outline_correlation_mm": 10.0}
_REGISTRATION = {"shift_mm": 0.2, "roll_deg": 0.3, "scale": 0.005}
_DENSITY_SD = 0.01  # of the density


def make_beam(work: Work, entry: BeamAnswers) -> dict[str, Any]:
    """Keys of the trial in experiment.yaml; its photographs and tables are copied.

    Raises
    ------
    InputError
        A file is missing, or something is left open that has no default.
    """
    where = entry.id
    trial: dict[str, Any] = {"section": _section(work, entry)}
    trial["free_length_mm"] = work.settle(
        where,
        "free_length_mm",
        entry.free_length_mm,
        "free length of the beam, outside the clamps [mm]",
        above_zero,
    )
    trial["free_length_sd_mm"] = work.settle_sd(
        where, "free_length_sd_mm", entry.free_length_sd_mm, "the free length [mm]", _LENGTH_SD, "of a ruler"
    )
    trial["grip_length_mm"] = work.settle(
        where, "grip_length_mm", entry.grip_length_mm, "length held inside a clamp [mm]", above_zero
    )
    ends = ("clamped-free", "clamped-clamped")
    trial["supports"] = work.settle(
        where, "supports", entry.supports, f"supports of the beam: {' or '.join(ends)}", one_of(ends)
    )
    gravity = None if entry.gravity_m_s2 is None else list(entry.gravity_m_s2)
    trial["gravity_m_s2"] = work.settle(
        where,
        "gravity_m_s2",
        gravity,
        "gravity in the beam's frame: x out of the clamp, z up [m/s2]",
        numbers(3),
        default=[0.0, 0.0, -9.81],
        why="a level clamp",
    )
    if entry.tip_force_N is not None:
        trial["tip_force_N"] = list(entry.tip_force_N)
    if entry.tip_force_height_mm is not None:
        trial["tip_force_height_mm"] = entry.tip_force_height_mm
    if entry.captures is not None:
        trial["captures"] = [_capture(work, capture, where, k) for k, capture in enumerate(entry.captures, 1)]
    if entry.markers is not None:
        trial |= _markers(work, entry, entry.markers)
    return trial


def _markers(work: Work, entry: BeamAnswers, table: str) -> dict[str, Any]:
    where = entry.id
    given = entry.marker_positions_mm
    positions = work.settle(
        where,
        "marker_positions_mm",
        None if given is None else {name: list(place) for name, place in given.items()},
        "position of each marker in the unloaded pose, x from the clamp's face, y, z [mm]:"
        " NAME: x, y, z; NAME: x, y, z",
        _positions,
    )
    sd = work.settle(
        where,
        "marker_sd_mm",
        entry.marker_sd_mm,
        "standard deviation of each component of a marker's displacement [mm]",
        above_zero,
        help=SD,
    )
    name = work.copy(work.source(table, f"{where}.markers"), "beams")
    return {"markers": name, "marker_positions_mm": positions, "marker_sd_mm": sd}


def _positions(text: str) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for part in filter(str.strip, text.split(";")):
        name, colon, place = part.rpartition(":")
        if not colon or not name.strip():
            raise ValueError(f"expected NAME: x, y, z, got {part.strip()!r}")
        found[name.strip()] = numbers(3)(place)
    if not found:
        raise ValueError("expected at least one NAME: x, y, z")
    return found


def _section(work: Work, entry: BeamAnswers) -> dict[str, Any]:
    where = entry.id
    if entry.section is not None:
        ((shape, given),) = entry.section.model_dump(exclude_none=True, exclude_unset=True).items()
    else:
        shapes = ("circle", "rectangle")
        question = Question(
            key="section", text="section of the beam: circle or rectangle", read=one_of(shapes), kept=False
        )
        shape = work.asker.ask(where, question)[0]
        given = {}
    sides = {"circle": ("radius",), "rectangle": ("width", "height")}[shape]
    found: dict[str, float] = {}
    for side in sides:
        key = f"section.{shape}.{side}"
        along = {"width": " along y", "height": " along z"}.get(side, "")
        found[f"{side}_mm"] = work.settle(
            where, f"{key}_mm", given.get(f"{side}_mm"), f"{side} of the section{along} [mm]", above_zero
        )
        found[f"{side}_sd_mm"] = work.settle_sd(
            where, f"{key}_sd_mm", given.get(f"{side}_sd_mm"), f"the {side} [mm]", _SIDE_SD, "of callipers"
        )
    return {shape: found}


def _capture(work: Work, capture: CaptureAnswers, where: str, number: int) -> dict[str, Any]:
    place = f"{where}.captures[#{number}]"
    found: dict[str, Any] = {
        "time_s": work.settle(
            place, "time_s", capture.time_s, "time from the beam's release to the photograph [s]", above_zero
        )
    }
    if capture.outline is not None:
        found["outline"] = work.copy(work.source(capture.outline, f"{place}.outline"), "beams")
        of = {
            "outline_sd_mm": "a traced point, along the contour's normal [mm]",
            "outline_correlation_mm": "",
        }
        for key, default in _OUTLINE.items():
            given = getattr(capture, key)
            if of[key]:
                found[key] = work.settle_sd(
                    place, key, given, of[key], default, "of an outline traced by hand"
                )
            else:
                found[key] = work.settle(
                    place,
                    key,
                    given,
                    "length over which the error of tracing stays alike [mm]",
                    above_zero,
                    default=default,
                    why="proposed, not measured: of an outline traced by hand",
                )
        if capture.registration_shared_sd is not None:
            found["registration_shared_sd"] = capture.registration_shared_sd.model_dump()
        words = {"shift_mm": "shift [mm]", "roll_deg": "turn [deg]", "scale": "scale [-]"}
        found["registration_sd"] = {
            key: work.settle_sd(
                place,
                f"registration_sd.{key}",
                getattr(capture.registration_sd, key, None),
                f"the photograph's {words[key]}",
                default,
                "of a tripod",
            )
            for key, default in _REGISTRATION.items()
        }
    if capture.photo is not None:
        found["photo"] = work.copy(work.source(capture.photo, f"{place}.photo"), "photos")
        if capture.photo_checkerboard is not None:
            board = capture.photo_checkerboard.model_dump()
            found["photo_checkerboard"] = {**board, "squares": list(board["squares"])}
        else:
            found["photo_checkerboard"] = {
                "squares": work.settle(
                    place,
                    "photo_checkerboard.squares",
                    None,
                    "squares of the board along its two sides (not inner corners)",
                    _squares,
                ),
                "square_mm": work.settle(
                    place,
                    "photo_checkerboard.square_mm",
                    None,
                    "side of a square of the board [mm]",
                    above_zero,
                ),
            }
    return found


def _squares(text: str) -> list[int]:
    return [int(v) for v in numbers(2, above_zero)(text)]


def density(work: Work, name: str, given: dict[str, Any]) -> dict[str, Any]:
    """A material's keys with its density, which a beam under its own weight needs."""
    where = f"materials.{name}"
    value = work.settle(
        where, "density_kg_m3", given.get("density_kg_m3"), "density of the material [kg/m3]", above_zero
    )
    sd = work.settle_sd(
        where,
        "density_sd_kg_m3",
        given.get("density_sd_kg_m3"),
        "the density [kg/m3]",
        _DENSITY_SD * float(value),
        "1 %",
    )
    return {**given, "density_kg_m3": value, "density_sd_kg_m3": sd}


def bar(trial: dict[str, Any], density: float) -> Bar:
    """Values that the checks of plausibility use."""
    ((shape, sides),) = trial["section"].items()
    height = 2 * sides["radius_mm"] if shape == "circle" else sides["height_mm"]
    return Bar(free_length=trial["free_length_mm"] * 1e-3, height=height * 1e-3, density=density)
