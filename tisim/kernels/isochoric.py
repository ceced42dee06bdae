"""The isochoric part of a law's energy, Wbar(C) = W(J^(-2/3) C), its softening and the fibres, in Taichi.

10-vectors of derivatives are those of the law (`tisim.laws.Law`): by I1, I2 and J, or by the principal
stretches.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions and interprets their annotations)

from dataclasses import dataclass
from typing import Any

from tisim.kernels._taichi import ti
from tisim.kernels.tensors import PAIRS
from tisim.laws._law import Law


@dataclass(frozen=True, kw_only=True)
class Features:
    """Parts of a material compiled into kernels with its law; their parameters follow the law's in `prm`.

    Attributes
    ----------
    viscous : bool
        True if points have a history tensor H.
    softening, fibres : Taichi function or None
        Energies of these parts.
    softening_size, fibres_size : int
        Number of parameters of each.
    """

    viscous: bool = False
    softening: Any = None
    softening_size: int = 0
    fibres: Any = None
    fibres_size: int = 0

    @property
    def any(self) -> bool:
        return self.viscous or self.softening is not None or self.fibres is not None

    @property
    def state_size(self) -> int:
        """Length of a point's state: H (00, 11, 22, 01, 02, 12), then the largest energy so far."""
        return 6 * self.viscous + (self.softening is not None)

    @property
    def tail_size(self) -> int:
        """Number of parameters after those of the law: s, softening, fibres, and their unit vector."""
        return 1 + self.softening_size + self.fibres_size + 3 * (self.fibres is not None)


NONE = Features()


def make_isochoric(law: Law) -> Any:
    """Taichi function of Wbar's 10-vector: of (I1, I2, J, prm), or of (stretches, J, prm)."""
    energy = law.energy

    @ti.func
    def isochoric_invariants(I1, I2, J, prm: ti.template()):
        """10-vector of Wbar(I1, I2, J) = W(J^(-2/3) I1, J^(-4/3) I2, 1)."""
        a = ti.exp(-2.0 / 3.0 * ti.log(J))
        b = a * a
        i1 = a * I1
        i2 = b * I2
        e = energy(i1, i2, 1.0, prm)
        x = -2.0 / 3.0 * i1 / J
        y = -4.0 / 3.0 * i2 / J
        return ti.Vector(
            [
                e[0],
                e[1] * a,
                e[2] * b,
                e[1] * x + e[2] * y,
                e[4] * a * a,
                e[5] * b * b,
                e[4] * x * x
                + 2.0 * e[7] * x * y
                + e[5] * y * y
                + (10.0 / 9.0 * e[1] * i1 + 28.0 / 9.0 * e[2] * i2) / (J * J),
                e[7] * a * b,
                a * (e[4] * x + e[7] * y) - 2.0 / 3.0 * e[1] * a / J,
                b * (e[7] * x + e[5] * y) - 4.0 / 3.0 * e[2] * b / J,
            ]
        )

    @ti.func
    def isochoric_stretches(lam, J, prm: ti.template()):
        """10-vector of Wbar(l) = W(J^(-1/3) l), from the derivatives by ln l minus their means."""
        l = lam * ti.exp(-1.0 / 3.0 * ti.log(J))
        e = energy(l[0], l[1], l[2], prm)
        g = ti.Vector([l[0] * e[1], l[1] * e[2], l[2] * e[3]])
        h = ti.Matrix.zero(ti.f64, 3, 3)
        for a in ti.static(range(3)):
            h[a, a] = l[a] * l[a] * e[4 + a] + g[a]
        for n in ti.static(range(3)):
            a, b = ti.static(PAIRS[n])
            h[a, b] = l[a] * l[b] * e[7 + n]
            h[b, a] = h[a, b]
        rows = ti.Vector(
            [h[0, 0] + h[0, 1] + h[0, 2], h[1, 0] + h[1, 1] + h[1, 2], h[2, 0] + h[2, 1] + h[2, 2]]
        )
        rows /= 3.0
        mean = (rows[0] + rows[1] + rows[2]) / 3.0
        g -= (g[0] + g[1] + g[2]) / 3.0
        for a in ti.static(range(3)):
            for b in ti.static(range(3)):
                h[a, b] += mean - rows[a] - rows[b]
        r = ti.Vector.zero(ti.f64, 10)
        r[0] = e[0]
        for a in ti.static(range(3)):
            r[1 + a] = g[a] / lam[a]
            r[4 + a] = (h[a, a] - g[a]) / (lam[a] * lam[a])
        for n in ti.static(range(3)):
            a, b = ti.static(PAIRS[n])
            r[7 + n] = h[a, b] / (lam[a] * lam[b])
        return r

    return isochoric_stretches if law.family == "principal" else isochoric_invariants


