"""Outlines traced in rendered photographs against the photographed beams."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import photo_cases as cases
import pytest

import tisim
from benchmarks.blind.camera import Clamp, Lens, Setting, Tube, View, photograph
from calibration.experiment import Checkerboard
from calibration.metrics import dice
from calibration.photo import Board, Camera, PhotoSettings, Specimen, Trace, calibrate, find_board, trace
from calibration.photo._image import PhotoProblem
from calibration.shape import centreline, sweep

BOARD = Checkerboard(squares=(9, 6), square=0.008)
LENS = Lens(size=(1300, 976), focal=3022.0, centre=(652.0, 484.0), k1=-0.3)
CORNER = PhotoSettings(board_corner_mm=(12.0, 26.0))


def specimen(section_sd: float = 1e-4, supports: str = "clamped-free") -> Specimen:
    return Specimen(
        section=tisim.Circle(radius=0.010), section_sd=section_sd, free_length=0.100, supports=supports
    )


@dataclass(frozen=True, eq=False)
class Errors:
    """Errors normal to the outlines [mm]: all, and the rest without shift, roll and scale."""

    all: np.ndarray
    shape: np.ndarray
    shift: np.ndarray
    scale: float
    dice: float
    end: float


def errors(found: Trace, axis: np.ndarray, supports: str = "clamped-free") -> Errors:
    outline = found.outline
    points = np.concatenate([outline.upper, outline.lower]) * 1e3
    off, normals = [], []
    for side, line in ((1, outline.upper), (-1, outline.lower)):
        truth = cases.edge(axis, side)
        off.append(cases.normal_error(line * 1e3, truth))
        tangent = np.gradient(line, axis=0)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        normals.append(np.column_stack([-tangent[:, 1], tangent[:, 0]]))
    all_, normal = np.concatenate(off), np.concatenate(normals)
    terms = np.column_stack(
        [normal, (normal * points).sum(axis=1), normal[:, 1] * points[:, 0] - normal[:, 0] * points[:, 1]]
    )
    fit = np.linalg.lstsq(terms, all_, rcond=None)[0]
    body = sweep(centreline(outline, supports=supports, free_length=0.100), tisim.Circle(radius=0.010))
    return Errors(
        all=all_,
        shape=all_ - terms @ fit,
        shift=fit[:2],
        scale=float(fit[2]),
        dice=dice(body, cases.true_body(axis)),
        end=float(np.linalg.norm(outline.upper[-1] * 1e3 - cases.edge(axis, 1)[-1])),
    )


def chi2(found: Trace, axis: np.ndarray) -> float:
    """Mean chi-square per mode, in polynomials along the edges, under the stated error."""
    return cases.chi_squares(found.outline, cases.true_error(found.outline, axis), cases.SMOOTH)[0]


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


VIEWS = {
    "square on": View(),
    "from the right": View(yaw=25.0, roll=-3.0),
    "from left and below": View(yaw=-18.0, pitch=-18.0, roll=4.0),
}


@pytest.fixture(scope="module")
def images() -> dict[str, np.ndarray]:
    tube = Tube(axis=cases.hanging(), radius=10.0)
    return {
        name: photograph(Setting(tubes=(tube,), seed=k), LENS, view)
        for k, (name, view) in enumerate(VIEWS.items())
    }


@pytest.fixture(scope="module")
def boards(images: dict[str, np.ndarray]) -> dict[str, Board]:
    return {name: find_board(image, BOARD) for name, image in images.items()}


@pytest.fixture(scope="module")
def camera(boards: dict[str, Board]) -> Camera:
    return calibrate([*boards.values()])


def test_several_views_give_the_lens(camera: Camera) -> None:
    assert camera.views == 3
    assert camera.focal_sd < 0.005
    assert abs(np.log(camera.focal / LENS.focal)) < 4 * camera.focal_sd
    assert camera.k1 == pytest.approx(LENS.k1, abs=0.03)
    assert camera.noise < 0.15


@pytest.mark.parametrize("name", VIEWS)
def test_outline_in_the_boards_frame(name: str, images: dict, boards: dict, camera: Camera) -> None:
    """With the board's corner known, position, size and shape must be right."""
    found = trace(images[name], boards[name], camera, specimen(), CORNER)
    e = errors(found, cases.hanging())
    assert rms(e.all) < 0.04
    assert e.end < 0.08
    assert e.dice > 0.995
    assert abs(e.scale) < 3 * found.outline.shared.scale
    # for smooth modes; for single points the statement is conservative, see test_stated_error
    assert rms(e.shape) < found.outline.sd * 1e3
    assert cases.BAND[0] < chi2(found, cases.hanging()) < cases.BAND[1]
    assert found.metres_per_pixel == pytest.approx(0.135e-3, abs=0.008e-3)


@pytest.mark.parametrize("name", ["square on", "from the right"])
def test_frame_from_the_clamp(name: str, images: dict, boards: dict, camera: Camera) -> None:
    found = trace(images[name], boards[name], camera, specimen(), PhotoSettings())
    assert np.array(found.origin) * 1e3 == pytest.approx([-12.0, -26.0], abs=0.1)
    e = errors(found, cases.hanging())
    assert rms(e.all) < 0.06
    assert e.dice > 0.995
    assert np.abs(e.shift).max() < 4e3 * found.outline.registration.shift


