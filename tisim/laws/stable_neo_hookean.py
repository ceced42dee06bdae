"""Stable Neo-Hookean (Smith et al. 2018).

    Psi = mu/2 (I1 - 3) - mu (J - 1) + (lam + mu)/2 (J - 1)^2   (paper, eq. Psi_SNH)

mu, lam [Pa]: Lame parameters. Small strain: G = mu, K = lam + 2 mu/3. Stress-free at rest, and finite for
inverted elements; tisim's line search nevertheless keeps J > 0.
SOFA: `StableNeoHookean`, ParameterSet "mu lambda": the same energy up to a constant, written as
1/2 [mu (I1 - 3) + (lam + mu)(J - a)^2] with a = 1 + mu/(lam + mu).
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
    return ti.Vector([mu * (0.5 * (I1 - 3.0) - (J - 1.0)), 0.5 * mu, 0.0, -mu, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


LAW = law_of_lame(
    name="stable-neo-hookean",
    title="Stable Neo-Hookean",
    theta="linear",
    energy=energy,
    kappa=lambda p: scalar(p, "lam") + scalar(p, "mu"),
)
