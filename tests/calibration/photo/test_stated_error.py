"""The stated error of a traced outline against its true error, from photographs of known beams.

The truth is the tube that the blind laboratory photographed. The traced outline deviates by white noise and
by slow errors of lens and shading. The statement has one Gaussian kernel for both and should be right for
long waves and conservative for short ones (`calibration.photo._trace.stated_error`).
"""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import photo_cases as cases
import pytest
import yaml

import calibration
import tisim
from benchmarks.blind.beams.model import Beam
from benchmarks.blind.beams.solver import solve
from benchmarks.blind.camera import Lens, Setting, Tube, View, photograph
from calibration.experiment import Checkerboard
from calibration.photo import PhotoSettings, Specimen, calibrate, find_board, trace
from calibration.photo._trace import _SLOW, _SPACING, stated_error

BOARD = Checkerboard(squares=(9, 6), square=0.008)
SMALL = Lens(size=(800, 600), focal=1860.0, centre=(402.0, 297.0), k1=-0.1)
LARGE = Lens(size=(1600, 1200), focal=3720.0, centre=(803.0, 594.0), k1=-0.1)
MODULUS, RADIUS, DENSITY = 30e3, 0.010, 1000.0  # of the fitted beams [Pa], [m], [kg/m3]


def density(k: np.ndarray, sd: float, length: float) -> np.ndarray:
    """Spectral density of a Gaussian kernel."""
    return np.sqrt(2 * np.pi) * sd**2 * length * np.exp(-0.5 * (k * length) ** 2)


@pytest.mark.parametrize("length", [0.5e-3, 0.8e-3, 2e-3])
@pytest.mark.parametrize(("noise", "slow"), [(3e-6, 6e-6), (1e-5, 5e-6), (1e-6, 0.0)])
def test_statement_is_exact_for_long_waves_and_never_below(noise: float, slow: float, length: float) -> None:
    sd, correlation = stated_error(noise, length, slow)
    k = np.linspace(0.0, np.pi / _SPACING, 400)
    truth = density(k, noise, length) + density(k, slow, _SLOW)
    stated = density(k, sd, correlation)
    assert stated[0] == pytest.approx(truth[0], rel=1e-12)
    assert (stated >= truth * (1 - 1e-12)).all()


def test_noise_shorter_than_the_points_distance_keeps_its_density() -> None:
    sd, correlation = stated_error(4e-6, 0.2e-3, 5e-6)
    assert correlation == 0.5 * _SPACING
    whole = density(np.zeros(1), 4e-6, 0.2e-3) + density(np.zeros(1), 5e-6, _SLOW)
    assert density(np.zeros(1), sd, correlation) == pytest.approx(whole, rel=1e-12)
    # summed over points, as in the fit: within a tenth of the density
    apart = _SPACING * np.arange(-50, 51)
    summed = _SPACING * sd**2 * np.exp(-0.5 * (apart / correlation) ** 2).sum()
    assert summed == pytest.approx(float(whole[0]), rel=0.1)


def drawn(seed: int, lens: Lens) -> tuple[np.ndarray, np.ndarray, float]:
    """Photograph of a beam with view, blur, noise and light drawn by the seed; its axis and length [mm]."""
    rng = np.random.default_rng(seed)
    length = float(rng.choice([60.0, 100.0]))
    axis = cases.hanging(length, float(rng.uniform(0.08, 0.3)) * length)
    image = photograph(
        Setting(
            tubes=(Tube(axis=axis, radius=1e3 * RADIUS),),
            blur=float(rng.uniform(0.7, 1.6)),
            noise=float(rng.uniform(1.0, 5.0)),
            light=(float(rng.uniform(-0.5, 0.5)), -0.85, float(rng.uniform(-0.1, 0.6))),
            seed=seed,
        ),
        lens,
        drawn_view(rng),
    )
    return image, axis, length


def drawn_view(rng: np.random.Generator, *, lower: float = 0.0) -> View:
    """A camera with board and beam in its image; `lower` [mm] shifts it for a beam with a large sag."""
    return View(
        target=(48.0 + float(rng.uniform(-3, 3)), 0.0, 14.0 - lower + float(rng.uniform(-3, 6))),
        distance=float(rng.uniform(430, 460)) + lower,
        yaw=float(rng.uniform(-3, 22)),
        pitch=float(rng.uniform(-10, 10)),
        roll=float(rng.uniform(-3, 3)),
    )


