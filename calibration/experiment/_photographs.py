"""photographs.yaml, beside experiment.yaml: where the board hangs behind photographed beams."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from calibration.experiment._fields import Coordinate, Doubt, Length, Strict
from calibration.experiment._yaml import load, parse

PHOTOGRAPHS = "photographs.yaml"


class PhotoSettings(Strict):
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

    board_corner_mm: tuple[Coordinate, Coordinate] | None = None
    board_corner_sd_mm: Doubt = 0.1
    board_distance_mm: Length | None = None
    board_distance_sd_mm: Doubt = 0.5
    board_roll_sd_deg: Annotated[float, Field(ge=0, le=90)] = 0.1
    square_sd: Annotated[float, Field(ge=0, lt=0.1)] = 0.001
    clamp_front_mm: Annotated[Coordinate, Field(lt=0)] | None = None
    clamp_back_mm: Length | None = None
    calibration_photos: tuple[str, ...] = ()


def read_photo_settings(folder: Path) -> PhotoSettings:
    """The settings of an experiment's folder; defaults where it has no photographs.yaml.

    Raises InputError naming the file and the key.
    """
    path = folder / PHOTOGRAPHS
    if not path.exists():
        return PhotoSettings()
    content = path.read_bytes()
    return PhotoSettings() if load(content, path) is None else parse(content, path, PhotoSettings)
