"""Files of a reconstruction: outlines, mid lines, bodies, the traced experiment out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import trimesh
import yaml
from numpy.typing import NDArray

from calibration._files import write_whole
from calibration.errors import InputError
from calibration.experiment import load
from calibration.experiment.model import TracedOutline
from calibration.shape import Centreline


def outline_name(job: str) -> str:
    """Place of an outline that is traced, in the folder that is written."""
    return f"outlines/{job}.csv"


def outline_csv(outline: TracedOutline) -> bytes:
    """FORMAT.md's table: side, x_mm, z_mm."""
    lines = ["side,x_mm,z_mm"]
    for side, points in (("upper", outline.upper), ("lower", outline.lower)):
        lines += [f"{side},{x * 1e3:.4f},{z * 1e3:.4f}" for x, z in points]
    return ("\n".join(lines) + "\n").encode()


def centreline_csv(line: Centreline) -> bytes:
    """Arc length, place, angle, standard deviation across the line, half the height seen."""
    if line.sd is None or line.half_height is None:
        raise ValueError("centreline: expected one fitted to an outline, with sd and half height")
    lines = ["s_mm,x_mm,z_mm,angle_deg,sd_mm,half_height_mm"]
    table = np.column_stack(
        [line.s * 1e3, line.points * 1e3, np.degrees(line.angle), line.sd * 1e3, line.half_height * 1e3]
    )
    lines += [",".join(f"{value:.4f}" for value in row) for row in table]
    return ("\n".join(lines) + "\n").encode()


def stl(body: trimesh.Trimesh) -> bytes:
    """Binary STL, in millimetres."""
    scaled = trimesh.Trimesh(np.asarray(body.vertices) * 1e3, body.faces, process=False)
    return bytes(trimesh.exchange.stl.export_stl(scaled))


def png(picture: NDArray[np.uint8]) -> bytes:
    """A BGR picture as PNG."""
    done, data = cv2.imencode(".png", picture)
    if not done:
        raise OSError("the picture could not be encoded")
    return bytes(data)


_FILE_KEYS = frozenset({"outline", "markers", "record", "points", "mesh"})


def write_copy(
    folder: Path, out: Path, figures: dict[tuple[str, int], dict[str, Any]], names: dict[tuple[str, int], str]
) -> int:
    """experiment.yaml into `out`, and the files it names beside it; the number of captures left out.

    figures, names: of each capture by trial id and number (from 0); a photograph without figures is left out,
    and a beam that has nothing else with it. Raises InputError where nothing would be left.
    """
    raw = load((folder / "experiment.yaml").read_bytes(), folder / "experiment.yaml")
    theirs = named_files(raw)  # and no old file of the folder that has the name of an outline traced now
    dropped, trials = 0, []
    for trial in raw["trials"]:
        captures = trial.get("captures")
        if captures is not None:
            entries = [
                _entry(capture, figures.get((trial["id"], k)), names[trial["id"], k])
                for k, capture in enumerate(captures)
            ]
            dropped += entries.count(None)
            trial["captures"] = [entry for entry in entries if entry is not None]
            if not trial["captures"]:
                del trial["captures"]
                if "markers" not in trial:
                    continue
        trials.append(trial)
    if not trials:
        raise InputError(f"{folder}: no photograph can be used, nothing is left to write")
    raw["trials"] = trials
    if any("photo" in entry for entry in figures.values()):
        origin = f"outlines traced from the photographs of {folder.name}"
        raw["notes"] = f"{raw['notes']}; {origin}" if raw.get("notes") else origin
    for name in sorted(named_files(raw) & theirs):
        source, target = folder / name, out / name
        if not target.resolve().is_relative_to(out.resolve()):
            raise InputError(f"{folder / 'experiment.yaml'}: {name} leads out of the folder")
        if source.exists():
            write_whole(target, source.read_bytes())
    text = yaml.safe_dump(raw, sort_keys=False, allow_unicode=True)
    write_whole(out / "experiment.yaml", text.encode())
    return dropped


def _entry(capture: dict[str, Any], figures: dict[str, Any] | None, name: str) -> dict[str, Any] | None:
    entry = {key: value for key, value in capture.items() if key not in ("photo", "photo_checkerboard")}
    if "outline" in capture:
        return entry
    if figures is None:
        return None
    entry["outline"] = outline_name(name)
    entry["outline_sd_mm"] = round(figures["outline_sd_mm"], 5)
    entry["outline_correlation_mm"] = round(figures["outline_correlation_mm"], 3)
    for key in ("registration_sd", "registration_shared_sd"):
        if key in figures:  # outlines kept from a version before 2026-11-27 have only the first
            entry[key] = {name: round(value, 6) for name, value in figures[key].items()}
    return entry


def named_files(node: Any) -> set[str]:
    """Files named anywhere in the experiment."""
    if isinstance(node, dict):
        own = {value for key, value in node.items() if key in _FILE_KEYS and isinstance(value, str)}
        return own.union(*(named_files(value) for value in node.values())) if node else own
    if isinstance(node, list):
        return set().union(*(named_files(value) for value in node)) if node else set()
    return set()
