"""photographs.yaml, beside experiment.yaml: where the board hangs behind photographed beams."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from calibration.errors import InputError
from calibration.experiment._yaml import load

PHOTOGRAPHS = "photographs.yaml"


class PhotoSettings(BaseModel):
    """photographs.yaml: positions in the specimen's frame (x out of the clamp face, z up, y from the camera).

    Attributes
    ----------
    board_corner_mm : tuple, optional
        x, z of the lower left outer corner of the squares; without it x = 0 is found at the clamp's face and
        z = 0 on the beam's axis there.
    board_distance_mm : float, optional
        y of the board; half the section's width (the specimen touches the board) where left out.
    board_corner_sd_mm, board_distance_sd_mm, board_roll_sd_deg : float
        Standard deviations; the last is of how level the board hangs.
    square_sd : float
        Relative standard deviation of the printed squares.
    clamp_front_mm, clamp_back_mm : float, optional
        y of the clamp's edges towards and away from the camera; the board's where the latter is left out.
    calibration_photos : tuple of str
        Further photographs of the same board by the same camera, from other directions.
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


def read_photo_settings(folder: Path) -> PhotoSettings:
    """The settings of an experiment's folder; defaults where it has no photographs.yaml.

    Raises InputError naming the file and the key.
    """
    path = folder / PHOTOGRAPHS
    if not path.exists():
        return PhotoSettings()
    raw = load(path.read_bytes(), path)
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
