"""Response of a material to given deformations over time, without a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tisim import laws
from tisim.material import Material
from tisim.problems._checks import check_material

Array = NDArray[np.float64]


class MaterialPoints:
    """Points of a material, initially at rest, each driven by its deformation gradient.

    A step consists of `begin(dt)`, any number of calls of `evaluate(F)`, and `accept(F)`; without the last it
    has no effect.

    Parameters
    ----------
    material : Material
    count : int
        Number of points.

    Attributes
    ----------
    shear_modulus : float
        Small-strain shear modulus of the law [Pa].

    Raises
    ------
    ValueError
        For an unknown law, or invalid parameters or parts, in one sentence.
    """

    def __init__(self, material: Material, count: int = 1) -> None:
        # Taichi is imported when a material is first evaluated
        from tisim.discretisation.packed import features_of, history_of, pack
        from tisim.kernels.elements import evaluation_kernel
        from tisim.kernels.points import isochoric_kernels

        check_material(material)
        law = laws.get(material.law)
        features = features_of(material)
        self._evaluate = evaluation_kernel(law, features)
        self._isochoric = isochoric_kernels(law, features)[1] if features.state_size else None
        self._prm, self._kappa = pack(material), law.kappa(material.parameters)
        self._tail = features.tail_size
        self._history = history_of(material, (1, count))
        self._count = count
        self.shear_modulus = law.moduli(material.parameters).shear_modulus
        self.begin(0.0)

    def begin(self, dt: float) -> None:
        """Begin a step of length dt [s]; 0 for an instantaneous step."""
        if self._history is not None:
            self._history.begin(dt)
            self._prm[len(self._prm) - self._tail] = self._history.scale

    def evaluate(self, F: ArrayLike) -> tuple[Array, Array, Array]:
        """Potential of the step psi (n,) [J/m3], stress P (n, 3, 3) and tangent A (n, 3, 3, 3, 3) [Pa].

        P = dpsi/dF, A = dP/dF at F (n, 3, 3), the deformation gradient at the end of the step; ValueError
        unless det F > 0.
        """
        n = self._count
        psi, P, A = np.empty(n), np.empty((n, 3, 3)), np.empty((n, 9, 9))
        self._evaluate(self._gradients(F), self._prm, self._state(), self._kappa, psi, P, A)
        return psi, P, A.reshape(n, 3, 3, 3, 3)

    def accept(self, F: ArrayLike) -> None:
        """Accept the step, which ends at F (n, 3, 3)."""
        if self._history is None:
            return
        n = self._count
        found = np.empty((1, n, 6)), np.empty((1, n, 6)), np.empty((1, n))
        assert self._isochoric is not None
        self._isochoric(self._gradients(F), self._prm, self._state(), *found)
        self._history.accept(found)
        self._prm[len(self._prm) - self._tail] = self._history.scale

    @property
    def dissipated(self) -> Array:
        """Energy dissipated so far [J/m3], shape (n,)."""
        return np.zeros(self._count) if self._history is None else self._history.dissipated[0]

    @property
    def stored(self) -> Array:
        """Energy stored in viscous terms in addition to the elastic energy [J/m3], shape (n,)."""
        return np.zeros(self._count) if self._history is None else self._history.stored()[0]

    def _gradients(self, F: ArrayLike) -> Array:
        gradients = np.ascontiguousarray(F, dtype=np.float64)
        if gradients.shape != (self._count, 3, 3):
            raise ValueError(f"F: expected shape ({self._count}, 3, 3), got {gradients.shape}")
        bad = ~(np.linalg.det(gradients) > 0.0)
        if bad.any():
            raise ValueError(f"F: expected det F > 0, which fails at index {int(bad.argmax())}")
        return gradients

    def _state(self) -> Array:
        return np.zeros((1, 1, 1)) if self._history is None else self._history.state


@dataclass(frozen=True, eq=False, kw_only=True)
class PointResponse:
    """Response of a material to deformations over time.

    Attributes
    ----------
    time : ndarray of float, shape (t,)
        Times [s].
    stress : ndarray of float, shape (t, n, 3, 3)
        First Piola-Kirchhoff stress [Pa].
    dissipated : ndarray of float, shape (t, n)
        Energy dissipated so far [J/m3].
    stored : ndarray of float, shape (t, n)
        Energy stored in viscous terms in addition to the elastic energy [J/m3].
    """

    time: Array
    stress: Array
    dissipated: Array
    stored: Array


def respond(material: Material, times: ArrayLike, F: ArrayLike) -> PointResponse:
    """Response of a material to a deformation given over time.

    Each time is the end of one step. The first step begins at rest at time 0; two equal times are a jump.

    Parameters
    ----------
    material : Material
    times : array_like of float, shape (t,)
        Times [s], not below 0 and never falling.
    F : array_like of float, shape (t, 3, 3) or (t, n, 3, 3)
        Deformation gradients of one point or of n points; det F above 0.

    Returns
    -------
    PointResponse

    Raises
    ------
    ValueError
        For times that fall or invalid deformations, in one sentence.
    """
    time, gradients = np.asarray(times, dtype=float), np.asarray(F, dtype=float)
    if gradients.ndim == 3:
        gradients = gradients[:, None]
    if time.ndim != 1 or gradients.shape != (len(time), *gradients.shape[1:2], 3, 3):
        raise ValueError(f"F: expected one deformation gradient a time, got shape {np.shape(F)}")
    if not np.isfinite(time).all() or (np.diff(time, prepend=0.0) < 0.0).any():
        raise ValueError(f"times: expected times from 0 s on that never fall, got {times!r}")
    points = MaterialPoints(material, gradients.shape[1])
    stress, dissipated, stored = [], [], []
    before = 0.0
    for moment, deformed in zip(time, gradients, strict=True):
        points.begin(float(moment - before))
        stress.append(points.evaluate(deformed)[1])
        points.accept(deformed)
        dissipated.append(points.dissipated)
        stored.append(points.stored)
        before = moment
    return PointResponse(
        time=time, stress=np.array(stress), dissipated=np.array(dissipated), stored=np.array(stored)
    )
