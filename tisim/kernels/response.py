"""From a law's energy derivatives to first Piola-Kirchhoff stress and its tangent, in Taichi.

Index convention of 9-vectors and 9 x 9 matrices: (i, K) -> 3 i + K, P_iK = dPsi/dF_iK,
A_(iK)(jL) = d2Psi / dF_iK dF_jL. The volumetric part is added here for all laws: with the pointwise
stiffness `kp` and a constant pressure `p` of the element, Psi = W + kp/2 theta^2 + p theta.

Where a material has parts beside its law (`tisim.parts`), with Wbar(C) = W(J^(-2/3) C) its isochoric part,

    Psi = (W - Wbar) + s f(Wbar + W_fibres) + 1/2 H : (C - I) + kp/2 theta^2 + p theta

f is the softened energy (f(W) = W without softening); s, the same everywhere, and H, by quadrature point, are
what a time step makes of the viscous history (`tisim.discretisation.history`).
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions; their annotations mean something to Taichi only)

from dataclasses import dataclass
from typing import Any

from tisim.kernels._taichi import ti
from tisim.laws import Law

_PAIRS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, kw_only=True)
class Features:
    """What the kernels of a material compile in besides its law; numbers follow those of the law in `prm`.

    Attributes
    ----------
    viscous : bool
        Whether points have a tensor of history H.
    softening, fibres : Taichi function or None
        Energies of these parts.
    softening_size, fibres_size : int
        How many numbers each reads.
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
        """Numbers of state a point: H (00, 11, 22, 01, 02, 12), then the largest energy so far."""
        return 6 * self.viscous + (self.softening is not None)

    @property
    def tail_size(self) -> int:
        """Numbers after those of the law: s; of softening; of fibres and their unit vector."""
        return 1 + self.softening_size + self.fibres_size + 3 * (self.fibres is not None)


NONE = Features()


@ti.func
def cofactor(F):
    """d(det F)/dF."""
    return ti.Matrix(
        [
            [
                F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1],
                F[1, 2] * F[2, 0] - F[1, 0] * F[2, 2],
                F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0],
            ],
            [
                F[2, 1] * F[0, 2] - F[2, 2] * F[0, 1],
                F[2, 2] * F[0, 0] - F[2, 0] * F[0, 2],
                F[2, 0] * F[0, 1] - F[2, 1] * F[0, 0],
            ],
            [
                F[0, 1] * F[1, 2] - F[0, 2] * F[1, 1],
                F[0, 2] * F[1, 0] - F[0, 0] * F[1, 2],
                F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0],
            ],
        ]
    )


@ti.func
def determinant(F):
    return (
        F[0, 0] * (F[1, 1] * F[2, 2] - F[1, 2] * F[2, 1])
        + F[0, 1] * (F[1, 2] * F[2, 0] - F[1, 0] * F[2, 2])
        + F[0, 2] * (F[1, 0] * F[2, 1] - F[1, 1] * F[2, 0])
    )


@ti.func
def eigen_symmetric(C):
    """Eigenvalues (3) and eigenvectors (columns) of a symmetric 3 x 3 matrix by cyclic Jacobi rotations.

    Backward stable, also where eigenvalues repeat; `ti.sym_eig` errs by 6e-6 near the identity.
    """
    A = C
    V = ti.Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    scale = A[0, 0] * A[0, 0] + A[1, 1] * A[1, 1] + A[2, 2] * A[2, 2]
    for _ in range(12):
        off = A[0, 1] * A[0, 1] + A[0, 2] * A[0, 2] + A[1, 2] * A[1, 2]
        if off <= 1e-34 * scale:
            break
        for p, q in ti.static(_PAIRS):
            r = ti.static(3 - p - q)
            apq = A[p, q]
            if ti.abs(apq) > 1e-300:
                theta = (A[q, q] - A[p, p]) / (2.0 * apq)
                t = 1.0 / (ti.abs(theta) + ti.sqrt(theta * theta + 1.0))
                if theta < 0.0:
                    t = -t
                c = 1.0 / ti.sqrt(t * t + 1.0)
                s = t * c
                A[p, p] -= t * apq
                A[q, q] += t * apq
                A[p, q] = 0.0
                A[q, p] = 0.0
                arp = A[r, p]
                arq = A[r, q]
                A[r, p] = c * arp - s * arq
                A[p, r] = A[r, p]
                A[r, q] = s * arp + c * arq
                A[q, r] = A[r, q]
                for k in ti.static(range(3)):
                    vp = V[k, p]
                    vq = V[k, q]
                    V[k, p] = c * vp - s * vq
                    V[k, q] = s * vp + c * vq
    return ti.Vector([A[0, 0], A[1, 1], A[2, 2]]), V


