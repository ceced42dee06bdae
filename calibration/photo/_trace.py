"""One photograph from the board to the traced outline in the specimen's frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.experiment.model import Registration, Supports, TracedOutline
from calibration.photo._board import Board
from calibration.photo._body import Body, find_body, lay_out, show_body
from calibration.photo._camera import Camera
from calibration.photo._contour import Contour, trace_contour
from calibration.photo._edges import Edges, to_plane
from calibration.photo._face import Face, find_face
from calibration.photo._image import Grey
from calibration.photo._origin import axis_height
from calibration.photo._outline import sample
from calibration.photo._problem import PhotoProblem
from calibration.photo._scale import Scale, settle
from calibration.photo._segment import Foreground, segment
from calibration.photo._settings import PhotoSettings
from calibration.photo._silhouette import Section, half_height, half_width
from calibration.photo._view import View, locate

Array = NDArray[np.float64]

_CLEAR = 0.0006  # left out of the contour next to a clamp [m], and as many pixels as blur reaches
_BLUR_PIXELS = 7.0
_WRONG_SIZE = 0.12  # a diameter off by more than that part is another specimen or another board
_ROLL_SD = np.radians(0.02)  # of the board's direction in one photograph


@dataclass(frozen=True, eq=False, kw_only=True)
class Specimen:
    """What the lab knows of the beam: section, sd of its height [m], free length [m], supports."""

    section: Section
    section_sd: float
    free_length: float
    supports: Supports


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """outline: in the specimen's frame, with what the photograph says about its uncertainty.

    metres_per_pixel at the specimen; tilt [rad] of the camera to the board; camera_distance [m] to the
    specimen's plane; diameter [m] as the photograph shows it; focal [px]; origin: x, z of the specimen's
    frame in the board's [m]; the rest is for pictures.
    """

    outline: TracedOutline
    metres_per_pixel: float
    tilt: float
    camera_distance: float
    diameter: float
    corner_noise: float
    focal: float
    origin: tuple[float, float]
    board: Board = field(repr=False)
    view: View = field(repr=False)
    plane: float
    contour: Contour = field(repr=False)
    face: Face | None = field(repr=False)


def trace(image: Grey, board: Board, camera: Camera, specimen: Specimen, settings: PhotoSettings) -> Trace:
    """Traces one photograph. Raises PhotoProblem with a sentence and a picture where it cannot be used."""
    section = specimen.section
    touching = half_width(section)
    distance = touching if settings.board_distance_mm is None else settings.board_distance_mm * 1e-3
    view = locate(board, camera)
    found = segment(image, board, view)
    body = _body(image, found, view, specimen, settings, distance)
    contour = _contour(image, found, body, view, specimen, settings, distance)

    def edges(focal: float, away: float) -> Edges:
        return to_plane(locate(board, camera.with_focal(focal)), contour, section, plane=-away)

    height, height_sd = 2 * half_height(section), specimen.section_sd
    _check_size(image, found, body, edges(camera.focal, distance).diameter, height)
    scale = settle(
        lambda focal, away: edges(focal, away).diameter,
        diameter=height,
        diameter_sd=height_sd,
        focal=camera.focal,
        focal_sd=camera.focal_sd,
        distance=distance,
        distance_sd=settings.board_distance_sd_mm * 1e-3,
    )
    view = locate(board, camera.with_focal(scale.focal))
    plane = -scale.distance
    body = _body(image, found, view, specimen, settings, scale.distance)  # its clamp has moved with the scale
    both = to_plane(view, contour, section, plane=plane)
    origin, shift_sd, face = _origin(image, found, body, view, both, specimen, settings, scale)
    registration = Registration(
        shift=shift_sd,
        roll=float(np.hypot(np.radians(settings.board_roll_sd_deg), _ROLL_SD)),
        scale=float(np.hypot(scale.sd, settings.square_sd)),
    )
    return Trace(
        outline=sample(
            both, contour, origin, registration, camera_error=camera.noise * contour.metres_per_pixel
        ),
        metres_per_pixel=contour.metres_per_pixel,
        tilt=view.tilt,
        camera_distance=plane - float(view.eye[1]),
        diameter=both.diameter,
        corner_noise=camera.noise,
        focal=scale.focal,
        origin=(float(origin[0]), float(origin[1])),
        board=board,
        view=view,
        plane=plane,
        contour=contour,
        face=face,
    )


def _body(
    image: Grey, found: Foreground, view: View, specimen: Specimen, settings: PhotoSettings, distance: float
) -> Body:
    height = 2 * half_height(specimen.section)
    return find_body(
        image,
        found,
        lay_out(view, found, -distance, step=height / 50),
        height=height,
        length=specimen.free_length,
        far_clamp=specimen.supports == "clamped-clamped",
        clamp_needed=settings.board_corner_mm is None,
    )


def _contour(
    image: Grey,
    found: Foreground,
    body: Body,
    view: View,
    specimen: Specimen,
    settings: PhotoSettings,
    distance: float,
) -> Contour:
    # next to a clamp its own blurred edge is in the way
    pixel = -(float(view.eye[1]) + distance) / view.camera.focal
    clear = _CLEAR + _BLUR_PIXELS * pixel
    starts = [] if body.near is None else [body.near.x + clear]
    stops = [] if body.far is None else [body.far.x - clear]
    if settings.board_corner_mm is not None:
        zero = -settings.board_corner_mm[0] * 1e-3
        starts.append(zero + 2e-4)
        if specimen.supports == "clamped-clamped":
            stops.append(zero + specimen.free_length - 2e-4)
    return trace_contour(
        image,
        found,
        body.label,
        view,
        plane=-distance,
        start=max(starts),
        stop=min(stops) if specimen.supports == "clamped-clamped" else None,
        height=2 * half_height(specimen.section),
    )


def _check_size(image: Grey, found: Foreground, body: Body, seen: float, height: float) -> None:
    # an unknown lens leaves some per cent open, a wrong board far more
    if abs(seen / height - 1) > _WRONG_SIZE:
        raise PhotoProblem(
            f"the specimen looks {seen * 1e3:.1f} mm high, its section says {height * 1e3:.1f} mm: expected "
            "another specimen, or squares of another size on the board",
            show_body(image, found, body.label),
        )


def _origin(
    image: Grey,
    found: Foreground,
    body: Body,
    view: View,
    both: Edges,
    specimen: Specimen,
    settings: PhotoSettings,
    scale: Scale,
) -> tuple[Array, float, Face | None]:
    """x, z of the specimen's frame in the board's [m], their sd [m], the clamp's face where it was used."""
    if settings.board_corner_mm is not None:
        return -1e-3 * np.array(settings.board_corner_mm), settings.board_corner_sd_mm * 1e-3, None
    assert body.near is not None
    plane = -scale.distance
    back = plane + settings.clamp_back_mm * 1e-3 if settings.clamp_back_mm is not None else 0.0
    front = plane + settings.clamp_front_mm * 1e-3 if settings.clamp_front_mm is not None else None
    face = find_face(image, found, body.label, view, body.near, plane=plane, front=front, back=back)
    z, z_sd = axis_height(both, face.x, 2 * half_height(specimen.section))
    return np.array([face.x, z]), float(np.sqrt(0.5 * (face.sd**2 + z_sd**2))), face
