"""Response of a material to homogeneous tests, and the error of a form that replaces it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.export._forms import Form
from calibration.parameters import long_time_parts
from tisim import Material, laws, parts
from tisim.parts import MaterialPoints

Array = NDArray[np.float64]
Stress = Callable[[Array], Array]  # principal stretches (n, 3) to principal nominal stresses (n, 3) [Pa]

POINTS = 41  # of each curve
BEYOND = 1.5  # of the logarithms of the stretches: so far a body may strain beyond the range, in a small part
MODES = ("uniaxial", "equibiaxial", "planar")
# which stretches are the test's, which the free one's, which stay 1
_DRIVEN = {"uniaxial": (0,), "equibiaxial": (0, 1), "planar": (0,)}
_FREE = {"uniaxial": (1, 2), "equibiaxial": (2,), "planar": (2,)}


@dataclass(frozen=True, kw_only=True)
class Difference:
    """Error of a replacement's nominal stress in one test.

    Attributes
    ----------
    mode : str
    low, high : float
        Stretches of the test.
    rms, largest : float
        Of the difference, as fractions of the rms and of the largest stress of the card's law.
    """

    mode: str
    low: float
    high: float
    rms: float
    largest: float


def long_time(material: Material) -> Material:
    """The same material, stated by its long-time moduli: of the law, the fibres and the softening energy."""
    found, left = long_time_parts(parts.of(material))
    if left == 1.0:
        return material
    return replace(material, parameters=scaled(material, left), **found)  # type: ignore[arg-type]


def elastic(material: Material) -> Material:
    """The material after relaxation, without memory; fibres stay."""
    return replace(long_time(material), viscosity=None, softening=None)


def scaled(material: Material, factor: float) -> dict[str, float | tuple[float, ...]]:
    """Parameters with the isochoric moduli times `factor`, and the bulk modulus as it was."""
    law = laws.get(material.law)
    found: dict[str, float | tuple[float, ...]] = {}
    for name, (unit, _) in law.parameters.items():
        value = material.parameters[name]
        if unit == "Pa" and name != "bulk":
            value = tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value
        found[name] = value
    before, after = law.moduli(material.parameters), law.moduli(found)
    if "lam" in found:
        found["lam"] = float(found["lam"]) + before.bulk_modulus - after.bulk_modulus  # type: ignore[arg-type]
    return found


def stress_of(material: Material) -> Stress:
    """Principal stresses of a material without memory; fibres, where it has them, lie along axis 1."""
    if material.fibres is not None:
        material = replace(material, fibres=replace(material.fibres, direction=(1.0, 0.0, 0.0)))

    def stress(stretches: Array) -> Array:
        F = np.zeros((len(stretches), 3, 3))
        F[:, range(3), range(3)] = stretches
        return MaterialPoints(material, len(stretches)).evaluate(F)[1][:, range(3), range(3)]

    return stress


@dataclass(frozen=True, kw_only=True)
class Stability:
    """Stretches of a test between which a law is stable in Drucker's sense.

    Attributes
    ----------
    mode : str
    below, above : float or None
        The stretches nearest to 1 at which it no longer is; None where it is, as far as was looked.
    """

    mode: str
    below: float | None
    above: float | None


def nominal(stress: Stress, mode: str, stretches: Array) -> Array:
    """Nominal stress along axis 1 [Pa], the free sides without stress, (n,); NaN where none is found."""
    l = _principal(stress, mode, stretches)
    found = np.isfinite(l.sum(axis=1))
    return np.where(found, stress(np.where(found[:, None], l, 1.0))[:, 0], np.nan)


def _principal(stress: Stress, mode: str, stretches: Array) -> Array:
    """Principal stretches (n, 3) of a test, the free sides without stress; NaN where none is found.

    The free stretch by Newton's method on its logarithm, from constant volume.
    """
    driven, free = list(_DRIVEN[mode]), list(_FREE[mode])
    l = np.ones((len(stretches), 3))
    l[:, driven] = stretches[:, None]
    t = -len(driven) / len(free) * np.log(stretches)

    def side(t: Array) -> Array:
        l[:, free] = np.exp(t)[:, None]
        return stress(l)[:, free[0]]

    step = 1e-6
    for _ in range(60):
        value = side(t)
        slope = (side(t + step) - side(t - step)) / (2.0 * step)
        with np.errstate(invalid="ignore", divide="ignore"):
            move = np.clip(np.where(slope > 0.0, -value / slope, np.nan), -0.1, 0.1)
        t = t + move
        if not np.nanmax(np.abs(move), initial=0.0) > 1e-11:
            break
    l[:, free] = np.exp(t)[:, None]
    return l


def stability(stress: Stress, low: float, high: float) -> tuple[Stability, ...]:
    """The tests in which a law loses its stability in Drucker's sense, none where it keeps it.

    The tangent d tau_i / d ln(lambda_j) of the principal Kirchhoff stresses has to be positive definite;
    where the free sides find no equilibrium, it is not. Simple shear is a planar test that is rotated.

    Parameters
    ----------
    stress : callable
    low, high : float
        Principal stretches; `BEYOND` times their logarithms are looked at.
    """
    found = []
    for mode in MODES:
        at = stretches_of(mode, low**BEYOND, high**BEYOND)
        l = _principal(stress, mode, at)
        exists = np.isfinite(l.sum(axis=1))
        soft = _softest(stress, np.where(exists[:, None], l, 1.0)) <= 0.0
        lost = at[~exists | soft]
        below, above = lost[lost < 1.0], lost[lost > 1.0]
        if lost.size:
            found.append(
                Stability(
                    mode=mode,
                    below=float(below.max()) if below.size else None,
                    above=float(above.min()) if above.size else None,
                )
            )
    return tuple(found)


def _softest(stress: Stress, l: Array) -> Array:
    """Least eigenvalue of the tangent d tau_i / d ln(lambda_j) [Pa] at principal stretches (n, 3)."""
    step, tangent = 1e-5, np.empty((len(l), 3, 3))
    for j in range(3):
        up, down = l.copy(), l.copy()
        up[:, j] *= np.exp(step)
        down[:, j] *= np.exp(-step)
        tangent[:, :, j] = (up * stress(up) - down * stress(down)) / (2.0 * step)
    return np.asarray(np.linalg.eigvalsh(0.5 * (tangent + tangent.swapaxes(1, 2)))[:, 0], dtype=np.float64)


def stretches_of(mode: str, low: float, high: float) -> Array:
    """Stretches of a test in which the principal stretches reach from `low` to `high`."""
    if mode == "equibiaxial":
        low, high = max(low, high**-0.5), min(high, low**-0.5)
    return np.linspace(low, high, POINTS)


def compare(card: Stress, other: Stress, low: float, high: float) -> tuple[Difference, ...]:
    """Difference in each test. NaN where one of the two finds no side free of stress."""
    found = []
    for mode in MODES:
        at = stretches_of(mode, low, high)
        mine, its = nominal(card, mode, at), nominal(other, mode, at)
        off = its - mine
        found.append(
            Difference(
                mode=mode,
                low=float(at[0]),
                high=float(at[-1]),
                rms=float(np.sqrt(np.mean(off**2) / np.mean(mine**2))),
                largest=float(np.abs(off).max() / np.abs(mine).max()),
            )
        )
    return tuple(found)


def worst(differences: tuple[Difference, ...]) -> Difference:
    """The one with the largest rms; one that is not a number counts as worst."""
    return max(differences, key=lambda d: d.rms if np.isfinite(d.rms) else np.inf)


def pressure_difference(card: Stress, form: Form, volume: float) -> float:
    """Relative difference of the pressure where the volume is `volume` times that at rest."""
    l = np.full((1, 3), np.cbrt(volume))
    return float(form.stress(l)[0, 0] / card(l)[0, 0] - 1.0)


def percent(value: float) -> str:
    """A fraction in percent, with two digits."""
    return "not a number" if not np.isfinite(value) else f"{100.0 * value:.2g} %"


def fibre_loss(material: Material, high: float) -> float:
    """Additional stress along the fibres at the largest stretch, as a fraction of the stress without them."""
    at = np.array([1.0, max(high, 1.0 + 1e-3)])
    with_them = nominal(stress_of(material), "uniaxial", at)[1]
    return float(with_them / nominal(stress_of(replace(material, fibres=None)), "uniaxial", at)[1] - 1.0)


def softening_loss(material: Material, high: float) -> float:
    """Largest fraction of the stress that unloading from the largest stretch loses to softening."""
    points = MaterialPoints(replace(material, viscosity=None, fibres=None), 1)
    rising = np.linspace(1.0, high, 21)[1:]
    pulls = []
    for stretch in (*rising, *rising[-2::-1]):
        F = np.diag([stretch, stretch**-0.5, stretch**-0.5])[None]
        points.begin(1.0)
        P = points.evaluate(F)[1][0]
        points.accept(F)
        pulls.append(P[0, 0] - P[1, 1] * stretch**-1.5)  # sides free of stress, at constant volume
    loading, unloading = np.array(pulls[:19]), np.array(pulls[20:][::-1])
    return float((1.0 - unloading / loading).max())


def relaxation(material: Material) -> Mapping[str, float]:
    """Modulus over the long-time one at once, at 1 s and at 100 s after loading."""
    assert material.viscosity is not None
    spectrum = material.viscosity.spectrum()
    return {
        "at once": spectrum.instantaneous / spectrum.equilibrium,
        "after 1 s": spectrum.modulus(1.0) / spectrum.equilibrium,
        "after 100 s": spectrum.modulus(100.0) / spectrum.equilibrium,
    }
