"""A beam in experiment.yaml: its keys, read into SI."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from calibration.experiment._fields import (
    CircleSection,
    Component,
    CsvFile,
    Doubt,
    Length,
    Name,
    Noise,
    Numbers3,
    PhotoFile,
    Position,
    RectangleSection,
    Strict,
    below,
    metres,
    only_one,
    say,
)
from calibration.experiment._files import Files, parse_table
from calibration.experiment._outline import read_sides
from calibration.experiment.model import (
    BeamTrial,
    Capture,
    Checkerboard,
    Marker,
    Registration,
    Supports,
    TracedOutline,
)
from tisim import Circle, Rectangle

_MM = 1e-3
_STRONGEST = 100.0  # m/s2: a gravity beyond is one in mm/s2
_FAR = 3.0  # free lengths: a marker beyond is a slip of the unit

_MOST_SQUARES = 600  # the search for a larger board takes more memory than a machine has

Squares = Annotated[int, Field(ge=3, le=60)]


class Section(Strict):
    """One of the two sections."""

    circle: CircleSection | None = None
    rectangle: RectangleSection | None = None

    @model_validator(mode="after")
    def _one(self) -> Section:
        only_one(circle=self.circle, rectangle=self.rectangle)
        return self

    @property
    def height_mm(self) -> float:
        """Along z."""
        if self.circle is not None:
            return 2 * self.circle.radius_mm
        assert self.rectangle is not None
        return self.rectangle.height_mm

    def si(self) -> tuple[Circle | Rectangle, tuple[float, ...]]:
        """The section and the standard deviations of its lengths [m]."""
        if self.circle is not None:
            return Circle(radius=self.circle.radius_mm * _MM), (self.circle.radius_sd_mm * _MM,)
        box = self.rectangle
        assert box is not None
        return (
            Rectangle(width=box.width_mm * _MM, height=box.height_mm * _MM),
            (box.width_sd_mm * _MM, box.height_sd_mm * _MM),
        )


class RegistrationEntry(Strict):
    """All three are asked for: 0 where the lab takes one for exact."""

    shift_mm: Doubt
    roll_deg: Annotated[float, Field(ge=0, le=90)]
    scale: Annotated[float, Field(ge=0, le=0.5)]

    def si(self) -> Registration:
        return Registration(shift=self.shift_mm * _MM, roll=math.radians(self.roll_deg), scale=self.scale)


class CheckerboardEntry(Strict):
    """The board in a photograph."""

    squares: tuple[Squares, Squares]
    square_mm: Length

    @model_validator(mode="after")
    def _searchable(self) -> CheckerboardEntry:
        count = self.squares[0] * self.squares[1]
        if count > _MOST_SQUARES:
            raise say("squares", f"expected at most {_MOST_SQUARES} squares on the board, got {count}")
        return self


class CaptureEntry(Strict):
    """One photograph. The error of a traced outline must be stated: a default would make the fit surer than
    the lab is."""

    time_s: Annotated[float, Field(gt=0, le=1e9)]
    outline: CsvFile | None = None
    outline_sd_mm: Noise | None = None
    outline_correlation_mm: Doubt | None = None
    registration_sd: RegistrationEntry | None = None
    registration_shared_sd: RegistrationEntry | None = None
    photo: PhotoFile | None = None
    photo_checkerboard: CheckerboardEntry | None = None

    @model_validator(mode="after")
    def _complete(self) -> CaptureEntry:
        if self.outline is None and self.photo is None:
            raise say("outline", "missing, expected an outline or a photo")
        error_keys = ("outline_sd_mm", "outline_correlation_mm")
        for key in (*error_keys, "registration_sd"):
            if self.outline is not None and getattr(self, key) is None:
                raise say(key, "missing, expected it beside an outline (what does the lab say of it?)")
        for key in (*error_keys, "registration_shared_sd"):
            if self.outline is None and getattr(self, key) is not None:
                raise say(key, "expected an outline beside it")
        if self.photo is not None and self.photo_checkerboard is None:
            raise say("photo_checkerboard", "missing, expected it beside a photo")
        if self.photo is None and self.photo_checkerboard is not None:
            raise say("photo_checkerboard", "expected a photo beside it")
        return self


class BeamEntry(Strict):
    """A beam in its grips."""

    id: Name
    kind: Literal["beam"]
    material: Name
    specimen: Name | None = None
    section: Section
    free_length_mm: Length
    free_length_sd_mm: Doubt = 0.0
    grip_length_mm: Length
    supports: Supports
    gravity_m_s2: Numbers3
    tip_force_N: Numbers3 = (0.0, 0.0, 0.0)
    tip_force_height_mm: Component = 0.0
    captures: Annotated[tuple[CaptureEntry, ...], Field(min_length=1)] | None = None
    markers: CsvFile | None = None
    marker_positions_mm: Annotated[dict[Name, Position], Field(min_length=1)] | None = None
    marker_sd_mm: Noise | None = None

    @model_validator(mode="after")
    def _complete(self) -> BeamEntry:
        below("free_length_sd_mm", self.free_length_sd_mm, "free_length_mm", self.free_length_mm)
        if math.hypot(*self.gravity_m_s2) > _STRONGEST:
            raise say("gravity_m_s2", f"expected a length of at most {_STRONGEST:g} m/s2")
        if any(self.tip_force_N) and self.supports == "clamped-clamped":
            raise say("tip_force_N", "expected none between two clamps, where no face is free")
        if self.tip_force_height_mm:
            if not any(self.tip_force_N):
                raise say("tip_force_N", "missing, expected it beside tip_force_height_mm")
            if self.markers is None or self.captures is not None:
                raise say(
                    "tip_force_height_mm", "expected with markers only: outlines are of a force all over"
                )
            half = 0.5 * self.section.height_mm
            if abs(self.tip_force_height_mm) > half:
                raise say("tip_force_height_mm", f"expected a height on the end face, -{half:g} to {half:g}")
        if self.captures is None and self.markers is None:
            raise say("captures", "missing, expected captures or markers")
        for key in ("marker_positions_mm", "marker_sd_mm"):
            if self.markers is not None and getattr(self, key) is None:
                raise say(key, "missing, expected it beside markers")
            if self.markers is None and getattr(self, key) is not None:
                raise say("markers", f"missing, expected it beside {key}")
        captures = self.captures or ()
        for k in range(1, len(captures)):
            # two photographs at one instant are fine, each with its own registration
            if captures[k].time_s < captures[k - 1].time_s:
                raise say(
                    f"captures.{k}.time_s",
                    f"expected {captures[k - 1].time_s:g} or more, as captures stand in order of time, "
                    f"got {captures[k].time_s:g}",
                )
        return self


def read_beam(entry: BeamEntry, files: Files, where: str) -> BeamTrial:
    """The trial in SI, with the files that it names; where: its place in experiment.yaml, for errors."""
    section, section_sd = entry.section.si()
    return BeamTrial(
        id=entry.id,
        material=entry.material,
        specimen=entry.specimen,
        section=section,
        section_sd=section_sd,
        free_length=entry.free_length_mm * _MM,
        free_length_sd=entry.free_length_sd_mm * _MM,
        grip_length=entry.grip_length_mm * _MM,
        supports=entry.supports,
        gravity=entry.gravity_m_s2,
        tip_force=entry.tip_force_N,
        tip_force_height=entry.tip_force_height_mm * _MM,
        captures=tuple(
            _capture(c, entry, files, f"{where}.captures[#{k}]")
            for k, c in enumerate(entry.captures or (), 1)
        ),
        markers=_markers(entry, files, where),
        marker_sd=None if entry.marker_sd_mm is None else entry.marker_sd_mm * _MM,
    )


def _capture(capture: CaptureEntry, beam: BeamEntry, files: Files, where: str) -> Capture:
    registration = None if capture.registration_sd is None else capture.registration_sd.si()
    shared = capture.registration_shared_sd
    outline = checkerboard = None
    if capture.outline is not None:
        upper, lower = read_sides(
            files.read(capture.outline, f"{where}.outline"),
            files.folder / capture.outline,
            free_length_mm=beam.free_length_mm,
            height_mm=beam.section.height_mm,
        )
        assert capture.outline_sd_mm is not None
        assert capture.outline_correlation_mm is not None
        assert registration is not None
        outline = TracedOutline(
            upper=upper * _MM,
            lower=lower * _MM,
            sd=capture.outline_sd_mm * _MM,
            correlation=capture.outline_correlation_mm * _MM,
            registration=registration,
            shared=Registration() if shared is None else shared.si(),
        )
    if capture.photo is not None:
        files.read(capture.photo, f"{where}.photo")
        assert capture.photo_checkerboard is not None
        checkerboard = Checkerboard(
            squares=capture.photo_checkerboard.squares, square=capture.photo_checkerboard.square_mm * _MM
        )
    return Capture(
        time=capture.time_s,
        outline=outline,
        photo=None if capture.photo is None else files.folder / capture.photo,
        checkerboard=checkerboard,
        registration=registration,
    )


def _markers(entry: BeamEntry, files: Files, where: str) -> tuple[Marker, ...]:
    if entry.markers is None or entry.marker_positions_mm is None:
        return ()
    positions = entry.marker_positions_mm
    reach = _FAR * max(entry.free_length_mm, entry.section.height_mm)
    for name, position in positions.items():
        if math.hypot(*position) > reach:
            raise files.error(
                f"{where}.marker_positions_mm.{name}",
                f"expected a place within {reach:g} mm (3 free lengths) of the clamp",
            )
    components = ("ux_mm", "uy_mm", "uz_mm")
    table = parse_table(
        files.read(entry.markers, f"{where}.markers"),
        files.folder / entry.markers,
        texts=("marker",),
        numbers=("time_s", *components),
    )
    rows: dict[str, list[int]] = {name: [] for name in positions}
    for row, name in enumerate(table.texts["marker"]):
        if name not in rows:
            raise table.error(
                row,
                f"column marker: expected one of marker_positions_mm ({', '.join(positions)}), got {name!r}",
            )
        rows[name].append(row)
    for name in components:
        table.need_within(name, reach, "3 free lengths")
    markers = []
    for name, own in rows.items():
        if not own:
            raise files.error(
                f"{where}.marker_positions_mm.{name}", f"expected rows of this marker in {entry.markers}"
            )
        table.need_clock(own, of=f" of marker {name}")
        markers.append(
            Marker(
                name=name,
                position=metres(positions[name]),
                time=table.numbers["time_s"][own],
                displacement=np.ascontiguousarray(table.columns(*components)[own]) * _MM,
            )
        )
    return tuple(markers)
