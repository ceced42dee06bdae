"""An indentation in experiment.yaml: its keys, read into SI.

Inclusions, all rigid: `sphere: {radius_mm, centre_mm}`, `box: {size_mm, centre_mm, angle_deg}` (angle about
z, 0 where left out), `cylinder: {radius_mm, height_mm, centre_mm}` (upright) or `mesh: file.stl`.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from calibration.errors import InputError
from calibration.experiment._fields import (
    CsvFile,
    Doubt,
    Length,
    MeshFile,
    Name,
    Noise,
    Numbers3,
    Position,
    Strict,
    metres,
    only_one,
    say,
)
from calibration.experiment._files import Files, Table, parse_table
from calibration.experiment.model import PokeRecord, PokeTrial, SurfaceScan, Vector
from tisim import Block, BoxInclusion, CylinderInclusion, Inclusion, SphereInclusion

_MM = 1e-3
_FAR = 3.0  # largest sides of the block: a depth or a scanned point beyond is a slip of the unit
_FLAT = 1e-3  # of the block's height: the same
_SHALLOW = 0.01  # indenter radii: a record that ends above is one in metres, or says nothing
_COMPONENTS = ("force_x_N", "force_y_N", "force_z_N")

Lengths3 = tuple[Length, Length, Length]


class SphereEntry(Strict):
    """A sphere."""

    radius_mm: Length
    centre_mm: Position

    def si(self) -> Inclusion:
        return SphereInclusion(radius=self.radius_mm * _MM, centre=metres(self.centre_mm))


class BoxEntry(Strict):
    """A box, turned about z."""

    size_mm: Lengths3
    centre_mm: Position
    angle_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0

    def si(self) -> Inclusion:
        return BoxInclusion(
            size=metres(self.size_mm), centre=metres(self.centre_mm), angle=math.radians(self.angle_deg)
        )


class CylinderEntry(Strict):
    """An upright cylinder."""

    radius_mm: Length
    height_mm: Length
    centre_mm: Position

    def si(self) -> Inclusion:
        return CylinderInclusion(
            radius=self.radius_mm * _MM, height=self.height_mm * _MM, centre=metres(self.centre_mm)
        )


class InclusionEntry(Strict):
    """One of the inclusions."""

    sphere: SphereEntry | None = None
    box: BoxEntry | None = None
    cylinder: CylinderEntry | None = None
    mesh: MeshFile | None = None

    @model_validator(mode="after")
    def _one(self) -> InclusionEntry:
        only_one(sphere=self.sphere, box=self.box, cylinder=self.cylinder, mesh=self.mesh)
        return self

    @property
    def shape(self) -> SphereEntry | BoxEntry | CylinderEntry | None:
        return self.sphere or self.box or self.cylinder


class RodEntry(Strict):
    """The indenter."""

    radius_mm: Length
    tip: Literal["flat", "hemisphere"]


class SurfaceEntry(Strict):
    """A scan of the top surface."""

    time_s: Annotated[float, Field(ge=0, le=1e9)]
    points: CsvFile
    point_sd_mm: Noise


class PokeEntry(Strict):
    """An indentation of a block."""

    id: Name
    kind: Literal["poke"]
    material: Name
    specimen: Name | None = None
    block_mm: Lengths3
    inclusion: InclusionEntry | None = None
    rod: RodEntry
    start_mm: Position
    direction: Numbers3
    record: CsvFile
    force_sd_N: Noise | None = None
    depth_sd_mm: Doubt = 0.0
    surfaces: tuple[SurfaceEntry, ...] = ()

    @model_validator(mode="after")
    def _consistent(self) -> PokeEntry:
        if not math.hypot(*self.direction) > 1e-12:
            raise say("direction", "expected a direction, got a vector without length")
        if self.direction[2] >= 0:
            raise say("direction", f"expected one into the block (z below 0), got z = {self.direction[2]:g}")
        x, y, z = self.start_mm
        if not (abs(x) <= self.block_mm[0] / 2 and abs(y) <= self.block_mm[1] / 2 and z > 0):
            raise say("start_mm", f"expected a point above the block's base {self._sides}")
        shape = None if self.inclusion is None else self.inclusion.shape
        if shape is not None:
            x, y, z = shape.centre_mm
            if not (
                abs(x) <= self.block_mm[0] / 2 and abs(y) <= self.block_mm[1] / 2 and z < self.block_mm[2]
            ):
                raise say("inclusion", f"expected a centre inside the block {self._sides}")
        for k in range(1, len(self.surfaces)):
            if self.surfaces[k].time_s <= self.surfaces[k - 1].time_s:
                raise say(
                    f"surfaces.{k}.time_s",
                    f"expected more than {self.surfaces[k - 1].time_s:g} of the scan before, "
                    f"got {self.surfaces[k].time_s:g}",
                )
        return self

    @property
    def _sides(self) -> str:
        a, b, c = self.block_mm
        return f"(x within +-{a / 2:g}, y within +-{b / 2:g}, z from 0 to {c:g} mm)"


def read_poke(entry: PokeEntry, files: Files, where: str) -> PokeTrial:
    """The trial in SI, with the files that it names; where: its place in experiment.yaml, for errors."""
    shape = mesh = None
    if entry.inclusion is not None:
        shape = entry.inclusion.shape
        if entry.inclusion.mesh is not None:
            files.read(entry.inclusion.mesh, f"{where}.inclusion.mesh")
            mesh = files.folder / entry.inclusion.mesh
    length = math.hypot(*entry.direction)
    u = (entry.direction[0] / length, entry.direction[1] / length, entry.direction[2] / length)
    record = _record(entry, files, where)
    _check_path(entry, u, 1e3 * float(record.depth.max()), files, where)
    return PokeTrial(
        id=entry.id,
        material=entry.material,
        specimen=entry.specimen,
        block=Block(size=metres(entry.block_mm), inclusion=None if shape is None else shape.si()),
        inclusion_mesh=mesh,
        rod_radius=entry.rod.radius_mm * _MM,
        rod_tip=entry.rod.tip,
        start=metres(entry.start_mm),
        direction=u,
        record=record,
        force_sd=entry.force_sd_N,
        depth_sd=entry.depth_sd_mm * _MM,
        surfaces=tuple(
            _surface(s, entry, files, f"{where}.surfaces[#{k}]") for k, s in enumerate(entry.surfaces, 1)
        ),
    )


def _record(entry: PokeEntry, files: Files, where: str) -> PokeRecord:
    table = parse_table(
        files.read(entry.record, f"{where}.record"),
        files.folder / entry.record,
        numbers=("time_s", "depth_mm", "force_N"),
        optional=_COMPONENTS,
    )
    table.need_rows(3)
    table.need_clock()
    _need_near(table, ("depth_mm",), entry)
    deepest = float(table.numbers["depth_mm"].max())
    if 0.0 < deepest < min(_SHALLOW * entry.rod.radius_mm, _FLAT * entry.block_mm[2]):
        raise InputError(
            f"{table.path}: column depth_mm: expected a depth in mm that an indenter of radius"
            f" {entry.rod.radius_mm:g} mm makes, the deepest is {deepest:g}; is the column in metres?"
        )
    for key, sd, column, what in (
        ("force_sd_N", entry.force_sd_N, "force_N", "the largest force of {} in N"),
        ("depth_sd_mm", entry.depth_sd_mm, "depth_mm", "the largest depth of {} in mm"),
    ):
        files.need_smaller_sd(f"{where}.{key}", sd, table.numbers[column], what.format(entry.record))
    given = [name for name in _COMPONENTS if name in table]
    if given and len(given) < 3:
        missing = next(name for name in _COMPONENTS if name not in table)
        raise InputError(
            f"{table.path}: line 1: missing column {missing}, expected {', '.join(_COMPONENTS)} together"
        )
    return PokeRecord(
        time=table.numbers["time_s"],
        depth=table.numbers["depth_mm"] * _MM,
        force=table.numbers["force_N"],
        force_vector=table.columns(*_COMPONENTS) if given else None,
    )


def _check_path(entry: PokeEntry, u: Vector, deepest: float, files: Files, where: str) -> None:
    """Refuse a tip that leaves the block through a side before its deepest place; u : of length 1; [mm]."""
    x, y = (entry.start_mm[i] + max(deepest, 0.0) * u[i] for i in range(2))
    half = [side / 2 for side in entry.block_mm[:2]]
    if abs(x) > half[0] or abs(y) > half[1]:
        raise files.error(
            f"{where}.direction",
            f"expected a path within the block's sides (x within +-{half[0]:g}, y within +-{half[1]:g} mm),"
            f" at the {deepest:g} mm of {entry.record} the tip is outside, at x = {x:.3g}, y = {y:.3g} mm",
        )


def _surface(scan: SurfaceEntry, entry: PokeEntry, files: Files, where: str) -> SurfaceScan:
    axes = ("x_mm", "y_mm", "z_mm")
    table = parse_table(files.read(scan.points, f"{where}.points"), files.folder / scan.points, numbers=axes)
    table.need_rows(3)
    _need_near(table, axes, entry)
    return SurfaceScan(time=scan.time_s, points=table.columns(*axes) * _MM, sd=scan.point_sd_mm * _MM)


def _need_near(table: Table, columns: tuple[str, ...], entry: PokeEntry) -> None:
    for name in columns:
        table.need_within(name, _FAR * max(entry.block_mm), "3 times the block's largest side")
