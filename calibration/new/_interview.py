"""The first questions at a terminal: what each file is, of which material, and how the trials are called."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import typer

from calibration.errors import InputError
from calibration.lab_files import LabTest, read_lab_file
from calibration.new._asking import one_of, prompted

_PHOTOS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")
_TABLES = {
    "outline": {"side", "x_mm", "z_mm"},
    "markers": {"marker", "time_s", "ux_mm", "uy_mm", "uz_mm"},
}
_OF_BEAMS = ("photo", *_TABLES)


def interview(files: list[Path], name: str, raw: dict[str, Any]) -> None:
    """Fill answers with the trials of these files, each with id, kind, file and material.

    Parameters
    ----------
    files : list of Path
        Photographs, traced outlines (side, x_mm, z_mm), displacements of markers (marker, time_s, ux_mm,
        uy_mm, uz_mm), records of machines.
    name : str
        Proposed for the experiment.
    raw : dict
        Takes the answers as they are given.

    Raises
    ------
    InputError
        A file is missing, of which nothing is asked before, or cannot be read.
    """
    for file in files:
        if not file.is_file():
            raise InputError(f"{file}: expected a file, there is none")
    raw |= {"name": _text("name of the experiment", name), "materials": {}, "trials": []}
    material: str | None = None
    for file in files:
        kind = _sort(file)
        if kind is None:
            format, tests = read_lab_file(file)
            typer.echo(describe(file, format, tests))
            kind = _choice(
                "what is it: coupon (a homogeneous test) or poke (an indentation)", ("coupon", "poke")
            )
        trial: dict[str, Any] = {"id": _name(raw, file, kind)}
        old = next((t for t in raw["trials"] if t["id"] == trial["id"]), None)
        if old is not None:
            _add(old, kind, file)
            continue
        material = _text(f"{trial['id']}: name of the material", material)
        trial |= {"kind": kind if kind in ("coupon", "poke") else "beam", "material": material}
        if trial["kind"] == "beam":
            _add(trial, kind, file)
        else:
            trial["file"] = str(file.absolute())
        raw["trials"].append(trial)


def _add(beam: dict[str, Any], kind: str, file: Path) -> None:
    """Add a file of a beam to its answers."""
    if kind == "markers":
        beam[kind] = str(file.absolute())
    else:
        beam.setdefault("captures", []).append({kind: str(file.absolute())})


def _takes(trial: dict[str, Any], kind: str) -> bool:
    """True if a trial may have a further file of this kind."""
    return trial["kind"] == "beam" and kind in _OF_BEAMS and not (kind == "markers" and kind in trial)


def _sort(file: Path) -> str | None:
    """photo, outline, markers, or None for a record."""
    if file.suffix.lower() in _PHOTOS:
        return "photo"
    with file.open("rb") as content:
        head = content.readline(400).decode("utf-8", errors="replace")
    names = {c.strip() for c in head.lstrip("\ufeff").split(",")}
    return next((kind for kind, columns in _TABLES.items() if names == columns), None)


def _name(raw: dict[str, Any], file: Path, kind: str) -> str:
    """An id: of a new trial, or of the beam that a further photograph or table shows."""
    stem = re.sub(r"[^\w .,+()%-]", "-", file.stem).strip(" .,+()%-")[:80] or "trial"
    beams = [t["id"] for t in raw["trials"] if _takes(t, kind)]
    also = f" (of the same beam: {', '.join(beams)})" if beams else ""
    while True:
        text = _text(f"{file.name}: id of the trial{also}", stem)
        taken = {t["id"] for t in raw["trials"]}
        if not re.fullmatch(r"\w[\w .,+()%-]{0,99}", text):
            typer.echo("  expected letters, digits and . , + - _ ( ) %")
        elif text in taken and text not in beams:
            typer.echo(f"  {text} is taken")
        else:
            return text


def _text(label: str, default: str | None) -> str:
    return prompted(label, default)


def _choice(label: str, words: tuple[str, ...]) -> str:
    read = one_of(words)
    while True:
        try:
            return read(prompted(label))
        except ValueError as error:
            typer.echo(f"  {error}")


def describe(file: Path, format: str, tests: tuple[LabTest, ...]) -> str:
    """Lines on a file as an importer reads it: format, tests, columns with their quantities, parameters."""
    lines = [f"{file}: {format}, {len(tests)} test{'s' if len(tests) > 1 else ''}"]
    for number, test in enumerate(tests, 1):
        lines.append(f"  {number}: {test.name or 'the only test'}, {len(test.rows)} rows")
        for column in test.columns:
            if column.header:
                unit = "no unit" if column.unit is None else column.unit.text
                lines.append(f"     {column.header} ({unit}): {column.quantity or 'not used'}")
    for name, text in list(tests[0].parameters.items())[:40]:
        lines.append(f"  {name}: {text}")
    return "\n".join(lines)
