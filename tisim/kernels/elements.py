"""Taichi kernels of one law over the elements of one mesh: energy, forces, stiffness, law evaluation.

All run serially and take plain NumPy arrays: x (n, 3) positions; conn (m, a) element nodes;
grad (m, q, a, 3) shape function gradients in the rest shape [1/m]; weight (m, q) rest volumes [m3];
prm packed law parameters, then those of the material's other parts; kp (q,) pointwise and kb mean volumetric
stiffness [Pa]; state (m, q, k) what these parts need by point (`tisim.kernels.isochoric.Features`).
The energy of an element is  sum_q w_q (W + kp_q/2 theta^2) + kb/2 V mean(theta)^2: with kb = 0 the plain
displacement element, else one with a constant pressure kb mean(theta), condensed ("P2/P0", "Q1/P0").
"""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"
# (Taichi compiles these functions; their annotations mean something to Taichi only)

from functools import cache

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti
from tisim.kernels.isochoric import NONE, Features, make_load_point
from tisim.kernels.response import make_response
from tisim.kernels.tensors import cofactor, determinant
from tisim.laws import Law

_f1 = ti.types.ndarray(dtype=f64, ndim=1)
_f2 = ti.types.ndarray(dtype=f64, ndim=2)
_f3 = ti.types.ndarray(dtype=f64, ndim=3)
_f4 = ti.types.ndarray(dtype=f64, ndim=4)
_i2 = ti.types.ndarray(dtype=i32, ndim=2)
_i3 = ti.types.ndarray(dtype=i32, ndim=3)


@ti.func
def deformation_gradient(x: ti.template(), conn: ti.template(), grad: ti.template(), e, q):
    F = ti.Matrix.zero(f64, 3, 3)
    for a in range(conn.shape[1]):
        n = conn[e, a]
        for i in ti.static(range(3)):
            for k in ti.static(range(3)):
                F[i, k] += x[n, i] * grad[e, q, a, k]
    return F


@ti.func
def takes_part(grad: ti.template(), e, q, a):
    """Whether node a moves point q."""
    return grad[e, q, a, 0] != 0.0 or grad[e, q, a, 1] != 0.0 or grad[e, q, a, 2] != 0.0


@cache
def force_functions(law: Law, features: Features = NONE) -> tuple[Kernel, Kernel]:
    """Taichi functions of a material for use inside kernels: (mean_theta, add_forces)."""
    theta, _, stress, _, _ = make_response(law, features)
    load_point = make_load_point(features)

    @ti.func
    def mean_theta(
        x: ti.template(), conn: ti.template(), grad: ti.template(), weight: ti.template(), e, minj
    ):
        """Volume-weighted mean of theta, rest volume, smallest det F; theta of a turned point is skipped."""
        s = 0.0
        v = 0.0
        for q in range(weight.shape[1]):
            F = deformation_gradient(x, conn, grad, e, q)
            J = determinant(F)
            minj = ti.min(minj, J)
            if J > 0.0:
                s += weight[e, q] * theta(F.norm_sqr(), J)[0]
            v += weight[e, q]
        return s / v, v, minj

    @ti.func
    def add_forces(
        x: ti.template(),
        conn: ti.template(),
        grad: ti.template(),
        weight: ti.template(),
        prm: ti.template(),
        state: ti.template(),
        kp: ti.template(),
        kb,
        f: ti.template(),
    ):
        """f += dEnergy/dx (internal forces), shape (n, 3) [N]; returns energy [J] and smallest det F."""
        total = 0.0
        minj = 1e300
        for e in range(conn.shape[0]):
            mean = 0.0
            if kb != 0.0:
                mean, v, minj = mean_theta(x, conn, grad, weight, e, minj)
                total += 0.5 * kb * v * mean * mean
            for q in range(weight.shape[1]):
                F = deformation_gradient(x, conn, grad, e, q)
                J = determinant(F)
                minj = ti.min(minj, J)
                if J > 0.0:
                    psi, P = stress(F, J, prm, kp[q], kb * mean, load_point(state, e, q))
                    th = 0.0
                    if kb != 0.0:
                        th = theta(F.norm_sqr(), J)[0]
                    total += weight[e, q] * (psi - kb * mean * th)
                    for a in range(conn.shape[1]):
                        n = conn[e, a]
                        for i in ti.static(range(3)):
                            s = 0.0
                            for k in ti.static(range(3)):
                                s += P[i, k] * grad[e, q, a, k]
                            f[n, i] = f[n, i] + weight[e, q] * s
        return total, minj

    return mean_theta, add_forces


