"""Unusable photographs: each has its message and a picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import photo_cases as cases
import pytest
from scipy.ndimage import gaussian_filter

import tisim
from benchmarks.blind.camera import Clamp, Lens, Setting, Tube, View, photograph
from calibration.experiment import Checkerboard
from calibration.photo import PhotoProblem, PhotoSettings, Specimen, Trace, calibrate, find_board, trace

BOARD = Checkerboard(squares=(9, 6), square=0.008)
LENS = Lens(size=(800, 600), focal=1860.0, centre=(400.0, 298.0))
TUBE = Tube(axis=cases.hanging(), radius=10.0)
GOOD = Setting(tubes=(TUBE,), blur=0.8)
SPECIMEN = Specimen(
    section=tisim.Circle(radius=0.010), section_sd=1e-4, free_length=0.100, supports="clamped-free"
)


def go(image: np.ndarray, settings: PhotoSettings | None = None, board: Checkerboard = BOARD) -> None:
    found = find_board(image, board)
    trace(image, found, calibrate([found]), SPECIMEN, settings or PhotoSettings())


def second() -> Setting:
    return replace(GOOD, tubes=(TUBE, Tube(axis=np.array([[5.0, -38.0], [45.0, -38.0]]), radius=6.0)))


def twins() -> Setting:
    clamp = Clamp(low=(-40.0, -10.0, -50.0), high=(0.0, 10.0, 22.0))
    other = Tube(axis=np.array([[0.0, -38.0], [40.0, -38.0]]), radius=7.0)
    return replace(GOOD, tubes=(TUBE, other), clamps=(clamp,))


SETTINGS = {
    "no board of 9 x 6 squares was found": (replace(GOOD, board=False), View()),
    "cut off by the photograph's frame": (replace(GOOD, board_corner=(80.0, 26.0)), View()),
    "glare on the specimen's edge": (replace(GOOD, glare=((50.0, 5.0, 6.0),)), View()),
    "touches the photograph's frame": (GOOD, View(target=(8.0, 0.0, 16.0))),
    "2 specimens were found, expected one": (second(), View(target=(52.0, 0.0, 8.0))),
    "2 specimens were found in the clamp": (twins(), View(target=(52.0, 0.0, 8.0))),
    "no specimen was found": (replace(GOOD, tubes=(), clamps=()), View()),
    "clamp's face was not found": (replace(GOOD, clamps=()), View()),
    "cover the board": (replace(GOOD, board_corner=(12.0, 11.0)), View()),
    "camera stands to the left of the clamp's face": (GOOD, View(yaw=-15.0)),
}


@pytest.mark.parametrize("sentence", SETTINGS)
def test_sentence_and_picture(sentence: str) -> None:
    image = photograph(SETTINGS[sentence][0], LENS, SETTINGS[sentence][1])
    with pytest.raises(PhotoProblem, match=sentence) as caught:
        go(image)
    picture = caught.value.picture
    assert picture is not None
    assert picture.shape == (*image.shape, 3)
    if "no board" not in sentence and "no specimen" not in sentence:
        assert (picture != image[..., None]).any()  # the picture shows what was found


@pytest.fixture(scope="module")
def good() -> np.ndarray:
    return photograph(GOOD, LENS, View())


def test_good_one_passes(good: np.ndarray) -> None:
    go(good)


def test_blurred(good: np.ndarray) -> None:
    for blur in (4.0, 9.0):
        image = gaussian_filter(good.astype(float), blur).astype(np.uint8)
        with pytest.raises(PhotoProblem, match="the photograph is blurred"):
            go(image)


def test_wrong_squares(good: np.ndarray) -> None:
    with pytest.raises(PhotoProblem, match=r"looks 2\d\.\d mm high, its section says 20.0 mm"):
        go(good, board=Checkerboard(squares=(9, 6), square=0.010))


def test_a_section_that_contradicts_the_board_is_said() -> None:
    """A board printed at 96 %, or a radius that is wrong by as much: lengths were wrong, with the sd of right
    ones."""
    image = photograph(GOOD, LENS, View(yaw=20.0))
    found = find_board(image, BOARD)

    def traced(radius: float, sd: float) -> Trace:
        section = replace(SPECIMEN, section=tisim.Circle(radius=radius), section_sd=sd)
        return trace(image, found, calibrate([found]), section, PhotoSettings())

    said = r"looks (19\.9|20\.0)\d mm high, its section says 20\.80 mm, and .* differ by 0\.1\d? mm \(sd\)"
    with pytest.raises(PhotoProblem, match=said) as caught:
        traced(0.0104, 1e-4)
    assert caught.value.picture is not None
    assert traced(0.0104, 1e-3).diameter == pytest.approx(0.020, abs=2e-4)  # hardly known: the board decides
    assert traced(0.0101, 1e-4).outline.shared.scale < 0.003
    squares = PhotoSettings(square_sd=0.02)
    wide = replace(SPECIMEN, section=tisim.Circle(radius=0.0104))
    assert trace(image, found, calibrate([found]), wide, squares).outline.shared.scale > 0.02


def test_lying_board(good: np.ndarray) -> None:
    with pytest.raises(PhotoProblem, match="the board lies on its side"):
        go(np.ascontiguousarray(np.rot90(good)))


def test_front_edge_of_the_clamp_lets_the_camera_stand_left() -> None:
    image = photograph(replace(GOOD, clamps=(Clamp(),)), LENS, View(yaw=-15.0))
    found = find_board(image, BOARD)
    settings = PhotoSettings(clamp_front_mm=-10.0)
    result = trace(image, found, calibrate([found]), SPECIMEN, settings)
    assert np.array(result.origin) * 1e3 == pytest.approx([-12.0, -26.0], abs=0.3)


def test_inner_corners_in_place_of_squares(good: np.ndarray) -> None:
    """OpenCV counts inner corners; the board of 9 x 6 squares has 8 x 5."""
    with pytest.raises(PhotoProblem, match=r"counts squares, not inner corners: expected \[9, 6\]"):
        go(good, board=Checkerboard(squares=(8, 5), square=BOARD.square))
