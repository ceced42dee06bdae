"""Yeoh's law of second order, isochoric plus volumetric: Neo-Hookean that stiffens with stretch.

    Psi = mu/2 [(I1bar - 3) + stiffening (I1bar - 3)^2] + K/2 (ln J)^2

with I1bar = J^(-2/3) I1 (Yeoh, Rubber Chem. Technol. 63, 1990). mu, bulk = K [Pa]; stiffening [-] is not
negative, so that the energy is convex in I1bar. Small strain: G = mu, K for any stiffening.
Stress-free at rest. Not among the paper's laws.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import by_invariants, first_isochoric, ti
from tisim.laws._law import Law, Moduli, Parameters, scalar


@ti.func
def energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    mu = prm[0]
    stiffening = prm[1]
    i1, a = first_isochoric(I1, J)
    excess = i1 - 3.0
    slope = 0.5 * mu * (1.0 + 2.0 * stiffening * excess)
    w = 0.5 * mu * excess * (1.0 + stiffening * excess)
    return by_invariants(w, slope, mu * stiffening, i1, a, J)


def _fault(parameters: Parameters) -> str:
    value = scalar(parameters, "stiffening")
    return "" if value >= 0.0 else f"stiffening must not be negative, got {value:g}"


LAW = Law(
    name="yeoh",
    title="Yeoh",
    parameters={"mu": ("Pa", "scalar"), "stiffening": ("-", "scalar"), "bulk": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=energy,
    pack=lambda p: (scalar(p, "mu"), scalar(p, "stiffening")),
    kappa=lambda p: scalar(p, "bulk"),
    moduli=lambda p: Moduli(shear_modulus=scalar(p, "mu"), bulk_modulus=scalar(p, "bulk")),
    from_moduli=lambda shear, bulk: {"mu": shear, "stiffening": 0.0, "bulk": bulk},
    fault=_fault,
    examples=({"mu": 3e4, "stiffening": 0.05, "bulk": 1.5e6},),
)
