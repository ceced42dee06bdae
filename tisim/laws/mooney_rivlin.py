"""Mooney-Rivlin, isochoric plus volumetric.

    Psi = C10 (I1bar - 3) + C01 (I2bar - 3) + K/2 (ln J)^2     (paper, eq. Psi_MR, minus a constant)

with I1bar = J^(-2/3) I1 and I2bar = J^(-4/3) I2. c10, c01, bulk = K [Pa].
Small strain: G = 2 (C10 + C01), K. Stress-free at rest.
SOFA: `MooneyRivlin`, ParameterSet "C10 C01 K"; its forces derive from this energy (the energy that it reports
differs: integer division in its exponents).
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import ti
from tisim.laws._law import Law, Moduli, scalar


@ti.func
def energy(I1, I2, J, prm: ti.template()):
    c10 = prm[0]
    c01 = prm[1]
    a = ti.exp(-2.0 / 3.0 * ti.log(J))
    b = a * a
    i1 = a * I1
    i2 = b * I2
    return ti.Vector(
        [
            c10 * (i1 - 3.0) + c01 * (i2 - 3.0),
            c10 * a,
            c01 * b,
            (-2.0 / 3.0 * c10 * i1 - 4.0 / 3.0 * c01 * i2) / J,
            0.0,
            0.0,
            (10.0 / 9.0 * c10 * i1 + 28.0 / 9.0 * c01 * i2) / (J * J),
            0.0,
            -2.0 / 3.0 * c10 * a / J,
            -4.0 / 3.0 * c01 * b / J,
        ]
    )


LAW = Law(
    name="mooney-rivlin",
    title="Mooney-Rivlin",
    parameters={"c10": ("Pa", "scalar"), "c01": ("Pa", "scalar"), "bulk": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=energy,
    pack=lambda p: (scalar(p, "c10"), scalar(p, "c01")),
    kappa=lambda p: scalar(p, "bulk"),
    moduli=lambda p: Moduli(
        shear_modulus=2.0 * (scalar(p, "c10") + scalar(p, "c01")),
        bulk_modulus=scalar(p, "bulk"),
    ),
    from_moduli=lambda shear, bulk: {"c10": 0.4 * shear, "c01": 0.1 * shear, "bulk": bulk},
)
