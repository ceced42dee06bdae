"""Answers that make an experiment from a lab's files: a YAML file, checked strictly."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from calibration.errors import InputError
from calibration.experiment import PhotoSettings
from calibration.experiment._beam import CheckerboardEntry, RegistrationEntry, Section
from calibration.experiment._fields import (
    Component,
    Doubt,
    Length,
    Name,
    Noise,
    Numbers3,
    Position,
    Strict,
    different_ids,
    say,
)
from calibration.experiment._poke import InclusionEntry, Lengths3, RodEntry
from calibration.experiment._read import MaterialEntry
from calibration.experiment._yaml import sentence
from calibration.experiment.model import CouponMode, Supports
from calibration.lab_files import DIMENSIONS, Quantity, unit
from calibration.new._plausible import CHECKS
from tisim.io.bounded_yaml import as_tuples

SourceFile = Annotated[str, Field(min_length=1, max_length=1000)]
Direction = Literal["tension", "compression"]


class _TrialAnswers(Strict):
    """Keys of every trial; `accept` names the checks of plausibility that the lab has looked into."""

    id: Name
    material: Name | None = None
    specimen: Name | None = None
    accept: tuple[str, ...] = ()

    @model_validator(mode="after")
    def _known_checks(self) -> _TrialAnswers:
        known = [check.name for check in CHECKS]
        for name in self.accept:
            if name not in known:
                raise say("accept", f"expected names of {', '.join(known)}, got {name!r}")
        return self


class _RecordAnswers(_TrialAnswers):
    """A trial whose record comes from a file of a machine."""

    file: SourceFile
    format: str | None = None
    test: str | Annotated[int, Field(ge=1)] | None = None
    decimals: Literal["comma", "point"] | None = None
    columns: dict[Quantity, str] = Field(default_factory=dict)
    units: dict[str, str] = Field(default_factory=dict)
    displacement_positive: Direction | None = None
    displacement_zero_mm: Component | None = None
    force_positive: Direction | None = None
    force_zero_N: Component = 0.0
    leave_out_rows: bool = False

    @model_validator(mode="after")
    def _known_units(self) -> _RecordAnswers:
        for header, text in self.units.items():
            if unit(text) is None:
                raise say(f"units.{header}", f"expected a unit such as N, mm, kPa, % or 1, got {text!r}")
        return self


class CouponAnswers(_RecordAnswers):
    """A homogeneous test."""

    kind: Literal["coupon"]
    mode: CouponMode | None = None
    rest_length_mm: Length | None = None
    area_mm2: Annotated[float, Field(gt=0, le=1e8)] | None = None
    diameter_mm: Length | None = None
    width_mm: Length | None = None
    thickness_mm: Length | None = None
    stretch_sd: Annotated[float, Field(ge=0, le=1)] | None = None
    stress_sd_kPa: Noise | None = None

    @model_validator(mode="after")
    def _one_area(self) -> CouponAnswers:
        sides = self.width_mm is not None or self.thickness_mm is not None
        if (self.area_mm2 is not None) + (self.diameter_mm is not None) + sides > 1:
            raise say("area_mm2", "expected one of area_mm2, diameter_mm, or width_mm and thickness_mm")
        return self


class SurfaceAnswers(Strict):
    """A scan of the top surface of a block."""

    time_s: Annotated[float, Field(ge=0, le=1e9)] | None = None
    points: SourceFile
    point_sd_mm: Noise | None = None


class PokeAnswers(_RecordAnswers):
    """An indentation test."""

    kind: Literal["poke"]
    block_mm: Lengths3 | None = None
    inclusion: InclusionEntry | None = None
    rod: RodEntry | None = None
    start_mm: Position | None = None
    direction: Numbers3 | None = None
    force_sd_N: Noise | None = None
    depth_sd_mm: Doubt | None = None
    surfaces: tuple[SurfaceAnswers, ...] = ()


class RegistrationAnswers(Strict):
    """Standard deviations of one error a photograph; what is left out is proposed."""

    shift_mm: Doubt | None = None
    roll_deg: Annotated[float, Field(ge=0, le=90)] | None = None
    scale: Annotated[float, Field(ge=0, le=0.5)] | None = None


class CaptureAnswers(Strict):
    """A photograph of a beam, or its traced outline."""

    time_s: Annotated[float, Field(gt=0, le=1e9)] | None = None
    outline: SourceFile | None = None
    outline_sd_mm: Noise | None = None
    outline_correlation_mm: Doubt | None = None
    registration_sd: RegistrationAnswers | None = None
    registration_shared_sd: RegistrationEntry | None = None
    photo: SourceFile | None = None
    photo_checkerboard: CheckerboardEntry | None = None

    @model_validator(mode="after")
    def _seen(self) -> CaptureAnswers:
        if self.outline is None and self.photo is None:
            raise say("outline", "missing, expected an outline or a photo")
        return self

    @model_validator(mode="after")
    def _shared_by_outlines(self) -> CaptureAnswers:
        if self.registration_shared_sd is not None and self.outline is None:
            raise say("registration_shared_sd", "expected an outline beside it")
        return self


class BeamAnswers(_TrialAnswers):
    """A cantilever or bridge that is photographed, or tracked by markers."""

    kind: Literal["beam"]
    section: Section | None = None
    free_length_mm: Length | None = None
    free_length_sd_mm: Doubt | None = None
    grip_length_mm: Length | None = None
    supports: Supports | None = None
    gravity_m_s2: Numbers3 | None = None
    tip_force_N: Numbers3 | None = None
    tip_force_height_mm: Component | None = None
    captures: Annotated[tuple[CaptureAnswers, ...], Field(min_length=1)] | None = None
    markers: SourceFile | None = None
    marker_positions_mm: Annotated[dict[Name, Position], Field(min_length=1)] | None = None
    marker_sd_mm: Noise | None = None

    @model_validator(mode="after")
    def _seen(self) -> BeamAnswers:
        if self.captures is None and self.markers is None:
            raise say("captures", "missing, expected captures or markers")
        for key in ("marker_positions_mm", "marker_sd_mm"):
            if self.markers is None and getattr(self, key) is not None:
                raise say("markers", f"missing, expected it beside {key}")
        return self


class BoardAnswers(Strict):
    """The checkerboard to print."""

    squares: tuple[Annotated[int, Field(ge=3, le=60)], Annotated[int, Field(ge=3, le=60)]] = (9, 6)
    square_mm: Annotated[float, Field(ge=1, le=200)] = 10.0
    page: Literal["a4", "a3", "letter"] = "a4"


TrialAnswers = Annotated[CouponAnswers | PokeAnswers | BeamAnswers, Field(discriminator="kind")]


class Answers(Strict):
    """An answers file: what experiment.yaml says, with the lab's own files in place of its tables."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    notes: str = ""
    materials: dict[Name, MaterialEntry] = Field(default_factory=dict)
    board: BoardAnswers | None = None
    photographs: PhotoSettings | None = None
    trials: Annotated[tuple[TrialAnswers, ...], Field(min_length=1)]

    @model_validator(mode="after")
    def _ids(self) -> Answers:
        different_ids(self.trials)
        return self

    @model_validator(mode="after")
    def _of_photographs(self) -> Answers:
        beams = [t for t in self.trials if isinstance(t, BeamAnswers)]
        if self.photographs is not None and not any(c.photo for t in beams for c in t.captures or ()):
            raise say("photographs", "expected none without a capture that has a photo")
        return self


def fits(quantity: Quantity, text: str) -> bool:
    """True if a unit measures a quantity."""
    given = unit(text)
    return given is not None and given.dimension == DIMENSIONS[quantity]


def validate(raw: dict[str, Any]) -> Answers:
    """Answers that were given at a terminal.

    Raises
    ------
    InputError
        One does not fit.
    """
    data: Any = as_tuples(raw)
    try:
        return Answers.model_validate(data)
    except ValidationError as error:
        raise InputError(f"answers: {sentence(error, data)}") from None
