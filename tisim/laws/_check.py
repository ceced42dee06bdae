"""Evaluation of a law at given deformations, and checks of its consistency."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim.laws._law import Law, Parameters
from tisim.laws._registry import get

Array = NDArray[np.float64]

RATIOS = (5.0, 50.0, 1000.0)  # bulk over shear modulus of the default parameters of a check
STEP = 1e-3  # step of fourth-order difference quotients in F


def evaluate(law: str | Law, parameters: Parameters, F: ArrayLike) -> tuple[Array, Array, Array]:
    """Energy, stress and tangent of a law, by the kernels that the solvers use.

    Parameters
    ----------
    law : str or Law
        Name of a registered law, or a law.
    parameters : mapping
        Parameters of the law.
    F : array_like of float, shape (n, 3, 3)
        Deformation gradients, det F above 0.

    Returns
    -------
    psi : ndarray, shape (n,)
        Energy per rest volume [J/m3] with the volumetric part, zero at rest.
    P : ndarray, shape (n, 3, 3)
        First Piola-Kirchhoff stress dpsi/dF [Pa].
    A : ndarray, shape (n, 3, 3, 3, 3)
        Tangent A_iKjL = d2psi / dF_iK dF_jL [Pa], not projected.

    Raises
    ------
    ValueError
        For an unknown law, invalid parameters, a wrong shape, or det F not above 0, in one sentence.
    """
    law = _law(law)
    law.check(parameters)
    gradients = np.ascontiguousarray(F, dtype=np.float64)
    if gradients.ndim != 3 or gradients.shape[1:] != (3, 3):
        raise ValueError(f"F: expected shape (n, 3, 3), got {gradients.shape}")
    bad = ~(np.linalg.det(gradients) > 0.0)  # true for NaN as well
    if bad.any():
        raise ValueError(
            f"F: expected det F > 0, which fails for {int(bad.sum())} of {len(bad)},"
            f" first at index {bad.argmax()}"
        )
    from tisim.kernels.elements import evaluation_kernel  # imports Taichi

    n = len(gradients)
    psi, P, A = np.empty(n), np.empty((n, 3, 3)), np.empty((n, 9, 9))
    packed = np.ascontiguousarray(law.pack(parameters), dtype=np.float64)
    none = np.zeros((1, 1, 1))
    evaluation_kernel(law)(gradients, packed, none, law.kappa(parameters), psi, P, A)
    return psi, P, A.reshape(n, 3, 3, 3, 3)


@dataclass(frozen=True)
class LawReport:
    """Largest errors of a law over the deformations and parameters of a check; see `check_law`.

    Attributes
    ----------
    law : str
        Name of the law.
    errors : dict of str to float
        Largest error of each property, relative to its scale.
    limits : dict of str to float
        Largest allowed error of each property.
    """

    law: str
    errors: dict[str, float]
    limits: dict[str, float]

    @property
    def faults(self) -> tuple[str, ...]:
        """One sentence for each property that fails."""
        return tuple(
            f"{self.law}: {name}: error {error:.1e}, expected at most {self.limits[name]:.0e}"
            for name, error in self.errors.items()
            if not error <= self.limits[name]
        )

    @property
    def ok(self) -> bool:
        """True if every property holds."""
        return not self.faults

    def __str__(self) -> str:
        lines = [
            f"{name:42s} {error:8.1e}  (at most {self.limits[name]:.0e})"
            for name, error in self.errors.items()
        ]
        return "\n".join([f"{self.law}: {'sound' if self.ok else 'NOT sound'}", *lines])


_LIMITS = {
    "stress is the energy's derivative": 1e-6,
    "tangent is the stress's derivative": 1e-6,
    "tangent has major symmetry": 1e-10,
    "energy is frame indifferent": 1e-10,
    "stress is frame indifferent": 1e-9,
    "rest is free of energy and stress": 1e-10,
    "tangent at rest has the stated moduli": 1e-9,
    "parameters of moduli have these moduli": 1e-9,
}


def check_law(
    law: str | Law,
    *,
    parameters: Sequence[Parameters] | None = None,
    deformations: int = 12,
    seed: int = 0,
) -> LawReport:
    """Check the consistency of a law by finite differences and rotations.

    The stress is compared with the energy, the tangent with the stress, and the law before and after a
    rotation of space, at random deformations: large, small, and with two or three (nearly) equal principal
    stretches. The rest state and the small-strain moduli are checked too.

    Parameters
    ----------
    law : str or Law
        Name of a registered law, or a law.
    parameters : sequence of mappings, optional
        Parameters at which to check; by default those of a shear modulus of 30 kPa and bulk moduli of 5, 50
        and 1000 times that, and the law's `examples`.
    deformations : int
        Number of deformations for each set of parameters.
    seed : int
        Seed of the random deformations.

    Returns
    -------
    LawReport
        Prints as a table; `faults` lists the properties that fail.

    Raises
    ------
    ValueError
        For an unknown law or invalid parameters.
    """
    law = _law(law)
    plain = [law.from_moduli(3e4, ratio * 3e4) for ratio in RATIOS]
    chosen = [*plain, *law.examples] if parameters is None else parameters
    rng = np.random.default_rng(seed)
    errors = dict.fromkeys(_LIMITS, 0.0)

    def note(name: str, error: Any, scale: float) -> None:
        found = float(np.abs(error).max()) / scale
        errors[name] = max(errors[name], found if np.isfinite(found) else np.inf)

    for one in chosen:
        law.check(one)
        moduli = law.moduli(one)
        G, K = moduli.shear_modulus, moduli.bulk_modulus

        def at(F: Array, one: Parameters = one) -> tuple[Array, Array, Array]:
            return evaluate(law, one, F.reshape(-1, 3, 3))

        for F in _deformations(rng, deformations):
            psi, P, A = (v[0] for v in at(F))
            # rounding of energies on the scale of the bulk modulus limits the resolution of small stresses
            size = np.abs(P).max() + 1e-4 * K
            note("stress is the energy's derivative", _slope(lambda G: at(G)[0], F) - P, size)
            slope = np.einsum("jLiK->iKjL", _slope(lambda G: at(G)[1], F))
            note("tangent is the stress's derivative", slope - A, np.abs(A).max())
            note("tangent has major symmetry", A - np.einsum("iKjL->jLiK", A), np.abs(A).max())
            Q = _rotation(rng)
            turned, stress, _ = (v[0] for v in at(Q @ F))
            note("energy is frame indifferent", turned - psi, abs(psi) + 1e-3 * K)
            note("stress is frame indifferent", stress - Q @ P, np.abs(P).max() + 1e-2 * K)
        psi, P, A = (v[0] for v in at(np.eye(3)))
        note("rest is free of energy and stress", [psi, *P.ravel()], G)
        unit = np.eye(3)
        elastic = (K - 2.0 * G / 3.0) * np.einsum("iK,jL->iKjL", unit, unit) + G * (
            np.einsum("ij,KL->iKjL", unit, unit) + np.einsum("iL,Kj->iKjL", unit, unit)
        )
        note("tangent at rest has the stated moduli", A - elastic, G)
        back = law.moduli(law.from_moduli(G, K))
        note("parameters of moduli have these moduli", back.shear_modulus / G - 1.0, 1.0)
        note("parameters of moduli have these moduli", back.bulk_modulus / K - 1.0, 1.0)
    return LawReport(law.name, errors, dict(_LIMITS))


def _law(law: str | Law) -> Law:
    return law if isinstance(law, Law) else get(law)


def _deformations(rng: np.random.Generator, count: int) -> list[Array]:
    """Deformation gradients R diag(stretches) Q of four types in turn, see `check_law`."""
    found = []
    for k in range(count):
        stretches = rng.uniform(0.6, 1.8, 3)
        if k % 4 == 1:
            stretches = 1.0 + 10.0 ** rng.uniform(-6, -2) * rng.uniform(-1.0, 1.0, 3)
        elif k % 4 == 2:
            stretches[2] = stretches[0] + rng.choice([0.0, 1e-8, 1e-6, 1e-5])
        elif k % 4 == 3:
            stretches = stretches[0] + rng.choice([0.0, 1e-8, 1e-6, 1e-5]) * np.arange(3.0)
        found.append(_rotation(rng) @ np.diag(stretches) @ _rotation(rng))
    return found


def _rotation(rng: np.random.Generator) -> Array:
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return np.asarray(q if np.linalg.det(q) > 0.0 else -q)


def _slope(function: Callable[[Array], Array], F: Array) -> Array:
    """Derivative by F (3, 3) by central differences of fourth order, shape (3, 3, *value's shape)."""
    steps = STEP * np.eye(9).reshape(9, 3, 3)
    parts = [function(F + k * steps) for k in (-2, -1, 1, 2)]
    slope = (parts[0] - parts[3] + 8.0 * (parts[2] - parts[1])) / (12.0 * STEP)
    return np.asarray(slope.reshape(3, 3, *parts[0].shape[1:]))
