"""Eight Langevin chains (Arruda and Boyce, J. Mech. Phys. Solids 41, 1993), isochoric plus volumetric.

    Psi = mu 3 L / b0 [w(x) - w(x0)] + K/2 (ln J)^2,  w(x) = x b + ln(b / sinh b),  coth b - 1/b = x,
    x = (I1bar / 3)^(1/2) / L,  x0 = 1 / L,  b0 = b(x0)

mu, bulk = K [Pa]; locking = L, the stretch at which a chain is straight, above 1. mu is the small-strain
shear modulus for any locking stretch. Stress-free at rest. The five-term series of this energy is the paper's
`arruda-boyce`, whose stress is 1 % too small at 2/3 of the chains' length and 5 % at 3/4. Beyond the fraction
ENDS of their length, where it is 67 times that of Gaussian chains, the chains' force is extrapolated
linearly: a line search may evaluate it there, but chains in equilibrium there would have broken. Not among
the paper's laws.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles `energy` and interprets its annotations)

from __future__ import annotations

from tisim.laws._energy import by_invariants, first_isochoric, ti
from tisim.laws._law import Law, Moduli, Parameters, scalar

ENDS = 0.995  # fraction of the chains' length above which their force is extrapolated
STEPS = 4  # of Newton's method, from a Pade form with an error of 5 %
LARGEST = 1000.0  # locking stretch, beyond which the chains are Gaussian to rounding errors
SMALL = 0.1  # fraction of the chains' length below which w - w(x0) is a series, whose terms cancel nowhere


@ti.func
def _langevin(b):
    """Langevin function coth b - 1/b, and its derivative."""
    e = ti.exp(-2.0 * b)
    coth = (1.0 + e) / (1.0 - e)
    return coth - 1.0 / b, 1.0 / (b * b) - 4.0 * e / ((1.0 - e) * (1.0 - e))


@ti.func
def _chain(x):
    """w, b = dw/dx and db/dx."""
    inside = ti.min(x, ENDS)
    b = inside * (3.0 - inside * inside) / (1.0 - inside * inside)
    slope = 1.0
    for _ in ti.static(range(STEPS)):
        value, slope = _langevin(b)
        b -= (value - inside) / slope
    _, slope = _langevin(b)
    past = x - inside
    w = inside * b + ti.log(2.0 * b) - b - ti.log(1.0 - ti.exp(-2.0 * b))
    return w + past * (b + 0.5 * past / slope), b + past / slope, 1.0 / slope


@ti.func
def _small(i1, q):
    """(w(x) - w(x0)) / q for short chains, q = x0^2: 3/2 e + 9/20 q (u^2 - 1) + ..., u = i1 / 3 = 1 + e."""
    u, e = i1 / 3.0, (i1 - 3.0) / 3.0
    second, third, fourth = u + 1.0, u * u + u + 1.0, (u + 1.0) * (u * u + 1.0)
    return e * (1.5 + q * (0.45 * second + q * (297.0 / 1050.0 * third + q * 1539.0 / 7000.0 * fourth)))


@ti.func
def energy(I1, I2, J, prm: ti.template()):  # noqa: ARG001 - one signature for all laws
    x0 = 1.0 / prm[1]
    at_rest, b0, _ = _chain(x0)
    i1, a = first_isochoric(I1, J)
    x = ti.sqrt(i1 / 3.0) * x0
    w, b, steep = _chain(x)
    half = 0.5 * prm[0] * x0 / b0
    d = half * b / x
    # derivative of b / x by I1bar, with dx/dI1bar = x0^2 / (6 x)
    dd = half * (steep * x - b) / (x * x) * x0 * x0 / (6.0 * x)
    grown = (w - at_rest) / (x0 * x0)
    if x < SMALL and x0 < SMALL:
        grown = _small(i1, x0 * x0)
    return by_invariants(6.0 * half * grown, d, dd, i1, a, J)


def _fault(parameters: Parameters) -> str:
    value = scalar(parameters, "locking")
    return (
        "" if 1.0 < value <= LARGEST else f"parameter locking [-]: expected a stretch above 1, to {LARGEST:g}"
    )


LAW = Law(
    name="eight-chain",
    title="Eight chains",
    parameters={"mu": ("Pa", "scalar"), "locking": ("-", "scalar"), "bulk": ("Pa", "scalar")},
    family="invariant",
    theta="log",
    energy=energy,
    pack=lambda p: (scalar(p, "mu"), scalar(p, "locking")),
    kappa=lambda p: scalar(p, "bulk"),
    moduli=lambda p: Moduli(shear_modulus=scalar(p, "mu"), bulk_modulus=scalar(p, "bulk")),
    from_moduli=lambda shear, bulk: {"mu": shear, "locking": 8.0**0.5, "bulk": bulk},
    fault=_fault,
)