def make_theta(law: Law) -> Any:
    """ti.func (I1, J) -> (theta, dtheta/dI1, dtheta/dJ, d2theta/dJ2)."""
    kind = law.theta

    @ti.func
    def theta(I1, J):
        v = ti.Vector([0.0, 0.0, 0.0, 0.0])
        if ti.static(kind == "log"):
            v = ti.Vector([ti.log(J), 0.0, 1.0 / J, -1.0 / (J * J)])
        elif ti.static(kind == "linear"):
            v = ti.Vector([J - 1.0, 0.0, 1.0, 0.0])
        else:
            v = ti.Vector([0.5 * (I1 - 3.0), 0.5, 0.0, 0.0])
        return v

    return theta


def make_response(law: Law, features: Features = NONE) -> tuple[Any, Any, Any, Any, Any]:
    """Taichi functions of one material: theta, (psi), (psi, P), (P, A), isochoric. F needs det F > 0.

    `point`: a point's state, as `make_load_point` loads it.
    isochoric: C, the softened isochoric energy's S = 2 df/dC, and the energy Wbar + W_fibres.
    """
    theta = make_theta(law)
    energy = law.energy
    principal = law.family == "principal"
    extended = features.any
    viscous, soft, fibred = features.viscous, features.softening, features.fibres
    softening = features.softening is not None
    fibres = features.fibres is not None
    soft_size, fibres_size, tail = features.softening_size, features.fibres_size, features.tail_size

    @ti.func
    def invariants(F):
        C = F.transpose() @ F
        I1 = C[0, 0] + C[1, 1] + C[2, 2]
        c2 = (
            C[0, 0] * C[0, 0]
            + C[1, 1] * C[1, 1]
            + C[2, 2] * C[2, 2]
            + 2.0 * (C[0, 1] * C[0, 1] + C[0, 2] * C[0, 2] + C[1, 2] * C[1, 2])
        )
        return C, I1, 0.5 * (I1 * I1 - c2)

    @ti.func
    def stretches(C):
        lam2, V = eigen_symmetric(C)
        return ti.sqrt(ti.max(lam2, 1e-300)), V

    @ti.func
    def isochoric_invariants(I1, I2, J, prm: ti.template()):
        """The law's 10-vector for Wbar(I1, I2, J) = W(J^(-2/3) I1, J^(-4/3) I2, 1)."""
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
        """The law's 10-vector for Wbar(l) = W(J^(-1/3) l), by its derivatives in ln l less their means."""
        l = lam * ti.exp(-1.0 / 3.0 * ti.log(J))
        e = energy(l[0], l[1], l[2], prm)
        g = ti.Vector([l[0] * e[1], l[1] * e[2], l[2] * e[3]])
        h = ti.Matrix.zero(ti.f64, 3, 3)
        for a in ti.static(range(3)):
            h[a, a] = l[a] * l[a] * e[4 + a] + g[a]
        for n in ti.static(range(3)):
            a, b = ti.static(_PAIRS[n])
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
            a, b = ti.static(_PAIRS[n])
            r[7 + n] = h[a, b] / (lam[a] * lam[b])
        return r

    @ti.func
    def fibre_axis(prm: ti.template()):
        n = prm.shape[0]
        return ti.Vector([prm[n - 3], prm[n - 2], prm[n - 1]])

    @ti.func
    def fibre_terms(C, J, prm: ti.template()):
        """W_fibres and its derivatives by I4 = a.Ca and J: (W, W4, WJ, W44, WJJ, W4J)."""
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
        """f, f' and f'' of the isochoric energy w."""
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
        """H, where there is one."""
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
        """The law's 10-vector e with what the parts make of it (iso: that of Wbar), s f' and s f'', W_fibres.

        s f' and s f'' are factors of the isochoric energy's slopes and of their products; of W_fibres come
        the derivatives of `fibre_terms`.
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

    @ti.func
    def isochoric(F, J, prm: ti.template(), point):
        C, I1, I2 = invariants(F)
        S = ti.Matrix.zero(ti.f64, 3, 3)
        w = 0.0
        wj = 0.0
        if ti.static(principal):
            lam, V = stretches(C)
            e = isochoric_stretches(lam, J, prm)
            w += e[0]
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        S[i, k] += e[1 + a] / lam[a] * V[i, a] * V[k, a]
        else:
            e = isochoric_invariants(I1, I2, J, prm)
            w += e[0]
            wj += e[3]
            one = ti.Matrix.identity(ti.f64, 3)
            S += 2.0 * e[1] * one + 2.0 * e[2] * (I1 * one - C)
        if ti.static(fibres):
            t = fibre_terms(C, J, prm)
            a = fibre_axis(prm)
            w += t[0]
            wj += t[2]
            S += 2.0 * t[1] * a.outer_product(a)
        S += wj / J * cofactor(C)  # J C^-1, of a C whose determinant is J^2
        return C, softened(w, point, prm)[1] * S, w

    @ti.func
    def psi_only(F, J, prm: ti.template(), kp, p, point):
        C, I1, I2 = invariants(F)
        th = theta(I1, J)
        w = 0.5 * kp * th[0] * th[0] + p * th[0]
        if ti.static(principal):
            lam, _V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
            if ti.static(extended):
                e = extended_terms(C, J, e, isochoric_stretches(lam, J, prm), prm, point)[0]
            w += e[0]
        else:
            e = energy(I1, I2, J, prm)
            if ti.static(extended):
                e = extended_terms(C, J, e, isochoric_invariants(I1, I2, J, prm), prm, point)[0]
            w += e[0]
        return w

    @ti.func
    def stress(F, J, prm: ti.template(), kp, p, point):
        C, I1, I2 = invariants(F)
        th = theta(I1, J)
        w = 0.5 * kp * th[0] * th[0] + p * th[0]
        pressure = kp * th[0] + p
        w1 = pressure * th[1]
        wj = pressure * th[2]
        P = ti.Matrix.zero(ti.f64, 3, 3)
        gain = 1.0
        t = ti.Vector.zero(ti.f64, 6)
        if ti.static(principal):
            lam, V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
            if ti.static(extended):
                e, gain, _, t = extended_terms(C, J, e, isochoric_stretches(lam, J, prm), prm, point)
            w += e[0]
            FV = F @ V
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        P[i, k] += e[1 + a] / lam[a] * FV[i, a] * V[k, a]
        else:
            e = energy(I1, I2, J, prm)
            if ti.static(extended):
                e, gain, _, t = extended_terms(C, J, e, isochoric_invariants(I1, I2, J, prm), prm, point)
            w += e[0]
            w1 += e[1]
            wj += e[3]
            P += 2.0 * e[2] * (I1 * F - F @ C)
        if ti.static(fibres):
            a = fibre_axis(prm)
            P += 2.0 * gain * t[1] * (F @ a).outer_product(a)
            wj += gain * t[2]
        if ti.static(viscous):
            P += F @ history(point)
        P += 2.0 * w1 * F + wj * cofactor(F)
        return w, P

    @ti.func
    def tangent(F, J, prm: ti.template(), kp, p, point):
        C, I1, I2 = invariants(F)
        th = theta(I1, J)
        pressure = kp * th[0] + p
        w1 = pressure * th[1]
        w2 = 0.0
        wj = pressure * th[2]
        w11 = kp * th[1] * th[1]
        wjj = kp * th[2] * th[2] + pressure * th[3]
        w22 = 0.0
        w12 = 0.0
        w1j = 0.0
        w2j = 0.0
        P = ti.Matrix.zero(ti.f64, 3, 3)
        A = ti.Matrix.zero(ti.f64, 9, 9)
        cof = cofactor(F)
        g2 = I1 * F - F @ C
        gain = 1.0
        bend = 0.0
        t = ti.Vector.zero(ti.f64, 6)
        P0 = ti.Vector.zero(ti.f64, 9)  # slope of the isochoric energy, where something softens
        if ti.static(principal):
            lam, V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
            iso = e
            if ti.static(extended):
                iso = isochoric_stretches(lam, J, prm)
                e, gain, bend, t = extended_terms(C, J, e, iso, prm, point)
            U = F @ V
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    U[i, a] /= lam[a]
            D = ti.Matrix.zero(ti.f64, 9, 3)  # columns: u_a v_a^T
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        D[3 * i + k, a] = U[i, a] * V[k, a]
                        P[i, k] += e[1 + a] * D[3 * i + k, a]
                        if ti.static(softening):
                            P0[3 * i + k] += iso[1 + a] * D[3 * i + k, a]
            for r in ti.static(range(9)):
                d1 = e[4] * D[r, 0] + e[7] * D[r, 1] + e[8] * D[r, 2]
                d2 = e[7] * D[r, 0] + e[5] * D[r, 1] + e[9] * D[r, 2]
                d3 = e[8] * D[r, 0] + e[9] * D[r, 1] + e[6] * D[r, 2]
                for s in ti.static(range(r, 9)):
                    A[r, s] += d1 * D[s, 0] + d2 * D[s, 1] + d3 * D[s, 2]
            for n in ti.static(range(3)):
                a, b = ti.static(_PAIRS[n])
                gap = lam[a] - lam[b]
                flip = 0.5 * (e[4 + a] + e[4 + b]) - e[7 + n]
                # near repeated stretches the quotient loses its digits; its limit errs by gap^2
                if ti.abs(gap) > 1e-5 * (lam[a] + lam[b]):
                    flip = (e[1 + a] - e[1 + b]) / gap
                twist = (e[1 + a] + e[1 + b]) / (lam[a] + lam[b])
                L = ti.Vector.zero(ti.f64, 9)
                T = ti.Vector.zero(ti.f64, 9)
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        x = U[i, a] * V[k, b]
                        y = U[i, b] * V[k, a]
                        L[3 * i + k] = x + y
                        T[3 * i + k] = x - y
                for r in ti.static(range(9)):
                    fl = 0.5 * flip * L[r]
                    tw = 0.5 * twist * T[r]
                    for s in ti.static(range(r, 9)):
                        A[r, s] += fl * L[s] + tw * T[s]
        else:
            e = energy(I1, I2, J, prm)
            if ti.static(extended):
                iso = isochoric_invariants(I1, I2, J, prm)
                e, gain, bend, t = extended_terms(C, J, e, iso, prm, point)
                if ti.static(softening):
                    for i in ti.static(range(3)):
                        for k in ti.static(range(3)):
                            P0[3 * i + k] += (
                                2.0 * iso[1] * F[i, k] + 2.0 * iso[2] * g2[i, k] + iso[3] * cof[i, k]
                            )
            w1 += e[1]
            w2 += e[2]
            wj += e[3]
            w11 += e[4]
            w22 += e[5]
            wjj += e[6]
            w12 += e[7]
            w1j += e[8]
            w2j += e[9]
            P += 2.0 * w2 * g2
            B = F @ F.transpose()
            for i in ti.static(range(3)):
                for k in ti.static(range(3)):
                    for j in ti.static(range(3)):
                        for l in ti.static(range(3)):
                            if ti.static(3 * i + k <= 3 * j + l):
                                v = 2.0 * F[j, l] * F[i, k] - F[i, l] * F[j, k]
                                if ti.static(i == j):
                                    v -= C[k, l]
                                    if ti.static(k == l):
                                        v += I1
                                if ti.static(k == l):
                                    v -= B[i, j]
                                A[3 * i + k, 3 * j + l] += 2.0 * w2 * v
        if ti.static(fibres):
            a = fibre_axis(prm)
            b = F @ a
            wj += gain * t[2]
            wjj += gain * t[4]
            P += 2.0 * gain * t[1] * b.outer_product(a)
            for r in ti.static(range(9)):
                g4 = 2.0 * b[r // 3] * a[r % 3]
                c = cof[r // 3, r % 3]
                if ti.static(softening):
                    P0[r] += t[1] * g4 + t[2] * c
                for s in ti.static(range(r, 9)):
                    h4 = 2.0 * b[s // 3] * a[s % 3]
                    A[r, s] += gain * (t[3] * g4 * h4 + t[5] * (g4 * cof[s // 3, s % 3] + c * h4))
                    if ti.static(r // 3 == s // 3):
                        A[r, s] += 2.0 * gain * t[1] * a[r % 3] * a[s % 3]
        if ti.static(softening):
            for r in ti.static(range(9)):
                for s in ti.static(range(r, 9)):
                    A[r, s] += bend * P0[r] * P0[s]
        if ti.static(viscous):
            H = history(point)
            P += F @ H
            for r in ti.static(range(9)):
                for s in ti.static(range(r, 9)):
                    if ti.static(r // 3 == s // 3):
                        A[r, s] += H[r % 3, s % 3]
        P += 2.0 * w1 * F + wj * cof
        for r in ti.static(range(9)):
            f = 2.0 * F[r // 3, r % 3]
            q = 2.0 * g2[r // 3, r % 3]
            c = cof[r // 3, r % 3]
            cf = w11 * f + w12 * q + w1j * c
            cq = w12 * f + w22 * q + w2j * c
            cc = w1j * f + w2j * q + wjj * c
            for s in ti.static(range(r, 9)):
                A[r, s] += (
                    cf * 2.0 * F[s // 3, s % 3] + cq * 2.0 * g2[s // 3, s % 3] + cc * cof[s // 3, s % 3]
                )
            A[r, r] += 2.0 * w1
        # d cof_iK / dF_jL = eps_ijm eps_KLn F_mn
        for i, k, j, l in ti.static(_COFACTOR_ENTRIES):
            m = ti.static(3 - i - j)
            n = ti.static(3 - k - l)
            A[3 * i + k, 3 * j + l] += ti.static(_sign(i, j) * _sign(k, l)) * wj * F[m, n]
        for r in ti.static(range(1, 9)):
            for s in ti.static(range(r)):
                A[r, s] = A[s, r]
        return P, A

    return theta, psi_only, stress, tangent, isochoric


@ti.func
def _nothing_of(state: ti.template(), e, q):  # noqa: ARG001 - one signature for all features
    return 0.0


def make_load_point(features: Features) -> Any:
    """Taichi function (state, e, q) to what `make_response` calls a point."""
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


def _sign(i: int, j: int) -> int:
    return 1 if (j - i) % 3 == 1 else -1


_COFACTOR_ENTRIES = tuple(
    (i, k, j, l)
    for i in range(3)
    for k in range(3)
    for j in range(3)
    for l in range(3)
    if i != j and k != l and 3 * i + k < 3 * j + l
)
