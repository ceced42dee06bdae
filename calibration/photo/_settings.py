"""`photographs.yaml`: what a lab may add about its photographs; optional, beside experiment.yaml."""

from __future__ import annotations

from pathlib import Path

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from calibration.errors import InputError

NAME = "photographs.yaml"


class PhotoSettings(BaseModel):
    """Positions in the specimen's frame (x out of the clamp face, z up, y away from the camera).

    board_corner_mm: x, z of the lower left outer corner of the squares; without it x = 0 is found at the
        clamp's face and z = 0 on the beam's axis there.
    board_distance_mm: y of the board; without it half the section's width (the specimen touches the board).
    board_roll_sd_deg: how level the board hangs. square_sd: relative, of the printed squares.
    clamp_front_mm, clamp_back_mm: y of the clamp's edges towards and away from the camera; back: the board.
    calibration_photos: further photographs of the same board by the same camera, from other directions.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    board_corner_mm: tuple[float, float] | None = None
    board_corner_sd_mm: float = Field(default=0.1, ge=0)
    board_distance_mm: float | None = Field(default=None, gt=0)
    board_distance_sd_mm: float = Field(default=0.5, ge=0)
    board_roll_sd_deg: float = Field(default=0.1, ge=0)
    square_sd: float = Field(default=0.001, ge=0, lt=0.1)
    clamp_front_mm: float | None = Field(default=None, lt=0)
    clamp_back_mm: float | None = Field(default=None, gt=0)
    calibration_photos: tuple[str, ...] = ()


def read_settings(folder: Path) -> PhotoSettings:
    """The settings of an experiment's folder; defaults where it has no photographs.yaml.

    Raises InputError naming the file and the key.
    """
    path = folder / NAME
    if not path.exists():
        return PhotoSettings()
    try:
        raw = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: expected YAML: {' '.join(str(error).split())}") from None
    if raw is None:
        raw = {}
    if not isinstance(raw, dict):
        raise InputError(f"{path}: expected keys and values")
    try:
        return PhotoSettings.model_validate(raw)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {key}: {first['msg']}") from None
