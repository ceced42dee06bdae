"""From a law's energy derivatives to first Piola-Kirchhoff stress and its tangent, in Taichi.

Index convention of 9-vectors and 9 x 9 matrices: (i, K) -> 3 i + K, P_iK = dPsi/dF_iK,
A_(iK)(jL) = d2Psi / dF_iK dF_jL. The volumetric part is added here for all laws: with the pointwise
stiffness `kp` and a constant pressure `p` of the element, Psi = W + kp/2 theta^2 + p theta.
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions; their annotations mean something to Taichi only)

from typing import Any

from tisim._ti import ti
from tisim.laws import Law

_PAIRS = ((0, 1), (0, 2), (1, 2))


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


def make_response(law: Law) -> tuple[Any, Any, Any, Any]:
    """Taichi functions of one law: theta, (psi), (psi, P), (P, A). F needs det F > 0."""
    theta = make_theta(law)
    energy = law.energy
    principal = law.family == "principal"

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
    def psi_only(F, J, prm: ti.template(), kp, p):
        C, I1, I2 = invariants(F)
        th = theta(I1, J)
        w = 0.5 * kp * th[0] * th[0] + p * th[0]
        if ti.static(principal):
            lam, _V = stretches(C)
            w += energy(lam[0], lam[1], lam[2], prm)[0]
        else:
            w += energy(I1, I2, J, prm)[0]
        return w

    @ti.func
    def stress(F, J, prm: ti.template(), kp, p):
        C, I1, I2 = invariants(F)
        th = theta(I1, J)
        w = 0.5 * kp * th[0] * th[0] + p * th[0]
        pressure = kp * th[0] + p
        w1 = pressure * th[1]
        wj = pressure * th[2]
        P = ti.Matrix.zero(ti.f64, 3, 3)
        if ti.static(principal):
            lam, V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
            w += e[0]
            FV = F @ V
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        P[i, k] += e[1 + a] / lam[a] * FV[i, a] * V[k, a]
        else:
            e = energy(I1, I2, J, prm)
            w += e[0]
            w1 += e[1]
            wj += e[3]
            P += 2.0 * e[2] * (I1 * F - F @ C)
        P += 2.0 * w1 * F + wj * cofactor(F)
        return w, P

    @ti.func
    def tangent(F, J, prm: ti.template(), kp, p):
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
        if ti.static(principal):
            lam, V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
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

    return theta, psi_only, stress, tangent


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
