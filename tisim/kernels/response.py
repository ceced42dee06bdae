"""First Piola-Kirchhoff stress and its tangent from the derivatives of a law's energy, in Taichi.

Index convention of 9-vectors and 9 x 9 matrices: (i, K) -> 3 i + K, P_iK = dPsi/dF_iK,
A_(iK)(jL) = d2Psi / dF_iK dF_jL. The volumetric part is added here for all laws: with the pointwise
stiffness `kp` and a constant pressure `p` of the element, Psi = W + kp/2 theta^2 + p theta.

If a material has parts in addition to its law (`tisim.parts`), with Wbar(C) = W(J^(-2/3) C) its isochoric
part,

    Psi = (W - Wbar) + s f(Wbar + W_fibres) + 1/2 H : (C - I) + kp/2 theta^2 + p theta

f is the softened energy (f(W) = W without softening). s, a constant, and H, by quadrature point, follow from
the viscous history and the length of the time step (`tisim.discretisation.history`).
"""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions and interprets their annotations)

from typing import Any

from tisim.kernels._taichi import ti
from tisim.kernels.isochoric import NONE, Features, make_isochoric, make_parts
from tisim.kernels.tensors import (
    COFACTOR_ENTRIES,
    PAIRS,
    cofactor,
    invariants,
    sign,
    stretches,
)
from tisim.laws._law import Law


def make_theta(law: Law) -> Any:
    """Taichi function (I1, J) -> (theta, dtheta/dI1, dtheta/dJ, d2theta/dJ2) of a law."""
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
    """Taichi functions of one material: theta, psi, (psi, P), (psi, P, A), isochoric; all need det F > 0.

    Their argument `point` is a point's state as `make_load_point` loads it. `isochoric` returns C,
    S = 2 df/dC of the softened isochoric energy f, and the energy Wbar + W_fibres.
    """
    theta = make_theta(law)
    energy = law.energy
    principal = law.family == "principal"
    extended, viscous = features.any, features.viscous
    softening, fibres = features.softening is not None, features.fibres is not None
    isochoric_law = make_isochoric(law)
    fibre_axis, fibre_terms, softened, history, extended_terms = make_parts(features)

    @ti.func
    def isochoric(F, J, prm: ti.template(), point):
        C, I1, I2 = invariants(F)
        S = ti.Matrix.zero(ti.f64, 3, 3)
        w = 0.0
        wj = 0.0
        if ti.static(principal):
            lam, V = stretches(C)
            e = isochoric_law(lam, J, prm)
            w += e[0]
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        S[i, k] += e[1 + a] / lam[a] * V[i, a] * V[k, a]
        else:
            e = isochoric_law(I1, I2, J, prm)
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
        S += wj / J * cofactor(C)  # wj J C^-1, since det C = J^2
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
                e = extended_terms(C, J, e, isochoric_law(lam, J, prm), prm, point)[0]
            w += e[0]
        else:
            e = energy(I1, I2, J, prm)
            if ti.static(extended):
                e = extended_terms(C, J, e, isochoric_law(I1, I2, J, prm), prm, point)[0]
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
                e, gain, _, t = extended_terms(C, J, e, isochoric_law(lam, J, prm), prm, point)
            w += e[0]
            FV = F @ V
            for a in ti.static(range(3)):
                for i in ti.static(range(3)):
                    for k in ti.static(range(3)):
                        P[i, k] += e[1 + a] / lam[a] * FV[i, a] * V[k, a]
        else:
            e = energy(I1, I2, J, prm)
            if ti.static(extended):
                e, gain, _, t = extended_terms(C, J, e, isochoric_law(I1, I2, J, prm), prm, point)
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
        w = 0.5 * kp * th[0] * th[0] + p * th[0]
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
        P0 = ti.Vector.zero(ti.f64, 9)  # derivative of the isochoric energy, with softening only
        if ti.static(principal):
            lam, V = stretches(C)
            e = energy(lam[0], lam[1], lam[2], prm)
            iso = e
            if ti.static(extended):
                iso = isochoric_law(lam, J, prm)
                e, gain, bend, t = extended_terms(C, J, e, iso, prm, point)
            w += e[0]
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
                a, b = ti.static(PAIRS[n])
                gap = lam[a] - lam[b]
                flip = 0.5 * (e[4 + a] + e[4 + b]) - e[7 + n]
                # near repeated stretches the quotient loses its digits; the error of its limit is gap^2
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
                iso = isochoric_law(I1, I2, J, prm)
                e, gain, bend, t = extended_terms(C, J, e, iso, prm, point)
                if ti.static(softening):
                    for i in ti.static(range(3)):
                        for k in ti.static(range(3)):
                            P0[3 * i + k] += (
                                2.0 * iso[1] * F[i, k] + 2.0 * iso[2] * g2[i, k] + iso[3] * cof[i, k]
                            )
            w += e[0]
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
        for i, k, j, l in ti.static(COFACTOR_ENTRIES):
            m = ti.static(3 - i - j)
            n = ti.static(3 - k - l)
            A[3 * i + k, 3 * j + l] += ti.static(sign(i, j) * sign(k, l)) * wj * F[m, n]
        for r in ti.static(range(1, 9)):
            for s in ti.static(range(r)):
                A[r, s] = A[s, r]
        return w, P, A

    return theta, psi_only, stress, tangent, isochoric