@cache
def element_kernels(law: Law, *, features: Features = NONE) -> tuple[Kernel, Kernel, Kernel, Kernel]:
    """(energy, forces, stiffness, pressures) kernels of a material, compiled once for any mesh and values."""
    ensure_runtime()
    theta, psi_only, _, tangent, _ = make_response(law, features)
    mean_theta, add_forces = force_functions(law, features)
    load_point = make_load_point(features)

    @ti.kernel
    def energy(x: _f2, conn: _i2, grad: _f4, weight: _f2, prm: _f1, state: _f3, kp: _f1, kb: f64, out: _f1):
        """out: energy [J], smallest det F; the energy means nothing where that is not positive."""
        total = 0.0
        minj = 1e300
        ti.loop_config(serialize=True)
        for _ in range(1):
            for e in range(conn.shape[0]):
                s = 0.0
                v = 0.0
                for q in range(weight.shape[1]):
                    F = deformation_gradient(x, conn, grad, e, q)
                    J = determinant(F)
                    minj = ti.min(minj, J)
                    if J > 0.0:
                        s += weight[e, q] * theta(F.norm_sqr(), J)[0]
                        total += weight[e, q] * psi_only(F, J, prm, kp[q], 0.0, load_point(state, e, q))
                    v += weight[e, q]
                total += 0.5 * kb * s * s / v
            out[0] = total
            out[1] = minj

    @ti.kernel
    def forces(
        x: _f2, conn: _i2, grad: _f4, weight: _f2, prm: _f1, state: _f3, kp: _f1, kb: f64, f: _f2, out: _f1
    ):
        """f += dEnergy/dx (internal forces), shape (n, 3) [N]; out as in `energy`."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            total, minj = add_forces(x, conn, grad, weight, prm, state, kp, kb, f)
            out[0] = total
            out[1] = minj

    @ti.kernel
    def stiffness(
        x: _f2,
        conn: _i2,
        grad: _f4,
        weight: _f2,
        prm: _f1,
        state: _f3,
        kp: _f1,
        kb: f64,
        pressure: _f1,
        sparse: i32,
        slot: _i3,
        ke: _f2,
        f: _f2,
        values: _f3,
        out: _f1,
    ):
        """Adds d2Energy/dx2 into blocks `values` (nb, 3, 3), and dEnergy/dx into f.

        pressure (m,) [Pa] takes the place of kb mean(theta) in the tangent's geometric part; the forces
        are exact whatever it is.
        sparse: 1 where nodes that do not move a point are skipped (tetrahedra in a hexahedron), 0 elsewhere.
        slot (m, a, b), for a <= b: 4 * block + 0 (add), 1 (add transposed), 2 (both), or -1 (a fixed node).
        ke (a, a * 9) and its last row pair is scratch.
        """
        minj = 1e300
        ti.loop_config(serialize=True)
        for _ in range(1):
            na = conn.shape[1]
            for e in range(conn.shape[0]):
                for a in range(na):
                    for b in range(9 * na + 3):
                        ke[a, b] = 0.0
                excess = 0.0
                vol = 0.0
                pe = 0.0
                if kb != 0.0:
                    mean, vol, minj = mean_theta(x, conn, grad, weight, e, minj)
                    pe = pressure[e]
                    excess = kb * mean - pe
                for q in range(weight.shape[1]):
                    F = deformation_gradient(x, conn, grad, e, q)
                    J = determinant(F)
                    minj = ti.min(minj, J)
                    if J > 0.0:
                        w = weight[e, q]
                        _psi, P, A = tangent(F, J, prm, kp[q], pe, load_point(state, e, q))
                        if kb != 0.0:
                            th = theta(F.norm_sqr(), J)
                            T = 2.0 * th[1] * F + th[2] * cofactor(F)
                            P += excess * T
                            for a in range(na):
                                for i in ti.static(range(3)):
                                    s = 0.0
                                    for k in ti.static(range(3)):
                                        s += T[i, k] * grad[e, q, a, k]
                                    ke[a, 9 * na + i] = ke[a, 9 * na + i] + w * s
                        for b in range(na):
                            if sparse != 0 and not takes_part(grad, e, q, b):
                                continue
                            g = ti.Vector([grad[e, q, b, 0], grad[e, q, b, 1], grad[e, q, b, 2]])
                            n = conn[e, b]
                            for i in ti.static(range(3)):
                                f[n, i] = f[n, i] + w * (P[i, 0] * g[0] + P[i, 1] * g[1] + P[i, 2] * g[2])
                            g = w * g
                            H = ti.Matrix.zero(f64, 9, 3)
                            for r in ti.static(range(9)):
                                for j in ti.static(range(3)):
                                    H[r, j] = (
                                        A[r, 3 * j] * g[0] + A[r, 3 * j + 1] * g[1] + A[r, 3 * j + 2] * g[2]
                                    )
                            for a in range(b + 1):
                                takes = slot[e, a, b] >= 0
                                if sparse != 0:
                                    takes = takes and takes_part(grad, e, q, a)
                                if takes:  # all loads before all stores: the compiler may pair them then
                                    d = ti.Vector([grad[e, q, a, 0], grad[e, q, a, 1], grad[e, q, a, 2]])
                                    block = ti.Vector.zero(f64, 9)
                                    for r in ti.static(range(9)):
                                        i, j = ti.static(r // 3, r % 3)
                                        block[r] = ke[a, 9 * b + r] + (
                                            d[0] * H[3 * i, j]
                                            + d[1] * H[3 * i + 1, j]
                                            + d[2] * H[3 * i + 2, j]
                                        )
                                    for r in ti.static(range(9)):
                                        ke[a, 9 * b + r] = block[r]
                for b in range(na):
                    for a in range(b + 1):
                        s = slot[e, a, b]
                        if s >= 0:
                            block = s // 4
                            mode = s % 4
                            for i in ti.static(range(3)):
                                for j in ti.static(range(3)):
                                    v = ke[a, 9 * b + 3 * i + j]
                                    if kb != 0.0:
                                        v += kb / vol * ke[a, 9 * na + i] * ke[b, 9 * na + j]
                                    if mode != 1:
                                        values[block, i, j] = values[block, i, j] + v
                                    if mode != 0:
                                        values[block, j, i] = values[block, j, i] + v
            out[0] = 0.0
            out[1] = minj

    @ti.kernel
    def pressures(x: _f2, du: _f2, conn: _i2, grad: _f4, weight: _f2, kb: f64, pressure: _f1):
        """pressure (m,): kb mean(theta) at x, advanced to first order by the displacement du [Pa]."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            for e in range(conn.shape[0]):
                s = 0.0
                v = 0.0
                for q in range(weight.shape[1]):
                    F = deformation_gradient(x, conn, grad, e, q)
                    D = deformation_gradient(du, conn, grad, e, q)
                    J = determinant(F)
                    if J > 0.0:
                        th = theta(F.norm_sqr(), J)
                        T = 2.0 * th[1] * F + th[2] * cofactor(F)
                        s += weight[e, q] * (th[0] + (T * D).sum())
                    v += weight[e, q]
                pressure[e] = kb * s / v

    return energy, forces, stiffness, pressures


