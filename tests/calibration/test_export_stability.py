"""Stability of a law that stands for another one in a program: an export says where it is lost."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import tisim
from calibration.export import Form, Job
from calibration.export._convert import convert
from calibration.export._readme import losses
from calibration.export._response import BEYOND, POINTS, stability, stretches_of
from calibration.export.targets import calculix

Array = NDArray[np.float64]
G = 30e3
PATHS = {"uniaxial": (1.0, -0.5, -0.5), "equibiaxial": (1.0, 1.0, -2.0), "planar": (1.0, 0.0, -1.0)}
SOFTENING = (15e3, 20e3, -150e3)  # of a reduced polynomial [Pa]


def least_stiffness(e: Array) -> float:
    """Least second derivative of SOFTENING's energy by isochoric logarithmic strains, about e (3,)."""

    def energy(e: Array) -> float:
        x = float(np.exp(2.0 * e).sum()) - 3.0
        return sum(c * x ** (i + 1) for i, c in enumerate(SOFTENING))

    plane, h = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]]), 1e-4
    second = np.empty((2, 2))
    for i, a in enumerate(h * plane):
        for j, b in enumerate(h * plane):
            second[i, j] = energy(e + a + b) - energy(e + a - b) - energy(e - a + b) + energy(e - a - b)
    return float(np.linalg.eigvalsh(second)[0])


def test_limits_are_those_of_the_energy() -> None:
    terms = tuple(((i + 1, 0), c) for i, c in enumerate(SOFTENING))
    form = Form(kind="polynomial", bulk=1e4 * G, terms=terms)
    found = {s.mode: s for s in stability(form.stress, 0.7, 1.4)}
    assert set(found) == set(PATHS)
    for mode, path in PATHS.items():
        at = stretches_of(mode, 0.7**BEYOND, 1.4**BEYOND)
        spacing = (at[-1] - at[0]) / (POINTS - 1)
        fine = np.linspace(at[0], at[-1], 501)
        lost = fine[[least_stiffness(np.log(s) * np.array(path)) <= 0.0 for s in fine]]
        limits = (found[mode].below, found[mode].above)
        for limit, exact in zip(limits, (lost[lost < 1.0].max(), lost[lost > 1.0].min()), strict=True):
            assert limit == pytest.approx(exact, abs=1.2 * spacing)


@pytest.mark.parametrize(
    "form",
    [
        Form(kind="polynomial", bulk=600e3, terms=(((1, 0), 0.5 * G),)),
        Form(kind="ogden", bulk=600e3, mu=(0.5 * G, -0.2 * G), alpha=(3.0, -2.0)),
    ],
)
def test_laws_that_are_stable_everywhere_are_not_blamed(form: Form) -> None:
    assert stability(form.stress, 0.4, 2.5) == ()


@pytest.mark.parametrize(("low", "high", "where"), [(0.8, 1.2, "within"), (0.95, 1.05, "only beyond")])
def test_what_stands_for_st_venant_kirchhoff_is_said_to_be_unstable(
    low: float, high: float, where: str
) -> None:
    """CalculiX has no such law; the polynomial that follows it softens at the ends of the range."""
    m = tisim.material_from_moduli("st-venant-kirchhoff", shear_modulus=G, bulk_modulus=20.0 * G)
    found = convert(
        m, lambda f: calculix.TARGET.writes(f, m), low=low, high=high, most_loss=0.5, program="calculix"
    )
    lines = losses(Job(name="m", material=m, conversion=found, keeps=frozenset()), high)
    (line,) = [s for s in lines if "not stable" in s]
    assert f"{where} the range of these tests: uniaxial, stretches below " in line


def test_the_card_s_own_limits_are_said_too() -> None:
    """A law is not blamed for what the card's has as well."""
    m = tisim.material_from_moduli("st-venant-kirchhoff", shear_modulus=G, bulk_modulus=20.0 * G)
    found = convert(
        m, lambda f: calculix.TARGET.writes(f, m), low=0.6, high=1.6, most_loss=1.0, program="calculix"
    )
    lines = losses(Job(name="m", material=m, conversion=found, keeps=frozenset()), 1.6)
    (line,) = [s for s in lines if "not stable" in s]
    assert "The card's own law, st-venant-kirchhoff, is not stable in uniaxial, stretches below 0." in line
