"""Taichi kernels of one law over the elements of one mesh: energy, forces, stiffness, law evaluation.

All run serially and take NumPy arrays: positions x (n, 3) [m]; element nodes conn (m, a); shape-function
gradients in the rest shape grad (m, q, a, 3) [1/m]; rest volumes weight (m, q) [m3]; prm, the packed
parameters of the law and of the material's other parts; pointwise kp (q,) and mean kb volumetric stiffness
[Pa]; the points' state (m, q, k) (`tisim.kernels.isochoric.Features`).
The energy of an element is  sum_q w_q (W + kp_q/2 theta^2) + kb/2 V mean(theta)^2: with kb = 0 the plain
displacement element, else one with a constant pressure kb mean(theta), condensed ("P2/P0", "Q1/P0").

Forces and blocks of the tangent are accumulated by element in local variables of the kernel, not in its
arrays. The compiler assumes that a store into an array may change the shape or address of any array, and
computes these again at each access, which costs several times the sum itself.
"""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"
# (Taichi compiles these functions and interprets their annotations)

from functools import cache

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti
from tisim.kernels.isochoric import NONE, Features, make_load_point
from tisim.kernels.response import make_response
from tisim.kernels.tensors import cofactor, determinant
from tisim.laws._law import Law

_f1 = ti.types.ndarray(dtype=f64, ndim=1)
_f2 = ti.types.ndarray(dtype=f64, ndim=2)
_f3 = ti.types.ndarray(dtype=f64, ndim=3)
_f4 = ti.types.ndarray(dtype=f64, ndim=4)
_i2 = ti.types.ndarray(dtype=i32, ndim=2)
_i3 = ti.types.ndarray(dtype=i32, ndim=3)


MOST_NODES = 20  # of an element


@ti.func
def load_nodes(x: ti.template(), conn: ti.template(), e, xe: ti.template()):
    """Copy the positions of the element's nodes to xe (3 MOST_NODES,)."""
    for a in range(conn.shape[1]):
        n = conn[e, a]
        for i in ti.static(range(3)):
            xe[3 * a + i] = x[n, i]


@ti.func
def deformation_gradient(xe: ti.template(), grad: ti.template(), e, q):
    F = ti.Matrix.zero(f64, 3, 3)
    for a in range(grad.shape[2]):
        for i in ti.static(range(3)):
            for k in ti.static(range(3)):
                F[i, k] += xe[3 * a + i] * grad[e, q, a, k]
    return F


@ti.func
def add_by_node(P, grad: ti.template(), e, q, fe: ti.template()):
    """Add P times the gradient of each node's shape function to fe (3 MOST_NODES,)."""
    for a in range(grad.shape[2]):
        for i in ti.static(range(3)):
            s = 0.0
            for k in ti.static(range(3)):
                s += P[i, k] * grad[e, q, a, k]
            fe[3 * a + i] += s


@ti.func
def takes_part(grad: ti.template(), e, q, a):
    """True if node a contributes to the deformation at point q."""
    return grad[e, q, a, 0] != 0.0 or grad[e, q, a, 1] != 0.0 or grad[e, q, a, 2] != 0.0


@cache
def force_functions(law: Law, features: Features = NONE) -> tuple[Kernel, Kernel]:
    """Taichi functions (mean_theta, add_forces) of a material, for use inside kernels."""
    theta, _, stress, _, _ = make_response(law, features)
    load_point = make_load_point(features)

    @ti.func
    def mean_theta(xe: ti.template(), grad: ti.template(), weight: ti.template(), e, minj):
        """Volume-weighted mean of theta, rest volume and smallest det F; inverted points have theta = 0."""
        s = 0.0
        v = 0.0
        for q in range(weight.shape[1]):
            F = deformation_gradient(xe, grad, e, q)
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
        """Add the internal forces dEnergy/dx to f (n, 3) [N]; return energy [J] and smallest det F."""
        total = 0.0
        minj = 1e300
        xe = ti.Vector.zero(f64, 3 * MOST_NODES)
        fe = ti.Vector.zero(f64, 3 * MOST_NODES)
        for e in range(conn.shape[0]):
            load_nodes(x, conn, e, xe)
            for r in range(3 * conn.shape[1]):
                fe[r] = 0.0
            mean = 0.0
            if kb != 0.0:
                mean, v, minj = mean_theta(xe, grad, weight, e, minj)
                total += 0.5 * kb * v * mean * mean
            for q in range(weight.shape[1]):
                F = deformation_gradient(xe, grad, e, q)
                J = determinant(F)
                minj = ti.min(minj, J)
                if J > 0.0:
                    psi, P = stress(F, J, prm, kp[q], kb * mean, load_point(state, e, q))
                    th = 0.0
                    if kb != 0.0:
                        th = theta(F.norm_sqr(), J)[0]
                    total += weight[e, q] * (psi - kb * mean * th)
                    add_by_node(weight[e, q] * P, grad, e, q, fe)
            for a in range(conn.shape[1]):
                n = conn[e, a]
                for i in ti.static(range(3)):
                    f[n, i] = f[n, i] + fe[3 * a + i]
        return total, minj

    return mean_theta, add_forces


