"""Fits that calibration.fit has written, whatever its options were, as long as they are of the same data."""

from __future__ import annotations

import json
from pathlib import Path

from calibration.errors import InputError
from calibration.experiment import Experiment
from calibration.study import Calibration
from tisim import laws


def fits_folder(folder: Path) -> Path:
    """The folder of fits in what was given: calibration.fit's OUT, or OUT/fits itself.

    InputError where neither holds a fit, finished or begun.
    """
    if not folder.is_dir():
        raise InputError(f"--fits {folder}: expected a folder that calibration.fit wrote")
    for place in (folder / "fits", folder):
        if place.is_dir() and any(p.suffix in (".json", ".jsonl") for p in place.iterdir()):
            return place
    raise InputError(
        f"--fits {folder}: expected a folder that calibration.fit wrote, with fits/MATERIAL-LAW.json in it"
    )


def read_fit(folder: Path, experiment: Experiment, material: str, label: str) -> Calibration | None:
    """The finished fit of a law, None where there is none.

    InputError where the file is no fit, or one of other data, another material or another law.
    """
    path = folder / f"{material}-{label}.json"
    if not path.exists():
        return None
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        digest = data["header"]["data"]
        fit = Calibration.from_json(data["calibration"])
        if fit.parameters:
            laws.get(fit.law).check(fit.parameters)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{path}: expected a fit that calibration.fit wrote ({type(error).__name__}: {error})"
        ) from error
    if digest != experiment.digest:
        raise InputError(
            f"{path}: header.data: expected a fit of {experiment.folder}, this one is of other or older data"
        )
    if (fit.material, fit.label) != (material, label):
        raise InputError(f"{path}: expected {label} of {material}, it holds {fit.label} of {fit.material}")
    return fit
