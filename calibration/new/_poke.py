"""An indentation test from a machine's record: time, depth and force along the indenter."""

from __future__ import annotations

from typing import Any

from calibration.lab_files import Quantity
from calibration.new._answers import PokeAnswers, SurfaceAnswers
from calibration.new._asking import SD, above_zero, numbers, one_of, zero_or_more
from calibration.new._plausible import Push
from calibration.new._record import open_record
from calibration.new._trial import Work, csv_text

_DEPTH_SD = 0.02  # mm


def make_poke(work: Work, entry: PokeAnswers) -> tuple[dict[str, Any], Push]:
    """Keys of the trial in experiment.yaml, and its curve; its table goes into `work`.

    Raises
    ------
    InputError
        The record has no time, displacement or force, is damaged, or something without default is left open.
    """
    where = entry.id
    block = work.settle(
        where,
        "block_mm",
        _listed(entry.block_mm),
        "sides of the block along x, y, z [mm]",
        numbers(3, above_zero),
    )
    if entry.rod is None:
        radius = work.settle(where, "rod.radius_mm", None, "radius of the indenter [mm]", above_zero)
        tip = work.settle(
            where, "rod.tip", None, "tip of the indenter: flat or hemisphere", one_of(("flat", "hemisphere"))
        )
        rod = {"radius_mm": radius, "tip": tip}
    else:
        rod = entry.rod.model_dump()
    surfaces = [_surface(work, s, where, k) for k, s in enumerate(entry.surfaces, 1)]
    record = open_record(work, entry)  # after what does not hang on it
    time = record.time(needed=True)
    assert time is not None
    kinds: tuple[Quantity, ...] = ("displacement", "force")
    columns = []
    for kind in kinds:
        column = record.column(kind)
        if column is None:
            raise record.error(f"expected a column of {kind} (columns: {{{kind}: NAME}} says which it is)")
        columns.append(column)
    raw = record.si(columns[0], "displacement")
    pull = record.towards_tension(columns[0], raw)
    depth = -pull * record.zeroed(columns[0], raw, "where the indenter touches")
    force = record.si(columns[1], "force") - entry.force_zero_N
    if entry.force_positive is not None:
        force = force if entry.force_positive == "compression" else -force
    else:
        force = force * record.force_sign(force, depth)
    name = f"pokes/{entry.id}.csv"
    work.tables[name] = csv_text({"time_s": time, "depth_mm": depth * 1e3, "force_N": force})
    trial: dict[str, Any] = {"block_mm": list(block), "rod": rod}
    if entry.inclusion is not None:
        trial["inclusion"] = entry.inclusion.model_dump(exclude_none=True)
        if entry.inclusion.mesh is not None:
            path = work.source(entry.inclusion.mesh, f"{where}.inclusion.mesh")
            trial["inclusion"] = {"mesh": work.copy(path, "meshes")}
    trial["start_mm"] = list(
        work.settle(
            where,
            "start_mm",
            _listed(entry.start_mm),
            "place of the tip when it touches: x, y from the middle, z from the base [mm]",
            numbers(3),
            default=[0.0, 0.0, float(block[2])],
            why="the middle of the top",
        )
    )
    trial["direction"] = list(
        work.settle(
            where,
            "direction",
            _listed(entry.direction),
            "direction of the push: x, y, z, with z below 0",
            numbers(3),
            default=[0.0, 0.0, -1.0],
            why="straight down",
        )
    )
    trial["record"] = name
    if entry.force_sd_N is not None:
        trial["force_sd_N"] = entry.force_sd_N
    else:
        work.defaults.append(f"{where}.force_sd_N left out (estimated from the scatter of the curve)")
    trial["depth_sd_mm"] = work.settle_sd(
        where,
        "depth_sd_mm",
        entry.depth_sd_mm,
        "a depth [mm]",
        _DEPTH_SD,
        "of a crosshead and the first touch",
    )
    if surfaces:
        trial["surfaces"] = surfaces
    radius_m = float(rod["radius_mm"]) * 1e-3
    return trial, Push(depth=depth, force=force, time=time, radius=radius_m, height=float(block[2]) * 1e-3)


def _surface(work: Work, surface: SurfaceAnswers, where: str, number: int) -> dict[str, Any]:
    place = f"{where}.surfaces[#{number}]"
    return {
        "time_s": work.settle(
            place, "time_s", surface.time_s, "time of the scan on the record's clock [s]", zero_or_more
        ),
        "points": work.copy(work.source(surface.points, f"{place}.points"), "surfaces"),
        "point_sd_mm": work.settle(
            place,
            "point_sd_mm",
            surface.point_sd_mm,
            "standard deviation of a scanned point [mm]",
            above_zero,
            help=SD,
        ),
    }


def _listed(values: tuple[float, ...] | None) -> list[float] | None:
    return None if values is None else list(values)