def make_parts(features: Features) -> tuple[Any, Any, Any, Any, Any]:
    """Taichi functions of the parts: fibre_axis, fibre_terms, softened, history, extended_terms."""
    viscous, soft, fibred = features.viscous, features.softening, features.fibres
    softening, fibres = soft is not None, fibred is not None
    soft_size, fibres_size, tail = features.softening_size, features.fibres_size, features.tail_size

    @ti.func
    def fibre_axis(prm: ti.template()):
        n = prm.shape[0]
        return ti.Vector([prm[n - 3], prm[n - 2], prm[n - 1]])

    @ti.func
    def fibre_terms(C, J, prm: ti.template()):
        """W_fibres(J^(-2/3) I4) and its derivatives by I4 = a.Ca and J: (W, W4, WJ, W44, WJJ, W4J)."""
        a = fibre_axis(prm)
        numbers = ti.Vector.zero(ti.f64, ti.static(fibres_size))
        start = prm.shape[0] - 3 - fibres_size
        for i in ti.static(range(fibres_size)):
            numbers[i] = prm[start + i]
        c = ti.exp(-2.0 / 3.0 * ti.log(J))
        I4 = c * a.dot(C @ a)
        w = fibred(I4, numbers)
        x = -2.0 / 3.0 * I4 / J
        return ti.Vector(
            [
                w[0],
                w[1] * c,
                w[1] * x,
                w[2] * c * c,
                w[2] * x * x + w[1] * 10.0 / 9.0 * I4 / (J * J),
                w[2] * c * x - w[1] * 2.0 / 3.0 * c / J,
            ]
        )

    @ti.func
    def softened(w, point, prm: ti.template()):
        """Softened energy f and f', f'' at the isochoric energy w."""
        f = ti.Vector([w, 1.0, 0.0])
        if ti.static(softening):
            numbers = ti.Vector.zero(ti.f64, ti.static(soft_size))
            start = prm.shape[0] - tail + 1
            for i in ti.static(range(soft_size)):
                numbers[i] = prm[start + i]
            f = soft(w, point[6], numbers)
        return f

    @ti.func
    def history(point):
        """History tensor H of a point; for viscous materials only."""
        return ti.Matrix(
            [
                [point[0], point[3], point[4]],
                [point[3], point[1], point[5]],
                [point[4], point[5], point[2]],
            ]
        )

    @ti.func
    def scale(prm: ti.template()):
        return prm[prm.shape[0] - tail]

    @ti.func
    def extended_terms(C, J, e, iso, prm: ti.template(), point):
        """10-vector of law and parts from those of W (`e`) and Wbar (`iso`), s f', s f'' and `fibre_terms`.

        s f' multiplies the derivatives of the isochoric energy, s f'' their products. Derivatives of W_fibres
        and of H : C are not included in the 10-vector.
        """
        t = ti.Vector.zero(ti.f64, 6)
        if ti.static(fibres):
            t = fibre_terms(C, J, prm)
        f = softened(iso[0] + t[0], point, prm)
        s = scale(prm)
        c = e + (s * f[1] - 1.0) * iso
        c[0] = e[0] - iso[0] + s * f[0]
        if ti.static(viscous):
            c[0] += 0.5 * ((C - ti.Matrix.identity(ti.f64, 3)) * history(point)).sum()
        return c, s * f[1], s * f[2], t

    return fibre_axis, fibre_terms, softened, history, extended_terms


@ti.func
def _nothing_of(state: ti.template(), e, q):  # noqa: ARG001 - one signature for all features
    return 0.0


def make_load_point(features: Features) -> Any:
    """Taichi function (state, e, q) -> `point`, the state of a point for the functions of `make_response`."""
    viscous, softening = features.viscous, features.softening is not None

    @ti.func
    def load_point(state: ti.template(), e, q):
        v = ti.Vector.zero(ti.f64, 7)
        if ti.static(viscous):
            for i in ti.static(range(6)):
                v[i] = state[e, q, i]
        if ti.static(softening):
            v[6] = state[e, q, state.shape[2] - 1]
        return v

    return load_point if viscous or softening else _nothing_of
