"""Names of files, and files written in one piece."""

from __future__ import annotations

import unicodedata
from pathlib import Path

from calibration.errors import InputError
from tisim.io.whole import whole_name, write_whole


def on_any_disk(name: str) -> str:
    """The name without letter case and Unicode form: on some disks, names equal in this are one file."""
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def check_no_experiment(folder: Path) -> None:
    """InputError for a folder that holds an experiment: results there would stand among what was measured."""
    if (folder / "experiment.yaml").exists():
        raise InputError(f"--out {folder}: holds an experiment: expected another folder for the results")


__all__ = ["check_no_experiment", "on_any_disk", "whole_name", "write_whole"]