def check(seed: int, lens: Lens) -> str:
    image, axis, length = drawn(seed, lens)
    board = find_board(image, BOARD)
    specimen = Specimen(
        section=tisim.Circle(radius=RADIUS),
        section_sd=1e-4,
        free_length=1e-3 * length,
        supports="clamped-free",
    )
    settings = PhotoSettings(board_corner_mm=(12.0, 26.0))
    outline = trace(image, board, calibrate([board]), specimen, settings).outline
    error = cases.true_error(outline, axis)
    row = [f"seed {seed}: sd {1e6 * outline.sd:.1f} um over {1e3 * outline.correlation:.2f} mm"]
    for degree in (3, cases.SMOOTH, len(outline.lower) - 1):
        chi2, largest = cases.chi_squares(outline, error, min(degree, 40))
        row.append(f"to degree {min(degree, 40)}: {chi2:.3f} a mode, largest {largest:.2f} sd")
        assert cases.BAND[0] < chi2 < cases.BAND[1], row
        assert cases.LARGEST[0] < largest < cases.LARGEST[1], row
    return "; ".join(row)


@pytest.mark.parametrize("seed", [501, 502, 503])
def test_true_errors_are_as_stated(seed: int) -> None:
    check(seed, SMALL)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(520, 540))
def test_true_errors_are_as_stated_in_large_photographs(seed: int, capsys: pytest.CaptureFixture) -> None:
    row = check(seed, LARGE)
    with capsys.disabled():
        print(f"\n{row}")


def lab(folder: Path, seed: int, lengths: tuple[int, ...], lens: Lens) -> Path:
    """An experiment with photographs of silicone cantilevers deformed by the blind laboratory's solver."""
    rng = np.random.default_rng(seed)
    (folder / "photos").mkdir(parents=True)
    trials = []
    for length in lengths:
        beam = Beam(length=1e-3 * length, bridge=False, mu=MODULUS, radius=RADIUS, density=DENSITY)
        edges = 1e3 * solve(beam).edges(np.linspace(0.0, 1.0, 400))
        half = 0.5 * np.linalg.norm(edges[0] - edges[1], axis=1)
        setting = Setting(tubes=(Tube(axis=edges.mean(axis=0), radius=half),), seed=seed + length)
        view = drawn_view(rng, lower=0.0 if length < 80 else 8.0)
        name = f"photos/{length}.png"
        cv2.imwrite(str(folder / name), photograph(setting, lens, view))
        trials.append(
            {
                "id": f"{length}",
                "kind": "beam",
                "material": "silicone",
                "section": {"circle": {"radius_mm": 1e3 * RADIUS, "radius_sd_mm": 0.05}},
                "free_length_mm": float(length),
                "free_length_sd_mm": 0.2,
                "grip_length_mm": 20.0,
                "supports": "clamped-free",
                "gravity_m_s2": [0.0, 0.0, -9.81],
                "captures": [
                    {
                        "time_s": 60.0,
                        "photo": name,
                        "photo_checkerboard": {"squares": [9, 6], "square_mm": 8.0},
                    }
                ],
            }
        )
    belief = {"density_kg_m3": DENSITY, "density_sd_kg_m3": 5.0}
    whole = {"format": 1, "name": "photographs", "materials": {"silicone": belief}, "trials": trials}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(whole, sort_keys=False), encoding="utf-8")
    settings = {"board_corner_mm": [12.0, 26.0], "board_corner_sd_mm": 0.1}
    (folder / "photographs.yaml").write_text(yaml.safe_dump(settings), encoding="utf-8")
    return folder


def check_fit(
    folder: Path, seed: int, lengths: tuple[int, ...], lens: Lens, *, generations: int = 60
) -> None:
    traced = calibration.reconstruct(lab(folder / "lab", seed, lengths, lens), out=folder / "traced")
    (result,) = calibration.fit(
        traced.folder, model="neo-hookean", held_out=False, generations=generations, workers=1
    )
    assert result.status == "converged", result.message
    assert abs(result.shear_modulus - MODULUS) < 1.96 * result.shear_modulus_sd
    assert result.shear_modulus_sd < 0.04 * MODULUS
    assert cases.BAND[0] < result.reduced_chi2 < cases.BAND[1]


def test_a_fit_of_a_traced_photograph_holds_the_truth(tmp_path: Path) -> None:
    check_fit(tmp_path, 511, (60,), SMALL, generations=12)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [541, 542, 543])
def test_fits_of_two_traced_photographs_hold_the_truth(seed: int, tmp_path: Path) -> None:
    check_fit(tmp_path, seed, (60, 100), LARGE)