@cache
def element_kernels(law: Law, *, features: Features = NONE) -> tuple[Kernel, Kernel, Kernel, Kernel]:
    """Kernels (energy, forces, stiffness, pressures) of a material, compiled once for any mesh and values."""
    ensure_runtime()
    theta, psi_only, _, tangent, _ = make_response(law, features)
    mean_theta, add_forces = force_functions(law, features)
    load_point = make_load_point(features)

    @ti.kernel
    def energy(x: _f2, conn: _i2, grad: _f4, weight: _f2, prm: _f1, state: _f3, kp: _f1, kb: f64, out: _f1):
        """Fill out with energy [J] and smallest det F; the energy is meaningless if that is not positive."""
        total = 0.0
        minj = 1e300
        ti.loop_config(serialize=True)
        for _ in range(1):
            xe = ti.Vector.zero(f64, 3 * MOST_NODES)
            for e in range(conn.shape[0]):
                load_nodes(x, conn, e, xe)
                s = 0.0
                v = 0.0
                for q in range(weight.shape[1]):
                    F = deformation_gradient(xe, grad, e, q)
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
        """Add the internal forces dEnergy/dx to f (n, 3) [N]; out as in `energy`."""
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
        moduli: _f3,
        f: _f2,
        values: _f3,
        out: _f1,
    ):
        """Add d2Energy/dx2 to blocks `values` (nb, 3, 3) [N/m] and dEnergy/dx to f (n, 3) [N].

        pressure (m,) [Pa] replaces kb mean(theta) in the tangent's geometric part; the forces do not depend
        on it. sparse is 1 to skip nodes that do not contribute to a point (tetrahedra in a hexahedron), else
        0. slot (m, a, b), for a <= b: 4 * block + 0 (add), 1 (add transposed), 2 (both), or -1 (a fixed
        node). moduli (q, 9, 9) is scratch for an element's tangents at its points. out[1] is the smallest
        det F; out[0] is 0.
        """
        minj = 1e300
        ti.loop_config(serialize=True)
        for _ in range(1):
            na = conn.shape[1]
            xe = ti.Vector.zero(f64, 3 * MOST_NODES)
            fe = ti.Vector.zero(f64, 3 * MOST_NODES)
            slopes = ti.Vector.zero(f64, 3 * MOST_NODES)  # of the volume integral of theta
            # a point's gradients, and a block column of the element's matrix, by node: one variable per
            # component, so that the compiler generates vector instructions
            gx = ti.Vector.zero(f64, MOST_NODES)
            gy = ti.Vector.zero(f64, MOST_NODES)
            gz = ti.Vector.zero(f64, MOST_NODES)
            kxx = ti.Vector.zero(f64, MOST_NODES)
            kxy = ti.Vector.zero(f64, MOST_NODES)
            kxz = ti.Vector.zero(f64, MOST_NODES)
            kyx = ti.Vector.zero(f64, MOST_NODES)
            kyy = ti.Vector.zero(f64, MOST_NODES)
            kyz = ti.Vector.zero(f64, MOST_NODES)
            kzx = ti.Vector.zero(f64, MOST_NODES)
            kzy = ti.Vector.zero(f64, MOST_NODES)
            kzz = ti.Vector.zero(f64, MOST_NODES)
            for e in range(conn.shape[0]):
                load_nodes(x, conn, e, xe)
                for r in range(3 * na):
                    fe[r] = 0.0
                    slopes[r] = 0.0
                excess = 0.0
                vol = 0.0
                pe = 0.0
                if kb != 0.0:
                    mean, vol, minj = mean_theta(xe, grad, weight, e, minj)
                    pe = pressure[e]
                    excess = kb * mean - pe
                for q in range(weight.shape[1]):
                    F = deformation_gradient(xe, grad, e, q)
                    J = determinant(F)
                    minj = ti.min(minj, J)
                    w = weight[e, q]
                    if J > 0.0:
                        _psi, P, A = tangent(F, J, prm, kp[q], pe, load_point(state, e, q))
                        if kb != 0.0:
                            th = theta(F.norm_sqr(), J)
                            T = 2.0 * th[1] * F + th[2] * cofactor(F)
                            P += excess * T
                            add_by_node(w * T, grad, e, q, slopes)
                        add_by_node(w * P, grad, e, q, fe)
                        for r in ti.static(range(9)):
                            for t in ti.static(range(9)):
                                moduli[q, r, t] = w * A[r, t]
                    else:
                        for r in ti.static(range(9)):
                            for t in ti.static(range(9)):
                                moduli[q, r, t] = 0.0
                for a in range(na):
                    n = conn[e, a]
                    for i in ti.static(range(3)):
                        f[n, i] = f[n, i] + fe[3 * a + i]
                for b in range(na):
                    for a in range(MOST_NODES):
                        kxx[a] = 0.0
                        kxy[a] = 0.0
                        kxz[a] = 0.0
                        kyx[a] = 0.0
                        kyy[a] = 0.0
                        kyz[a] = 0.0
                        kzx[a] = 0.0
                        kzy[a] = 0.0
                        kzz[a] = 0.0
                    for q in range(weight.shape[1]):
                        if sparse != 0 and not takes_part(grad, e, q, b):
                            continue
                        for a in range(b + 1):
                            gx[a] = grad[e, q, a, 0]
                            gy[a] = grad[e, q, a, 1]
                            gz[a] = grad[e, q, a, 2]
                        H = ti.Matrix.zero(f64, 9, 3)
                        for r in ti.static(range(9)):
                            for j in ti.static(range(3)):
                                H[r, j] = (
                                    moduli[q, r, 3 * j] * gx[b]
                                    + moduli[q, r, 3 * j + 1] * gy[b]
                                    + moduli[q, r, 3 * j + 2] * gz[b]
                                )
                        for a in range(b + 1):
                            x0 = gx[a]
                            x1 = gy[a]
                            x2 = gz[a]
                            kxx[a] += x0 * H[0, 0] + x1 * H[1, 0] + x2 * H[2, 0]
                            kxy[a] += x0 * H[0, 1] + x1 * H[1, 1] + x2 * H[2, 1]
                            kxz[a] += x0 * H[0, 2] + x1 * H[1, 2] + x2 * H[2, 2]
                            kyx[a] += x0 * H[3, 0] + x1 * H[4, 0] + x2 * H[5, 0]
                            kyy[a] += x0 * H[3, 1] + x1 * H[4, 1] + x2 * H[5, 1]
                            kyz[a] += x0 * H[3, 2] + x1 * H[4, 2] + x2 * H[5, 2]
                            kzx[a] += x0 * H[6, 0] + x1 * H[7, 0] + x2 * H[8, 0]
                            kzy[a] += x0 * H[6, 1] + x1 * H[7, 1] + x2 * H[8, 1]
                            kzz[a] += x0 * H[6, 2] + x1 * H[7, 2] + x2 * H[8, 2]
                    for a in range(b + 1):
                        s = slot[e, a, b]
                        if s >= 0:
                            block = s // 4
                            mode = s % 4
                            K = ti.Matrix(
                                [
                                    [kxx[a], kxy[a], kxz[a]],
                                    [kyx[a], kyy[a], kyz[a]],
                                    [kzx[a], kzy[a], kzz[a]],
                                ]
                            )
                            for i in ti.static(range(3)):
                                for j in ti.static(range(3)):
                                    v = K[i, j]
                                    if kb != 0.0:
                                        v += kb / vol * slopes[3 * a + i] * slopes[3 * b + j]
                                    if mode != 1:
                                        values[block, i, j] = values[block, i, j] + v
                                    if mode != 0:
                                        values[block, j, i] = values[block, j, i] + v
            out[0] = 0.0
            out[1] = minj

    @ti.kernel
    def pressures(x: _f2, du: _f2, conn: _i2, grad: _f4, weight: _f2, kb: f64, pressure: _f1):
        """Fill pressure (m,) [Pa] with kb mean(theta) at x, advanced to first order by displacements du."""
        ti.loop_config(serialize=True)
        for _ in range(1):
            xe = ti.Vector.zero(f64, 3 * MOST_NODES)
            de = ti.Vector.zero(f64, 3 * MOST_NODES)
            for e in range(conn.shape[0]):
                load_nodes(x, conn, e, xe)
                load_nodes(du, conn, e, de)
                s = 0.0
                v = 0.0
                for q in range(weight.shape[1]):
                    F = deformation_gradient(xe, grad, e, q)
                    D = deformation_gradient(de, grad, e, q)
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

    state (1, n, k) is that of the points, kappa the pointwise volumetric stiffness [Pa].
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
