"""One photograph from the board to the traced outline in the specimen's frame, with its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_lsq_spline

from calibration._numerics import arc_length
from calibration.experiment import PhotoSettings
from calibration.experiment.model import Registration, Supports, TracedOutline
from calibration.photo._board import Board
from calibration.photo._camera import Camera, View, locate
from calibration.photo._contour import Contour, trace_contour
from calibration.photo._foreground import Body, Foreground, find_body, lay_out, segment, show_body
from calibration.photo._frame import Face, Scale, axis_height, find_face, settle
from calibration.photo._image import Grey, PhotoProblem
from calibration.photo._silhouette import Edges, Section, to_plane

Array = NDArray[np.float64]

_KNOTS = 0.010  # [m]: a beam bends smoothly over that


def edge_noise(points: Array) -> tuple[float, float]:
    """sd [m] across an edge (k, 2) [m] about a smooth line, and Gaussian correlation length [m] along it."""
    s = arc_length(points)
    inner = np.linspace(0.0, s[-1], max(int(s[-1] / _KNOTS), 1) + 1)[1:-1]
    knots = np.concatenate([[0.0] * 4, inner, [s[-1]] * 4])
    line = make_lsq_spline(s, points, knots, k=3)
    along = line.derivative()(s)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    off = points - line(s)
    left = along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]
    sd = float(np.sqrt((left**2).sum() / max(len(s) - len(knots) + 4, 1)))
    step = float(np.diff(s).mean())
    lags = np.arange(1, max(2, min(len(s) // 4, int(0.5 * _KNOTS / step))))
    variance = float((left**2).mean())
    if variance == 0.0:
        return 0.0, step
    together = np.array([(left[k:] * left[:-k]).mean() for k in lags]) / variance
    below = np.flatnonzero(together < np.exp(-0.5))
    return sd, float(lags[below[0] if len(below) else -1] * step)


_SPACING = 1e-3  # [m]
_SLOW = 0.010  # [m] over which an error of lens or shading holds on


def stated_error(noise: float, length: float, slow: float) -> tuple[float, float]:
    """One Gaussian covariance in place of two: sd [m] and correlation length [m] of an outline's error.

    The contour errs twice along its arc length s: by the grey values' noise, whose sd is a, correlated over
    l < 1 mm, and by lens and shading, sd b, which hold on over L = 10 mm (`_SLOW`). The experiment's format
    has one Gaussian kernel for both. A kernel v exp(-s^2 / (2 c^2)) has the spectral density

        S(k) = sqrt(2 pi) v c exp(-k^2 c^2 / 2)

    and the two errors have the sum of theirs. With c = l and

        v = (a^2 l + b^2 L) / l

    the statement equals that sum for k -> 0 and lies above it for all other k, since L > l. So it is right
    for waves much longer than L, which a material's constants move (a beam's deflection has the waves of its
    first three or four polynomials), and cautious for shorter ones. The opposite choice, c between l and L
    with v = a^2 + b^2, denies the noise: it puts neighbouring points 1 mm apart within a fiftieth of v of
    each other, and chi-square per point came out between 70 and 700.

    Points stand `_SPACING` apart. Where l is below half of that, c is half of that: a shorter c would make
    them independent, of density v `_SPACING` above the one meant.

    Parameters
    ----------
    noise, length : float
        a and l [m], see `edge_noise`.
    slow : float
        b [m].
    """
    correlation = max(length, 0.5 * _SPACING)
    return float(np.sqrt((noise**2 * length + slow**2 * _SLOW) / correlation)), float(correlation)


def sample(
    edges: Edges, contour: Contour, origin: Array, registration: Registration, *, camera_error: float
) -> TracedOutline:
    """Points about 1 mm apart by local straight lines, ending at a free end's corners; specimen's frame [m].

    camera_error [m]: what the board's corners miss the camera's model by: it holds no better elsewhere.
    """
    lines = (edges.upper.outline - origin, edges.lower.outline - origin)
    upper, lower = (_thin(line) for line in lines)
    upper_noise, lower_noise = (edge_noise(line) for line in lines)
    if edges.end is not None:
        upper, lower = (
            np.vstack([line, corner - origin]) for line, corner in zip((upper, lower), edges.end, strict=True)
        )
    noise = float(np.sqrt(np.mean(np.square([upper_noise[0], lower_noise[0]]))))
    length = 0.5 * (upper_noise[1] + lower_noise[1])
    # half of what two definitions of an edge disagree by
    doubt = 0.5 * float(np.sqrt(np.median(contour.half**2))) * contour.metres_per_pixel
    sd, correlation = stated_error(noise, length, float(np.hypot(doubt, camera_error)))
    return TracedOutline(upper=upper, lower=lower, sd=sd, correlation=correlation, registration=registration)


def _thin(line: Array) -> Array:
    """A point every millimetre, each by a straight line through its own millimetre."""
    s = arc_length(line)
    count = max(int(s[-1] / _SPACING), 2)
    at = np.linspace(0.0, s[-1], count + 1)
    half = 0.5 * s[-1] / count
    points = np.empty((len(at), 2))
    for k, centre in enumerate(at):
        near = np.abs(s - centre) <= half
        if near.sum() < 4:
            near = np.zeros(len(s), bool)
            near[np.argsort(np.abs(s - centre))[:4]] = True
        for axis in range(2):
            points[k, axis] = np.polyfit(s[near] - centre, line[near, axis], 1)[1]
    return points


_CLEAR = 0.0006  # left out of the contour next to a clamp [m], and as many pixels as blur reaches
_BLUR_PIXELS = 7.0
_WRONG_SIZE = 0.12  # a diameter off by more than that part is another specimen or another board
_CONTRADICTS = 5.0  # standard deviations between the diameter seen and the one known: one of them is wrong
_ROLL_SD = np.radians(0.02)  # of the board's direction in one photograph


@dataclass(frozen=True, eq=False, kw_only=True)
class Specimen:
    """A beam as the lab describes it.

    Attributes
    ----------
    section : tisim.Circle or tisim.Rectangle
    section_sd : float
        Standard deviation of its height [m].
    free_length : float
        [m]
    supports : str
    """

    section: Section
    section_sd: float
    free_length: float
    supports: Supports


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """A traced photograph.

    Attributes
    ----------
    outline : TracedOutline
        Outline in the specimen's frame, with its uncertainty.
    metres_per_pixel : float
        Scale at the specimen.
    tilt : float
        Angle of the camera's axis to the board's normal [rad].
    camera_distance : float
        Distance to the specimen's plane [m].
    diameter : float
        Diameter as measured in the photograph [m].
    corner_noise : float
        Standard deviation of the board's corners about the camera's model [px].
    focal : float
        Focal length [px].
    origin : tuple
        x, z of the specimen's frame in the board's [m].
    board, view, plane, contour, face
        For pictures.
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
    """Trace one photograph.

    Raises
    ------
    PhotoProblem
        It cannot be used: a sentence, and a picture of what was found.
    """
    section = specimen.section
    touching = section.half_width
    distance = touching if settings.board_distance_mm is None else settings.board_distance_mm * 1e-3
    view = locate(board, camera)
    found = segment(image, board, view)
    body = _body(image, found, view, specimen, settings, distance)
    contour = _contour(image, found, body, view, specimen, settings, distance)

    def edges(focal: float, away: float) -> Edges:
        return to_plane(locate(board, camera.with_focal(focal)), contour, section, plane=-away)

    height, height_sd = 2 * section.half_height, specimen.section_sd
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
    off_sd = float(np.hypot(scale.off_sd, settings.square_sd * height))
    if abs(scale.off) > _CONTRADICTS * off_sd:
        raise PhotoProblem(
            f"the specimen looks {(height - scale.off) * 1e3:.2f} mm high, its section says"
            f" {height * 1e3:.2f} mm, and what is known of both lets them differ by {off_sd * 1e3:.2g} mm"
            " (sd): expected another section, or a larger sd of it, or squares of another size on the board",
            show_body(image, found, body.label),
        )
    view = locate(board, camera.with_focal(scale.focal))
    plane = -scale.distance
    body = _body(image, found, view, specimen, settings, scale.distance)  # its clamp has moved with the scale
    both = to_plane(view, contour, section, plane=plane)
    origin, shift_sd, face = _origin(image, found, body, view, both, specimen, settings, scale)
    # the board, where it is mounted, and the lens are the same in all photographs
    registration = Registration(shift=0.0 if face is None else shift_sd, roll=float(_ROLL_SD))
    shared = Registration(
        shift=shift_sd if face is None else 0.0,
        roll=float(np.radians(settings.board_roll_sd_deg)),
        scale=float(np.hypot(scale.sd, settings.square_sd)),
    )
    return Trace(
        outline=replace(
            sample(both, contour, origin, registration, camera_error=camera.noise * contour.metres_per_pixel),
            shared=shared,
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
    height = 2 * specimen.section.half_height
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
        height=2 * specimen.section.half_height,
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
        corner = -1e-3 * np.array(settings.board_corner_mm)
        height = 2 * specimen.section.half_height
        off = axis_height(both, float(corner[0]), height)[0] - float(corner[1])
        if abs(off) > 0.5 * height:
            raise PhotoProblem(
                f"the specimen leaves the clamp at z = {off * 1e3:.3g} mm of its frame, expected 0:"
                " board_corner_mm has another sign or is of another corner, or the picture is upside down",
                show_body(image, found, body.label),
            )
        return corner, settings.board_corner_sd_mm * 1e-3, None
    assert body.near is not None
    plane = -scale.distance
    back = plane + settings.clamp_back_mm * 1e-3 if settings.clamp_back_mm is not None else 0.0
    front = plane + settings.clamp_front_mm * 1e-3 if settings.clamp_front_mm is not None else None
    face = find_face(image, found, body.label, view, body.near, plane=plane, front=front, back=back)
    z, z_sd = axis_height(both, face.x, 2 * specimen.section.half_height)
    return np.array([face.x, z]), float(np.sqrt(0.5 * (face.sd**2 + z_sd**2))), face
