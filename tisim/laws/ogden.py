"""Ogden, N terms, isochoric plus volumetric.

    Psi = sum_p mu_p/alpha_p (l1b^alpha_p + l2b^alpha_p + l3b^alpha_p - 3) + K/2 (ln J)^2,
    lib = J^(-1/3) li

mu [Pa] and alpha [-]: series of N terms; bulk = K [Pa]. Small strain: G = 1/2 sum mu_p alpha_p, K.
The paper prints principal stretches li in place of lib (eq. Psi_Ogden); that form is not stress-free at
rest: its stress there is sum mu_p times the identity. At J = 1 the two energies agree, and the printed
stress is that of this law plus a pressure sum mu_p (l1^alpha_p + l2^alpha_p + l3^alpha_p)/3 times F^-T.
SOFA (from v25.12): `Ogden`, ParameterSet "mu1 alpha K" of one term,
mu1/alpha^2 (J^(-alpha/3) tr C^(alpha/2) - 3) + K/2 (ln J)^2: its mu1 is alpha times the mu of this law.
Older SOFA computes a stress that is not the derivative of its energy (SOFA issues 5733, 4605).
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import ti
from tisim.laws._law import Law, Moduli, Parameters, scalar, series


@ti.func
def energy(l1, l2, l3, prm: ti.template()):
    """10-vector of W = sum mu/alpha (sum exp(alpha (e_i - m)) - 3), with e_i = ln li and their mean m."""
    e = ti.Vector([ti.log(l1), ti.log(l2), ti.log(l3)])
    e -= (e[0] + e[1] + e[2]) / 3.0
    w = 0.0
    g = ti.Vector([0.0, 0.0, 0.0])  # dW/d(ln li)
    h = ti.Vector([0.0, 0.0, 0.0])  # diagonal of the second derivative in ln li
    o = ti.Vector([0.0, 0.0, 0.0])  # off-diagonals 12, 13, 23
    for p in range(ti.cast(prm[0], ti.i32)):
        mu = prm[1 + 2 * p]
        alpha = prm[2 + 2 * p]
        t = ti.Vector([ti.exp(alpha * e[0]), ti.exp(alpha * e[1]), ti.exp(alpha * e[2])])
        s = (t[0] + t[1] + t[2]) / 3.0
        w += mu / alpha * (3.0 * s - 3.0)
        g += mu * (t - s)
        # d/d(ln lj) of mu (t_i - s) = mu alpha (t_i d_ij - (t_i + t_j)/3 + s/3)
        h += mu * alpha * (t / 3.0 + s / 3.0)
        o += mu * alpha / 3.0 * ti.Vector([s - t[0] - t[1], s - t[0] - t[2], s - t[1] - t[2]])
    return ti.Vector(
        [
            w,
            g[0] / l1,
            g[1] / l2,
            g[2] / l3,
            (h[0] - g[0]) / (l1 * l1),
            (h[1] - g[1]) / (l2 * l2),
            (h[2] - g[2]) / (l3 * l3),
            o[0] / (l1 * l2),
            o[1] / (l1 * l3),
            o[2] / (l2 * l3),
        ]
    )


def _pack(p: Parameters) -> list[float]:
    terms = list(zip(series(p, "mu"), series(p, "alpha"), strict=True))
    return [len(terms), *(number for term in terms for number in term)]


LAW = Law(
    name="ogden",
    title="Ogden",
    parameters={"mu": ("Pa", "series"), "alpha": ("-", "series"), "bulk": ("Pa", "scalar")},
    family="principal",
    theta="log",
    energy=energy,
    pack=_pack,
    kappa=lambda p: scalar(p, "bulk"),
    moduli=lambda p: Moduli(
        shear_modulus=0.5 * float(series(p, "mu") @ series(p, "alpha")),
        bulk_modulus=scalar(p, "bulk"),
    ),
    from_moduli=lambda shear, bulk: {"mu": (shear / 2.0,), "alpha": (4.0,), "bulk": bulk},
    fault=lambda p: (
        "" if series(p, "alpha").all() else "parameter alpha [-]: expected exponents other than 0"
    ),
)
