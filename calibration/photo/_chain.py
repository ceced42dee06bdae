"""Reconstruction of one capture, and the ledger by which a later run keeps finished ones."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from calibration._files import write_whole
from calibration.experiment import PhotoSettings
from calibration.experiment.model import BeamTrial, Capture, Registration, TracedOutline
from calibration.photo._board import Board
from calibration.photo._camera import Camera
from calibration.photo._files import centreline_csv, outline_csv, outline_name, png, stl
from calibration.photo._image import Grey, read_photograph
from calibration.photo._picture import strip
from calibration.photo._trace import Specimen, trace
from calibration.shape import centreline, sweep

VERSION = 3  # raised when the same photograph would be traced differently
LEDGER = ".reconstruct"
REPORT = "reconstruct.json"
_SOURCE = f"{LEDGER}/experiment.json"


@dataclass(frozen=True, eq=False, kw_only=True)
class Job:
    """One capture: its name is that of all files made from it."""

    name: str
    trial: BeamTrial
    number: int
    capture: Capture

    @property
    def traced(self) -> bool:
        """It came as an outline: the chain starts at the mid line."""
        return self.capture.outline is not None


def note_source(out: Path, experiment: Path, name: str) -> None:
    """Notes in the folder that is written which experiment is traced there."""
    noted = {"name": name, "folder": str(experiment.resolve())}
    write_whole(out / _SOURCE, json.dumps(noted, indent=1))


def other_source(out: Path, experiment: Path, name: str) -> str | None:
    """Name and folder of the experiment that is traced in a folder, None if it is this one or none is noted.

    The same folder is the same experiment, also under another name; so is one of the same name whose folder
    is no longer there: it was moved. Before 2026-11-28 only the name of its folder was noted, at the end.
    """
    try:
        noted = json.loads((out / _SOURCE).read_text(encoding="utf-8"))
        folder, known = Path(noted["folder"]), str(noted["name"])
    except FileNotFoundError:
        return _earlier_source(out, experiment)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    moved = known == name and not (folder / "experiment.yaml").exists()
    return None if moved or folder == experiment.resolve() else f"{known!r} of {folder}"


def _earlier_source(out: Path, experiment: Path) -> str | None:
    try:
        known = str(json.loads((out / REPORT).read_text(encoding="utf-8"))["experiment"])
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return None if known == experiment.resolve().name else f"of a folder {known}"


def digest(job: Job, board: Board | None, camera: Camera | None, settings: PhotoSettings) -> str:
    """sha256 over all that the files of this capture depend on."""
    total = hashlib.sha256(f"{VERSION}".encode())
    trial, capture = job.trial, job.capture
    facts = (trial.section, trial.section_sd, trial.free_length, trial.supports, settings, camera)
    total.update(repr(facts).encode())
    if capture.outline is not None:
        for array in (capture.outline.upper, capture.outline.lower):
            total.update(np.ascontiguousarray(array).tobytes())
        given = capture.outline
        total.update(repr((given.sd, given.correlation, given.registration, given.shared)).encode())
    if capture.photo is not None and not job.traced:
        total.update(hashlib.sha256(capture.photo.read_bytes()).digest())
        total.update(repr((capture.photo.name, capture.checkerboard, capture.registration)).encode())
        assert board is not None
        total.update(np.ascontiguousarray(board.corners).tobytes())
    return total.hexdigest()


def kept(out: Path, job: Job, key: str) -> dict[str, Any] | None:
    """The figures of a capture that is already done with the same inputs and whose files are all there."""
    path = out / LEDGER / f"{job.name}.json"
    try:
        entry = json.loads(path.read_text(encoding="utf-8"))
        if entry["key"] != key:
            return None
        for name, known in entry["files"].items():
            if hashlib.sha256((out / name).read_bytes()).hexdigest() != known:
                return None
        figures = entry["figures"]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return figures if isinstance(figures, dict) else None


def run(
    out: Path, job: Job, key: str, board: Board | None, camera: Camera | None, settings: PhotoSettings
) -> dict[str, Any]:
    """Traces, extracts, sweeps and writes one capture; its figures. Raises InputError (PhotoProblem)."""
    trial, capture = job.trial, job.capture
    files: dict[str, bytes] = {}
    figures: dict[str, Any] = {}
    image: Grey | None = None
    found = None
    if capture.outline is not None:
        outline = capture.outline
    else:
        assert capture.photo is not None
        assert board is not None
        assert camera is not None
        image = read_photograph(capture.photo)
        found = trace(image, board, camera, specimen_of(trial), settings)
        outline = _with_registration(found.outline, capture.registration)
        files[outline_name(job.name)] = outline_csv(outline)
        figures |= {
            "photo": capture.photo.name,
            "photo_sha256": hashlib.sha256(capture.photo.read_bytes()).hexdigest(),
            "mm_per_pixel": found.metres_per_pixel * 1e3,
            "tilt_deg": float(np.degrees(found.tilt)),
            "camera_distance_mm": found.camera_distance * 1e3,
            "diameter_mm": found.diameter * 1e3,
            "focal_px": found.focal,
            "corner_noise_px": found.corner_noise,
            "edge_blur_px": board.blur,
            "camera": asdict(camera),
        }
    line = centreline(outline, supports=trial.supports, free_length=trial.free_length)
    body = sweep(line, trial.section)
    figures |= {
        "outline_sd_mm": outline.sd * 1e3,
        "outline_correlation_mm": outline.correlation * 1e3,
        "registration_sd": _as_in_files(outline.registration),
        "registration_shared_sd": _as_in_files(outline.shared),
        "length_mm": line.length * 1e3,
        "centreline_sd_mm": None if line.sd is None else float(np.sqrt(np.mean(line.sd**2))) * 1e3,
        "volume_mm3": float(body.volume) * 1e9,
    }
    files[f"centrelines/{job.name}.csv"] = centreline_csv(line)
    files[f"meshes/{job.name}.stl"] = stl(body)
    if image is not None and found is not None:
        files[f"pictures/{job.name}.png"] = png(strip(image, found, body))
    for name, content in files.items():
        write_whole(out / name, content)
    sums = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    entry = {"key": key, "files": sums, "figures": figures}
    write_whole(out / LEDGER / f"{job.name}.json", json.dumps(entry, indent=1).encode())
    return figures


def specimen_of(trial: BeamTrial) -> Specimen:
    """Data of a beam for tracing; section_sd holds the radius's or (width's, height's)."""
    sd = trial.section_sd
    height_sd = 2 * sd[0] if len(sd) == 1 else sd[1]
    return Specimen(
        section=trial.section, section_sd=height_sd, free_length=trial.free_length, supports=trial.supports
    )


def _with_registration(outline: TracedOutline, stated: Registration | None) -> TracedOutline:
    """The outline with the lab's stated registration error added to the photograph's own."""
    if stated is None:
        return outline
    return replace(outline, registration=outline.registration.plus(stated))


def _as_in_files(error: Registration) -> dict[str, float]:
    return {
        "shift_mm": error.shift * 1e3,
        "roll_deg": float(np.degrees(error.roll)),
        "scale": error.scale,
    }
