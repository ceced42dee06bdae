"""Neo-Hookean, compressible.

    Psi = mu/2 (I1 - 3) - mu ln J + lam/2 (ln J)^2           (paper, eq. Psi_NH)

mu, lam [Pa]: Lame parameters. Small strain: G = mu, K = lam + 2 mu/3. Stress-free at rest.
SOFA: `NeoHookean`, ParameterSet "mu lambda", the same energy.
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
            mu * (0.5 * (I1 - 3.0) - ti.log(J)),
            0.5 * mu,
            0.0,
            -mu / J,
            0.0,
            0.0,
            mu / (J * J),
            0.0,
            0.0,
            0.0,
        ]
    )


LAW = law_of_lame(
    name="neo-hookean",
    title="Neo-Hookean",
    theta="log",
    energy=energy,
    kappa=lambda p: scalar(p, "lam"),
)