@cache
def evaluation_kernel(law: Law, features: Features = NONE) -> Kernel:
    """Kernel that evaluates a material at given F (n, 3, 3): psi (n,), P (n, 3, 3), A (n, 9, 9).

    state (1, n, k): that of the points.
    """
    ensure_runtime()
    _, _, _, tangent, _ = make_response(law, features)
    load_point = make_load_point(features)

    @ti.kernel
    def evaluate(F: _f3, prm: _f1, state: _f3, kappa: f64, psi: _f1, P: _f3, A: _f3):
        ti.loop_config(serialize=True)
        for n in range(F.shape[0]):
            G = ti.Matrix.zero(f64, 3, 3)
            for i in ti.static(range(3)):
                for k in ti.static(range(3)):
                    G[i, k] = F[n, i, k]
            point = load_point(state, 0, n)
            w, S, T = tangent(G, determinant(G), prm, kappa, 0.0, point)
            psi[n] = w
            for i in ti.static(range(3)):
                for k in ti.static(range(3)):
                    P[n, i, k] = S[i, k]
            for r in ti.static(range(9)):
                for s in ti.static(range(9)):
                    A[n, r, s] = T[r, s]

    return evaluate


@cache
def isochoric_kernels(law: Law, features: Features) -> tuple[Kernel, Kernel]:
    """Kernels (of a mesh, of given F) of what a point's history is made of, see `make_response`.

    C, S (m, q, 6), components 00, 11, 22, 01, 02, 12, S in [Pa]; w (m, q), the isochoric energy before
    softening [J/m3]. Given deformations F (n, 3, 3) are points of one element.
    """
    ensure_runtime()
    _, _, _, _, isochoric = make_response(law, features)
    load_point = make_load_point(features)
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

    @ti.kernel
    def of_mesh(x: _f2, conn: _i2, grad: _f4, prm: _f1, state: _f3, C: _f3, S: _f3, w: _f2):
        ti.loop_config(serialize=True)
        for _ in range(1):
            for e in range(conn.shape[0]):
                for q in range(w.shape[1]):
                    F = deformation_gradient(x, conn, grad, e, q)
                    c, s, energy = isochoric(F, determinant(F), prm, load_point(state, e, q))
                    for n in ti.static(range(6)):
                        i, k = ti.static(pairs[n])
                        C[e, q, n] = c[i, k]
                        S[e, q, n] = s[i, k]
                    w[e, q] = energy

    @ti.kernel
    def of_points(F: _f3, prm: _f1, state: _f3, C: _f3, S: _f3, w: _f2):
        ti.loop_config(serialize=True)
        for q in range(F.shape[0]):
            G = ti.Matrix.zero(f64, 3, 3)
            for i in ti.static(range(3)):
                for k in ti.static(range(3)):
                    G[i, k] = F[q, i, k]
            c, s, energy = isochoric(G, determinant(G), prm, load_point(state, 0, q))
            for n in ti.static(range(6)):
                i, k = ti.static(pairs[n])
                C[0, q, n] = c[i, k]
                S[0, q, n] = s[i, k]
            w[0, q] = energy

    return of_mesh, of_points