@pytest.mark.parametrize("corner", [(12.0, -26.0), (12.0, 76.0)])
def test_a_corner_of_another_sign_or_place_is_said(
    images: dict, boards: dict, camera: Camera, corner: tuple
) -> None:
    """The beam would leave the clamp far from the frame's origin."""
    image = images["square on"]
    settings = PhotoSettings(board_corner_mm=corner)
    with pytest.raises(PhotoProblem, match=r"leaves the clamp at z = -?5\d.* mm of its frame, expected 0"):
        trace(image, boards["square on"], camera, specimen(), settings)


def test_what_photographs_share_is_stated_apart(images: dict, boards: dict, camera: Camera) -> None:
    image = images["square on"]
    settings = PhotoSettings(board_corner_mm=(12.0, 26.0), board_corner_sd_mm=0.2, board_roll_sd_deg=0.3)
    found = trace(image, boards["square on"], camera, specimen(), settings).outline
    assert (found.registration.shift, found.shared.shift) == (0.0, pytest.approx(2e-4))
    assert found.shared.roll == pytest.approx(np.radians(0.3))
    assert 0.0 < found.registration.roll < np.radians(0.05)
    assert found.registration.scale == 0.0 < found.shared.scale
    clamp = trace(image, boards["square on"], camera, specimen(), PhotoSettings()).outline
    assert clamp.shared.shift == 0.0 < clamp.registration.shift


def test_known_diameter_stands_in_for_the_focal_length(images: dict, boards: dict) -> None:
    """One perpendicular view does not determine the focal length, and so not the specimen's distance."""
    image = images["square on"]
    board = boards["square on"]
    alone = calibrate([board])
    assert alone.focal_sd > 0.3
    known = trace(image, board, alone, specimen(section_sd=1e-5), CORNER)
    vague = trace(image, board, alone, specimen(section_sd=1e-2), CORNER)
    sure, unsure = errors(known, cases.hanging()), errors(vague, cases.hanging())
    assert rms(sure.all) < 0.1
    assert rms(sure.all) < 0.5 * rms(unsure.all)
    assert abs(sure.scale) < 3 * known.outline.shared.scale
    assert known.outline.shared.scale < 0.004 < vague.outline.shared.scale


def test_at_the_papers_resolution() -> None:
    """0.086 mm per pixel, one photograph, calibrated from this image alone."""
    image = photograph(
        Setting(tubes=(Tube(axis=cases.hanging(), radius=10.0),)), Lens(k1=-0.2), View(yaw=20.0)
    )
    board = find_board(image, BOARD)
    found = trace(image, board, calibrate([board]), specimen(), PhotoSettings())
    e = errors(found, cases.hanging())
    assert found.metres_per_pixel == pytest.approx(0.086e-3, abs=0.006e-3)
    assert rms(e.all) < 0.05
    assert e.dice > 0.995


def test_bridge_between_two_clamps() -> None:
    far = Clamp(low=(100.0, -10.0, -22.0), high=(140.0, 10.0, 22.0))
    axis = cases.bridge()
    setting = Setting(
        tubes=(Tube(axis=axis, radius=10.0, shade=90.0),), clamps=(Clamp(), far), board_corner=(14.0, 26.0)
    )
    image = photograph(setting, Lens(size=(1000, 714), focal=2214.0, centre=(503.0, 355.0)), View(yaw=8.0))
    board = find_board(image, BOARD)
    found = trace(image, board, calibrate([board]), specimen(supports="clamped-clamped"), PhotoSettings())
    e = errors(found, axis, "clamped-clamped")
    assert rms(e.all) < 0.1
    assert e.dice > 0.99


DIRECTIONS = [(0.0, 0.0), *((tilt, turn) for tilt in (10.0, 20.0, 25.0) for turn in (0.0, 130.0, 250.0))]


@pytest.fixture(scope="module")
def further_boards() -> dict[float, list[Board]]:
    """Two more views of the board alone, by lens distortion."""
    empty = Setting(tubes=(), clamps=(), seed=8)
    views = (View(yaw=15.0, pitch=12.0), View(yaw=-15.0, pitch=-10.0))
    return {
        k1: [find_board(photograph(empty, Lens(k1=k1), view), BOARD) for view in views] for k1 in (0.0, -0.3)
    }


@pytest.mark.slow
@pytest.mark.parametrize(("tilt", "direction"), DIRECTIONS)
@pytest.mark.parametrize("k1", [0.0, -0.3])
def test_tilts_and_distortion(
    tilt: float, direction: float, k1: float, further_boards: dict, capsys: pytest.CaptureFixture
) -> None:
    """The lens is calibrated on the photograph itself and two more views; for studies/photographs."""
    turn = np.radians(direction)
    view = View(yaw=tilt * np.cos(turn), pitch=tilt * np.sin(turn), roll=3.0 * np.sin(2 * turn))
    axis = cases.hanging()
    image = photograph(Setting(tubes=(Tube(axis=axis, radius=10.0),), seed=7), Lens(k1=k1), view)
    board = find_board(image, BOARD)
    found = trace(image, board, calibrate([board, *further_boards[k1]]), specimen(), CORNER)
    e = errors(found, axis)
    with capsys.disabled():
        print(
            f"\n| {tilt:.0f} | {direction:.0f} | {k1:.1f} | {rms(e.all):.4f} | {np.abs(e.all).max():.3f} | "
            f"{rms(e.shape):.4f} | {found.outline.sd * 1e3:.4f} | {chi2(found, axis):.3f} | {e.scale:+.5f} | "
            f"{found.outline.shared.scale:.5f} | {e.dice:.4f} |"
        )
    assert rms(e.all) < 0.1
    assert e.dice > 0.99
