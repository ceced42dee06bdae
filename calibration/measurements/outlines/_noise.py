"""Noise model of a traced outline: error correlated along the contour, and registration of the photograph.

Contour error along the normal: C_ij = sd^2 exp(-(s_i - s_j)^2 / (2 l^2)) on each edge (`measured/FORMAT.md`),
plus white noise of FLOOR sd. Without it this kernel implies that neighbouring points agree to less than a
micrometre, so that the likelihood is sensitive to the roughness of any mesh or tracing. FLOOR = 0.02 has the
largest likelihood for nine clean beams simulated by another solver; their reduced chi-square is then near 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky

from calibration._numerics import arc_length, gaussian_correlation
from calibration.experiment.model import Registration, TracedOutline
from calibration.measurements.outlines._edges import Projection

Array = NDArray[np.float64]

FLOOR = 0.02
DEGREE = 9


def contour_root(outline: TracedOutline) -> Array:
    """Lower Cholesky factor of the contour error's covariance [m], shape (k, k), upper edge first."""
    blocks = []
    for edge in (outline.upper, outline.lower):
        kernel = gaussian_correlation(arc_length(edge), outline.correlation)
        blocks.append(outline.sd**2 * (kernel + FLOOR**2 * np.eye(len(edge))))
    return np.asarray(cholesky(block_diag(*blocks), lower=True))


def smooth_basis(outline: TracedOutline) -> Array:
    """Orthonormal polynomials along each edge, shape (k, m).

    Away from the clamps the effect of a parameter is smooth, in contrast to the oscillations of elements. The
    likelihood is sensitive to oscillations of 2 micrometres, by which a parameter would seem identified.
    """
    blocks = []
    for edge in (outline.upper, outline.lower):
        s = arc_length(edge)
        degree = min(DEGREE, len(s) // 3)
        columns = np.polynomial.legendre.legvander(2.0 * s / s[-1] - 1.0, degree)
        blocks.append(np.linalg.qr(columns)[0])
    return np.asarray(block_diag(*blocks))


def registration_columns(projection: Projection, registration: Registration) -> Array:
    """Change of the distances by one sd of shift x, shift z, roll and scale [m], shape (k, 4)."""
    n, q = projection.normal, projection.nearest
    return np.column_stack(
        [
            registration.shift * n[:, 0],
            registration.shift * n[:, 1],
            registration.roll * (n[:, 1] * q[:, 0] - n[:, 0] * q[:, 1]),
            registration.scale * (n * q).sum(axis=1),
        ]
    )


@dataclass(frozen=True, eq=False)
class Nuisances:
    """Standard normal nuisances b that enter whitened residuals linearly: r = r0 - columns b.

    Attributes
    ----------
    names : names of the nuisances, (m,).
    columns : shape (k, m).
    """

    names: tuple[str, ...]
    columns: Array

    def estimate(self, whitened: Array) -> Array:
        """Most likely b (..., m) for residuals r0 (..., k)."""
        normal = self.columns.T @ self.columns + np.eye(len(self.names))
        return np.asarray(np.linalg.solve(normal, (whitened @ self.columns).T).T)

    def profile(self, whitened: Array) -> Array:
        """Residuals without the most likely b, followed by b, shape (..., k + m).

        The sum of squares is the chi-square of r0 under the covariance I + columns columns^T.
        """
        b = self.estimate(whitened)
        return np.concatenate([whitened - b @ self.columns.T, b], axis=-1)


def sentence(outlines: Sequence[TracedOutline], uncorrected: str) -> str:
    """Description of the noise, for reports.

    uncorrected : reason why the mesh error is not corrected; "" if it is.
    """
    from calibration.pages import significant

    def span(values: list[float]) -> str:
        low, high = significant(min(values), 2), significant(max(values), 2)
        return low if low == high else f"{low} to {high}"

    sd, correlation = (span([1e3 * getattr(o, name) for o in outlines]) for name in ("sd", "correlation"))
    registration = [o.registration.plus(o.shared) for o in outlines]
    shift = span([1e3 * r.shift for r in registration])
    roll = span([float(np.degrees(r.roll)) for r in registration])
    scale = span([100.0 * r.scale for r in registration])
    text = (
        f"{len(outlines)} photographs; the contour's error {sd} mm, correlated over {correlation} mm; the"
        f" position of a photograph: {shift} mm, {roll}°, {scale} % of scale; section, free length and"
        " density as the lab states them with a standard deviation."
    )
    if uncorrected:
        return f"{text} The mesh's error is not corrected: {uncorrected}."
    return f"{text} The mesh's error is corrected by a finer mesh; part of the correction is left as noise."
