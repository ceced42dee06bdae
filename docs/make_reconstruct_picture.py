"""Makes docs/pictures/reconstruct.png, one photograph's way:  python docs/make_reconstruct_picture.py

The photograph is rendered by the tests' own camera, 25 degrees off the board's normal, through a lens that
distorts.
"""

import sys
from pathlib import Path

import cv2

import tisim
from calibration.experiment import Checkerboard
from calibration.photo import PhotoSettings, Specimen, calibrate, find_board, strip, trace
from calibration.shape import centreline, sweep

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs" / "pictures" / "reconstruct.png"
sys.path.insert(0, str(ROOT / "tests" / "calibration" / "photo"))

from photo_cases import hanging  # noqa: E402
from photo_render import Lens, Setting, Tube, View, photograph  # noqa: E402


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
    main()
