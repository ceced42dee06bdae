"""Arruda-Boyce (eight chains), five-term series, isochoric plus volumetric.

    Psi = mu sum_i C_i / L^(2i-2) (I1bar^i - 3^i) + K/2 (ln J)^2,
    C = 1/2, 1/20, 11/1050, 19/7000, 519/673750

mu, bulk = K [Pa]; locking = L, the locking stretch (free).
Small strain: G = 2 mu sum_i i C_i 3^(i-1) / L^(2i-2), K.
The paper prints I1 in place of I1bar (eq. Psi_AB); that form is not stress-free at rest: its stress there
is 2 dW/dI1 = G times the identity. At J = 1 the two energies agree, and the printed stress is that of this
law plus a pressure 2/3 dW/dI1 I1 times F^-T.
SOFA: `ArrudaBoyce`, ParameterSet "mu K": this energy with L^2 = 8, so G = 1.0851 mu.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import by_invariants, first_isochoric, ti
from tisim.laws._law import Law, Moduli, Parameters, scalar

C = (1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673750.0)
SOFA_LOCKING = 8.0**0.5


@ti.func
def energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    mu = prm[0]
    r = 1.0 / (prm[1] * prm[1])
    i1, a = first_isochoric(I1, J)
    w = 0.0
    d = 0.0
    dd = 0.0
    for k in ti.static(range(5)):
        n = k + 1
        c = mu * C[k] * r**k
        w += c * (i1**n - 3.0**n)
        d += c * n * i1**k
        if ti.static(k > 0):
            dd += c * n * k * i1 ** (k - 1)
    return by_invariants(w, d, dd, i1, a, J)


def _shear_factor(locking: float) -> float:
    return 2.0 * sum((i + 1) * c * 3.0**i / locking ** (2 * i) for i, c in enumerate(C))


def _moduli(p: Parameters) -> Moduli:
    return Moduli(
        shear_modulus=scalar(p, "mu") * _shear_factor(scalar(p, "locking")), bulk_modulus=scalar(p, "bulk")
    )


LAW = Law(
    name="arruda-boyce",
    title="Arruda-Boyce",
    parameters={"mu": ("Pa", "scalar"), "locking": ("-", "scalar"), "bulk": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=energy,
    pack=lambda p: (scalar(p, "mu"), scalar(p, "locking")),
    kappa=lambda p: scalar(p, "bulk"),
    moduli=_moduli,
    from_moduli=lambda shear, bulk: {
        "mu": shear / _shear_factor(SOFA_LOCKING),
        "locking": SOFA_LOCKING,
        "bulk": bulk,
    },
    fault=lambda p: "" if scalar(p, "locking") > 1.0 else "parameter locking [-]: expected a stretch above 1",
)
