"""Hyperelastic laws for the references, in the form FElupe's `SolidBody` takes; SI units.

FElupe's mixed principle (`felupe.NearlyIncompressible`) is Pi = int psi(F) + U(J') + p (J - J') dV.
Neo-Hookean: psi = mu/2 (I1 - 3) - mu ln J, U = lam/2 ln^2 J' (lam = K - 2 mu/3), the paper's energy.
Ogden: psi = sum mu_p/alpha_p (sum_a lbar_a^alpha_p - 3), lbar = J^(-1/3) lambda, U = K/2 ln^2 J';
small-strain shear modulus G = sum mu_p alpha_p / 2. Mooney-Rivlin with C10 and C01 is Ogden with
mu = (2 C10, -2 C01), alpha = (2, -2). FElupe's own Ogden needs tensortrax; this one needs NumPy.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import felupe as fe
import numpy as np

Array = np.ndarray[Any, Any]


class OgdenIsochoric(fe.ConstitutiveMaterial):
    """Isochoric Ogden law by spectral decomposition of C, plus bulk/2 ln^2 J; mu, bulk in Pa."""

    parallel = False

    def __init__(self, mu: Sequence[float], alpha: Sequence[float], bulk: float = 0.0) -> None:
        self.mu, self.alpha, self.bulk = tuple(mu), tuple(alpha), bulk
        self.x = [np.eye(3), np.zeros(0)]

    def _principal(self, F: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
        """F as (..., 3, 3), eigenvalues of C, eigenvectors, s_a = 2 dW/dc_a, 2 ds_a/dc_b, limit."""
        F = np.moveaxis(F, (0, 1), (-2, -1))  # (q, c, i, J)
        c, N = np.linalg.eigh(np.swapaxes(F, -1, -2) @ F)
        lnc = np.log(c)
        e = lnc - lnc.mean(-1, keepdims=True)  # 2 ln lbar
        tau = np.zeros_like(c) + self.bulk * lnc.sum(-1, keepdims=True) / 2  # dW/d(ln lambda_a)
        dtau = np.full((*c.shape, 3), self.bulk)
        for mu, alpha in zip(self.mu, self.alpha, strict=True):
            b = mu * np.exp(0.5 * alpha * e)
            tau += b - b.mean(-1, keepdims=True)
            pairs = b[..., :, None] + b[..., None, :] - b.mean(-1)[..., None, None]
            dtau += alpha * (b[..., None] * np.eye(3) - pairs / 3)
        s = tau / c
        ds = (dtau / c[..., :, None] - 2 * s[..., :, None] * np.eye(3)) / c[..., None, :]
        return F, c, N, s, ds, self._shear(c, s, ds)

    @staticmethod
    def _shear(c: Array, s: Array, ds: Array) -> Array:
        """(s_a - s_b) / (c_a - c_b), by its limit where the two stretches meet."""
        dc = c[..., :, None] - c[..., None, :]
        near = np.abs(dc) < 1e-5 * c[..., :, None]
        diagonal = np.einsum("...aa->...a", ds)
        limit = (diagonal[..., :, None] + diagonal[..., None, :]) / 4 - (ds + np.swapaxes(ds, -1, -2)) / 4
        return np.where(near, limit, (s[..., :, None] - s[..., None, :]) / np.where(near, 1.0, dc))

    def _gradient(self, x: list[Array]) -> list[Array]:
        F, _, N, s, _, _ = self._principal(x[0])
        S = np.einsum("...ia,...a,...ja->...ij", N, s, N)
        return [np.moveaxis(F @ S, (-2, -1), (0, 1)), x[-1]]

    def _hessian(self, x: list[Array]) -> list[Array]:
        F, _, N, s, ds, shear = self._principal(x[0])
        shape = F.shape[:-2]
        G = (F @ N).reshape(-1, 3, 3)  # spatial principal axes times stretch, columns a
        N, s = N.reshape(-1, 3, 3), s.reshape(-1, 3)
        local = np.zeros((len(N), 3, 3, 3, 3))  # 2 dS/dC in principal axes
        for a in range(3):
            for b in range(3):
                local[:, a, a, b, b] += ds.reshape(-1, 3, 3)[:, a, b]
                if a != b:
                    local[:, a, b, a, b] += shear.reshape(-1, 3, 3)[:, a, b]
                    local[:, a, b, b, a] += shear.reshape(-1, 3, 3)[:, a, b]
        GN = np.einsum("xia,xJb->xabiJ", G, N).reshape(-1, 9, 9)
        A = np.swapaxes(GN, 1, 2) @ local.reshape(-1, 9, 9) @ GN
        S = np.einsum("xia,xa,xja->xij", N, s, N)
        A = A.reshape(-1, 3, 3, 3, 3) + np.einsum("ik,xJL->xiJkL", np.eye(3), S)
        return [np.moveaxis(A.reshape(*shape, 3, 3, 3, 3), (-4, -3, -2, -1), (0, 1, 2, 3))]


def log_volumetric(material: Any, modulus: float) -> Any:
    """`material` with the volumetric energy modulus/2 ln^2 J on FElupe's field of volume ratios."""
    return fe.NearlyIncompressible(
        material,
        bulk=modulus,
        dUdJ=lambda J, k: k * np.log(J) / J,
        d2UdJdJ=lambda J, k: k * (1 - np.log(J)) / J**2,
    )


def mixed_law(law: str, bulk: float, **parameters: Any) -> Any:
    """Mixed FElupe law: "neo_hookean" (mu), "ogden" (mu, alpha) or "mooney_rivlin" (C10, C01)."""
    if law == "neo_hookean":
        mu = parameters["mu"]
        return log_volumetric(fe.NeoHookeCompressible(mu=mu), bulk - 2 * mu / 3)
    if law == "mooney_rivlin":
        parameters = {"mu": (2 * parameters["C10"], -2 * parameters["C01"]), "alpha": (2.0, -2.0)}
    return log_volumetric(OgdenIsochoric(parameters["mu"], parameters["alpha"]), bulk)
