"""Neo-Hookean that stiffens with stretch: Yeoh's second term added to the coupled neo-Hookean energy.

    Psi = mu/2 (I1 - 3) - mu ln J + lam/2 (ln J)^2 + mu/2 stiffening (I1bar - 3)^2

with I1bar = J^(-2/3) I1. mu, lam [Pa]; stiffening [-] is not negative. Without stiffening it is the law
`neo-hookean` with the same volumetric part, unlike `yeoh`, so that a diagnosis can nest stiffening in the
fitted law. Small strain: G = mu, K = lam + 2 mu/3 for any stiffening. Stress-free at rest. Not among the
paper's laws.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws import yeoh
from tisim.laws._energy import by_invariants, first_isochoric, ti
from tisim.laws._law import Law, Moduli, scalar
from tisim.laws.neo_hookean import energy as coupled


@ti.func
def energy(I1, I2, J, prm: ti.template()):
    mu = prm[0]
    stiffening = prm[1]
    i1, a = first_isochoric(I1, J)
    excess = i1 - 3.0
    further = by_invariants(
        0.5 * mu * stiffening * excess * excess, mu * stiffening * excess, mu * stiffening, i1, a, J
    )
    return coupled(I1, I2, J, prm) + further


LAW = Law(
    name="stiffening-neo-hookean",
    title="Neo-Hookean, stiffening",
    parameters={"mu": ("Pa", "scalar"), "stiffening": ("-", "scalar"), "lam": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=energy,
    pack=lambda p: (scalar(p, "mu"), scalar(p, "stiffening")),
    kappa=lambda p: scalar(p, "lam"),
    moduli=lambda p: Moduli(
        shear_modulus=scalar(p, "mu"), bulk_modulus=scalar(p, "lam") + 2.0 * scalar(p, "mu") / 3.0
    ),
    from_moduli=lambda shear, bulk: {"mu": shear, "stiffening": 0.0, "lam": bulk - 2.0 * shear / 3.0},
    fault=yeoh.LAW.fault,
    examples=({"mu": 3e4, "stiffening": 0.05, "lam": 1.5e6},),
)
