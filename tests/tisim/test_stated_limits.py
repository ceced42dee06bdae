"""Collapsed specimens, numbers given as text, shapes with too few sizes: a status or one sentence each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import tisim
from tisim import laws
from tisim.problems._registry import kind_of
from tisim.view import view_of_file


def test_a_sheet_that_collapses_has_no_equilibrium() -> None:
    """St Venant-Kirchhoff, biaxial: l3^2 = 1 - 2 nu / (1 - nu) (s^2 - 1) is 0 at s = 1.354."""
    material = tisim.Material(law="st-venant-kirchhoff", parameters={"mu": 1e4, "lam": 3e4})
    last = float(np.sqrt(1.0 + 5.0 / 6.0))
    for stretch in (1.355, 1.36, 1.4):
        found = tisim.simulate(
            tisim.Coupon(material=material, mode="equibiaxial", stretches=(1.2, stretch)), workers=1
        )
        assert found.status is not tisim.Status.CONVERGED
        assert len(found.load) == 1
        assert float(found.message.rpartition(" ")[2]) <= last + 1e-3


def test_simple_shear_has_no_smallest_stretch() -> None:
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=1e6)
    found = tisim.simulate(
        tisim.Coupon(material=material, mode="simple-shear", stretches=(-0.2, 2.2)), workers=1
    )
    assert found.nominal_stress == pytest.approx([-1.2e4, 1.2e4], rel=1e-6)


@pytest.mark.parametrize("value", ["15e3", True, None])
def test_numbers_are_numbers(value: Any) -> None:
    with pytest.raises(ValueError, match=r"parameter mu \[Pa\]: expected finite numbers"):
        laws.get("neo-hookean").check({"mu": value, "lam": 1e5})
    with pytest.raises(ValueError, match="shear_modulus: expected a modulus above 0 Pa"):
        tisim.material_from_moduli("neo-hookean", shear_modulus=value, bulk_modulus=1e5)
    with pytest.raises(ValueError, match="density: expected a density above 0 kg/m3"):
        tisim.material_from_moduli("yeoh", shear_modulus=1e4, bulk_modulus=1e5, density=value)


@pytest.mark.parametrize(
    ("inclusion", "words"),
    [
        (tisim.BoxInclusion(size=(0.01, 0.01), centre=(0, 0, 0.005)), "size: expected 3 finite numbers"),  # type: ignore[arg-type]
        (tisim.BoxInclusion(size=0.01, centre=(0, 0, 0.005)), "size: expected 3 finite numbers"),  # type: ignore[arg-type]
        (
            tisim.SphereInclusion(radius=(0.01,) * 3, centre=(0, 0, 0.005)),  # type: ignore[arg-type]
            "radius: expected a length above 0",
        ),
    ],
)
def test_sizes_of_inclusions_are_checked_by_their_fields(inclusion: tisim.Inclusion, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        inclusion.check()


@pytest.mark.parametrize("locking", [9.0, 11.0, 30.0, 300.0, 1000.0])
def test_eight_chains_keep_the_digits_of_their_energy(locking: float) -> None:
    """Against 50 digits: w(x) - w(x0), of which the nearly Gaussian part cancels."""
    mpmath = pytest.importorskip("mpmath")
    mpmath.mp.dps = 50
    stretch = np.array([1.0001, 1.001, 1.3])
    F = np.array([np.diag([s, s**-0.5, s**-0.5]) for s in stretch])
    found = laws.evaluate("eight-chain", {"mu": 1e4, "locking": locking, "bulk": 1e6}, F)[0]

    def w(x: object) -> object:
        b = mpmath.findroot(lambda t: mpmath.coth(t) - 1 / t - x, 3 * x)
        return x * b + mpmath.log(b / mpmath.sinh(b)), b

    x0 = 1 / mpmath.mpf(locking)
    rest, b0 = w(x0)
    for s, energy in zip(stretch, found, strict=True):
        first = mpmath.mpf(float(s)) ** 2 + 2 / mpmath.mpf(float(s))
        exact = 1e4 * 3 * locking / b0 * (w(mpmath.sqrt(first / 3) * x0)[0] - rest)
        assert energy == pytest.approx(float(exact), rel=1e-6)


def test_a_coupon_in_a_file_keeps_its_stress_and_a_shear_is_called_one(tmp_path: Path) -> None:
    material = tisim.material_from_moduli("neo-hookean", shear_modulus=1e4, bulk_modulus=1e6)
    found = tisim.simulate(tisim.Coupon(material=material, mode="simple-shear", stretches=(1.5,)), workers=1)
    assert found.nominal_stress is not None
    path = tisim.write(found, tmp_path / "shear.vtu")
    (stated,) = meshio.read(path).cell_data["nominal_stress"]
    assert np.unique(stated) == pytest.approx(found.nominal_stress)
    assert kind_of(found.scene).describe(found, 0) == "Coupon, simple-shear, shear 0.5, 5 kPa"
    assert view_of_file(path).labels == ("load 1.5 · nominal stress 5 kPa",)
    assert tisim.show(found).labels == ("amount of shear 0.5 · nominal stress 5 kPa",)
