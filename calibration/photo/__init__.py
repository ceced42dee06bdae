"""From a photograph to a traced outline: board, lens, silhouette, frame, each with its uncertainty.

    camera = calibrate([find_board(image, checkerboard) for image in images])
    trace(image, board, camera, specimen, settings).outline

How it has to be photographed (`docs/how-to/photograph.md` for the lab):

- The camera stands before the beam, x to the right, z up; the board hangs behind it, parallel to the plane
  y = 0, its first side along x, whole in the picture and not covered. The rear of the specimen touches the
  board's plane (y = half the section's width) unless `photographs.yaml` gives board_distance_mm.
- x = 0 is the clamp's face, found from the clamp's vertical edges above and below the beam; seen from the
  right of the face the edge that shows is its rear one, in the board's plane (or at clamp_back_mm). z = 0 is
  the beam's axis where it leaves the clamp. With board_corner_mm in `photographs.yaml` (lower left outer
  corner of the squares in the specimen's frame) the board gives both, and the clamp need not show.
- The directions of x and z are the board's own; how level it hangs is the roll's standard deviation.

Board frame inside this package [m]: x right, z up, y away from the camera, origin at the board's lower left
outer corner; the specimen's mid plane lies at y = -distance.
"""

from calibration.experiment import PhotoSettings
from calibration.photo._board import Board, find_board
from calibration.photo._camera import Camera, View, calibrate, locate
from calibration.photo._image import PhotoProblem, read_photograph
from calibration.photo._picture import strip
from calibration.photo._trace import Specimen, Trace, trace

__all__ = [
    "Board",
    "Camera",
    "PhotoProblem",
    "PhotoSettings",
    "Specimen",
    "Trace",
    "View",
    "calibrate",
    "find_board",
    "locate",
    "read_photograph",
    "strip",
    "trace",
]
