"""St Venant-Kirchhoff.

    Psi = lam/2 tr(E)^2 + mu tr(E^2),   E = (C - I)/2        (paper, eq. Psi_StVK)

mu, lam [Pa]: Lame parameters. Small strain: G = mu, K = lam + 2 mu/3. Stress-free at rest.
In invariants tr E = (I1 - 3)/2 and tr(E^2) = (I1^2 - 2 I2 - 2 I1 + 3)/4. It softens in compression and
its stress vanishes again before a volume is crushed to nothing: not for deep pokes.
SOFA: `StVenantKirchhoff`, ParameterSet "mu lambda", the same energy.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy`; its annotations mean something to Taichi only)

from __future__ import annotations

import numpy as np

from tisim.laws._energy import ti
from tisim.laws._law import Law, Moduli, scalar


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


LAW = Law(
    name="st-venant-kirchhoff",
    title="St Venant-Kirchhoff",
    parameters={"mu": ("Pa", "scalar"), "lam": ("Pa", "scalar")},
    family="invariant",
    theta="trace",
    energy=energy,
    pack=lambda p: np.array([scalar(p, "mu")]),
    kappa=lambda p: scalar(p, "lam"),
    moduli=lambda p: Moduli(
        shear_modulus=scalar(p, "mu"), bulk_modulus=scalar(p, "lam") + 2.0 * scalar(p, "mu") / 3.0
    ),
    from_moduli=lambda shear, bulk: {"mu": shear, "lam": bulk - 2.0 * shear / 3.0},
)
