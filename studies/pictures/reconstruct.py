"""Makes docs/pictures/reconstruct.png, one photograph's way:  python -m studies.pictures.reconstruct

The photograph is rendered by the blind laboratory's camera, 25 degrees off the board's normal, through a
lens that distorts.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

import tisim
from benchmarks.blind.camera import Lens, Setting, Tube, View, photograph
from calibration.experiment import Checkerboard
from calibration.photo import PhotoSettings, Specimen, calibrate, find_board, strip, trace
from calibration.shape import centreline, sweep

ROOT = Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs" / "pictures" / "reconstruct.png"


def hanging(length: float = 100.0, turn_deg: float = 28.0) -> NDArray[np.float64]:
    """Axis of a cantilever that turns down by `turn_deg`, (k, 2) [mm]."""
    s = np.linspace(0.0, length, 4001)
    angle = -np.radians(turn_deg) * (1.0 - (1.0 - s / length) ** 3)
    step = np.diff(s, prepend=0.0)
    middle = np.concatenate([[0.0], 0.5 * (angle[1:] + angle[:-1])])
    return np.column_stack([np.cumsum(step * np.cos(middle)), np.cumsum(step * np.sin(middle))])


def main() -> None:
    """A hanging beam of 100 mm, its clamp and board, seen from the right and slightly from above."""
    beam = Tube(axis=hanging(), radius=10.0)
    image = photograph(Setting(tubes=(beam,)), Lens(k1=-0.3), View(yaw=23.0, pitch=10.0, roll=-2.0))
    board = find_board(image, Checkerboard(squares=(9, 6), square=0.008))
    specimen = Specimen(
        section=tisim.Circle(radius=0.010), section_sd=1e-4, free_length=0.100, supports="clamped-free"
    )
    found = trace(image, board, calibrate([board]), specimen, PhotoSettings())
    line = centreline(found.outline, supports="clamped-free", free_length=0.100)
    picture = strip(image, found, sweep(line, specimen.section))
    PICTURE.parent.mkdir(exist_ok=True)
    smaller = cv2.resize(picture, None, fx=0.7, fy=0.7, interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(PICTURE), smaller, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    print(f"{PICTURE.relative_to(ROOT)}: length {line.length * 1e3:.2f} mm of 100")


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter).parse_args()
    main()
