"""Shared by the tests of the laws: random parameters and deformations, and independent energies.

The energies are written in NumPy, in principal stretches from an SVD, and use nothing of tisim's laws.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from tisim.material import Material

LAWS = (
    "st-venant-kirchhoff",
    "neo-hookean",
    "stable-neo-hookean",
    "mooney-rivlin",
    "ogden",
    "arruda-boyce",
    "yeoh",
    "eight-chain",
    "stiffening-neo-hookean",
)
AB = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)
_shear = st.floats(1e3, 1e5)
_ratio = st.floats(5.0, 1000.0)


@st.composite
def materials(draw: st.DrawFn, law: str) -> Material:
    """Random parameters of soft silicones: G of 1 to 100 kPa, K/G of 5 to 1000, Ogden with 1 to 3 terms."""
    G, ratio = draw(_shear), draw(_ratio)
    if law == "mooney-rivlin":
        part = draw(st.floats(0.0, 1.0))
        parameters = {"c10": G / 2 * part, "c01": G / 2 * (1 - part), "bulk": ratio * G}
    elif law == "ogden":
        n = draw(st.integers(1, 3))
        size = st.floats(0.5, 8.0)
        alpha = [draw(size) * draw(st.sampled_from((1, -1))) for _ in range(n)]
        share = [draw(st.floats(0.1, 1.0)) for _ in range(n)]
        mu = [2 * G * s / sum(share) / a for s, a in zip(share, alpha, strict=True)]
        parameters = {"mu": tuple(mu), "alpha": tuple(alpha), "bulk": ratio * G}
    elif law == "arruda-boyce":
        parameters = {"mu": G, "locking": draw(st.floats(1.5, 6.0)), "bulk": ratio * G}
    elif law == "yeoh":
        parameters = {"mu": G, "stiffening": draw(st.floats(0.0, 1.5)), "bulk": ratio * G}
    elif law == "stiffening-neo-hookean":
        parameters = {"mu": G, "stiffening": draw(st.floats(0.0, 1.5)), "lam": (ratio - 2 / 3) * G}
    elif law == "eight-chain":
        parameters = {"mu": G, "locking": draw(st.floats(2.5, 8.0)), "bulk": ratio * G}
    else:
        parameters = {"mu": G, "lam": (ratio - 2 / 3) * G}
    return Material(law=law, parameters=parameters)


def rotation(seed: int) -> np.ndarray:
    """Random proper rotation."""
    q = np.random.default_rng(seed).normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K


rotations = st.integers(0, 2**32 - 1).map(rotation)


@st.composite
def deformations(draw: st.DrawFn) -> np.ndarray:
    """Random F = R diag(stretches) Q: large, near identity, with two or three equal or close stretches."""
    kind = draw(st.sampled_from(("large", "near identity", "two alike", "three alike")))
    stretch = st.floats(0.5, 2.5)
    gap = draw(st.sampled_from((0.0, 1e-3, 1e-4, 1e-5, 3e-6, 1e-6, 1e-7, 1e-8, 1e-9)))
    if kind == "large":
        stretches = np.array([draw(stretch) for _ in range(3)])
    elif kind == "near identity":
        stretches = 1.0 + draw(st.sampled_from((1e-2, 1e-4, 1e-6, 1e-8))) * np.array(
            [1.0, -0.6, draw(stretch)]
        )
    elif kind == "two alike":
        first = draw(stretch)
        stretches = np.array([first, draw(stretch), first + gap])
    else:
        stretches = draw(stretch) + gap * np.array([0.0, 1.0, draw(stretch)])
    return draw(rotations) @ np.diag(stretches) @ draw(rotations)


def energy(material: Material, F: np.ndarray, *, printed: bool = False) -> np.ndarray:
    """Energy at F (..., 3, 3); `printed`: Ogden and Arruda-Boyce as in the paper, without isochoric split."""
    p = {k: np.asarray(v) for k, v in material.parameters.items()}
    l = np.linalg.svd(F, compute_uv=False)
    J = np.linalg.det(F)
    lbar = l / np.cbrt(J)[..., None]
    I1 = (l**2).sum(-1)
    i1, i2 = (lbar**2).sum(-1), (lbar**-2).sum(-1)
    E = (l**2 - 1) / 2
    if printed:
        lbar, i1 = l, I1
    forms: dict[str, Callable[[], np.ndarray]] = {
        "st-venant-kirchhoff": lambda: p["lam"] / 2 * E.sum(-1) ** 2 + p["mu"] * (E**2).sum(-1),
        "neo-hookean": lambda: p["mu"] / 2 * (I1 - 3) - p["mu"] * np.log(J) + p["lam"] / 2 * np.log(J) ** 2,
        "stable-neo-hookean": lambda: (
            p["mu"] / 2 * (I1 - 3) - p["mu"] * (J - 1) + (p["lam"] + p["mu"]) / 2 * (J - 1) ** 2
        ),
        "mooney-rivlin": lambda: p["c10"] * (i1 - 3) + p["c01"] * (i2 - 3) + p["bulk"] / 2 * np.log(J) ** 2,
        "ogden": lambda: (
            sum(m / a * ((lbar**a).sum(-1) - 3) for m, a in zip(p["mu"], p["alpha"], strict=True))
            + p["bulk"] / 2 * np.log(J) ** 2
        ),
        "arruda-boyce": lambda: (
            p["mu"]
            * sum(c / p["locking"] ** (2 * i) * (i1 ** (i + 1) - 3 ** (i + 1)) for i, c in enumerate(AB))
            + p["bulk"] / 2 * np.log(J) ** 2
        ),
        "yeoh": lambda: (
            p["mu"] / 2 * ((i1 - 3) + p["stiffening"] * (i1 - 3) ** 2) + p["bulk"] / 2 * np.log(J) ** 2
        ),
        "stiffening-neo-hookean": lambda: (
            p["mu"] / 2 * ((I1 - 3) + p["stiffening"] * (i1 - 3) ** 2)
            - p["mu"] * np.log(J)
            + p["lam"] / 2 * np.log(J) ** 2
        ),
        "eight-chain": lambda: (
            p["mu"] * langevin_chains(i1, float(p["locking"])) + p["bulk"] / 2 * np.log(J) ** 2
        ),
    }
    return forms[material.law]()


def langevin_chains(i1: np.ndarray, locking: float) -> np.ndarray:
    """Energy of eight chains over their modulus at rest, by quadrature of the inverse Langevin function."""

    def tension(x: float) -> float:
        return float(brentq(lambda b: 1 / np.tanh(b) - 1 / b - x, 2.9 * x, 3 * x / (1 - x), xtol=1e-14))

    start = 1 / locking
    scale = 3 * locking / tension(start)
    ends = np.sqrt(np.atleast_1d(i1) / 3) / locking
    found = [scale * quad(tension, start, x, epsabs=1e-14, epsrel=1e-12)[0] for x in ends.ravel()]
    return np.reshape(found, np.shape(i1))


def slope(function: Callable[[np.ndarray], np.ndarray], F: np.ndarray, h: float = 1e-3) -> np.ndarray:
    """d function / dF at F (3, 3) by central differences of fourth order, shape (3, 3, *value.shape)."""
    step = h * np.eye(9).reshape(9, 3, 3)
    parts = [function(F + k * step) for k in (-2, -1, 1, 2)]
    return ((parts[0] - parts[3] + 8 * (parts[2] - parts[1])) / (12 * h)).reshape(3, 3, *parts[0].shape[1:])
