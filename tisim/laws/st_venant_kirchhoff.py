"""St Venant-Kirchhoff.

    Psi = lam/2 tr(E)^2 + mu tr(E^2),   E = (C - I)/2        (paper, eq. Psi_StVK)

mu, lam [Pa]: Lame parameters. Small strain: G = mu, K = lam + 2 mu/3. Stress-free at rest.
In invariants tr E = (I1 - 3)/2 and tr(E^2) = (I1^2 - 2 I2 - 2 I1 + 3)/4. The law softens in compression, and
its stress vanishes as the volume tends to 0: it is not suitable for deep indentation.
SOFA: `StVenantKirchhoff`, ParameterSet "mu lambda", the same energy.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import ti
from tisim.laws._lame import law_of_lame
from tisim.laws._law import scalar


@ti.func
def energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    mu = prm[0]
    return ti.Vector(
        [
            mu * (I1 * I1 - 2.0 * I2 - 2.0 * I1 + 3.0) / 4.0,
            mu * (I1 - 1.0) / 2.0,
            -mu / 2.0,
            0.0,
            mu / 2.0,
            0.0,
            0.0,
            0.0,
            0.0,
            0.0,
        ]
    )


LAW = law_of_lame(
    name="st-venant-kirchhoff",
    title="St Venant-Kirchhoff",
    theta="trace",
    energy=energy,
    kappa=lambda p: scalar(p, "lam"),
)
