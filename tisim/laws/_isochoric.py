"""Energies of I1bar = J^(-2/3) I1 alone, by the invariants that kernels differentiate by."""

# mypy: disable-error-code="no-untyped-def"
# (Taichi compiles these)

from tisim._ti import ti


@ti.func
def first_isochoric(I1, J):
    """I1bar, and its slope by I1."""
    a = ti.exp(-2.0 / 3.0 * ti.log(J))
    return a * I1, a


@ti.func
def by_invariants(w, d, dd, i1, a, J):
    """W, its first and its second slope by I1bar = i1 (whose slope by I1 is a), as a law's 10-vector."""
    jac = -2.0 / 3.0 * i1 / J
    return ti.Vector(
        [
            w,
            d * a,
            0.0,
            d * jac,
            dd * a * a,
            0.0,
            dd * jac * jac + d * 10.0 / 9.0 * i1 / (J * J),
            0.0,
            dd * a * jac - d * 2.0 / 3.0 * a / J,
            0.0,
        ]
    )
