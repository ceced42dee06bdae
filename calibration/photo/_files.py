"""What the chain leaves behind for one photograph, as bytes, and writing that is whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

import cv2
import numpy as np
import trimesh
from numpy.typing import NDArray

from calibration.experiment.model import TracedOutline
from calibration.shape import Centreline


def write_whole(path: Path, content: bytes) -> None:
    """Puts a file in place in one step; a killed run leaves the old one or none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(name).unlink()
        raise


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
