"""Taichi kernels at the quadrature points: energy density and stress, and the data of a point's history.

Arguments are as in `tisim.kernels.elements`, whose forces are the integral of these stresses.
"""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"
# (Taichi compiles these functions and interprets their annotations)

from functools import cache

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti
from tisim.kernels.elements import MOST_NODES, deformation_gradient, force_functions, load_nodes
from tisim.kernels.isochoric import NONE, Features, make_load_point
from tisim.kernels.response import make_response
from tisim.kernels.tensors import determinant
from tisim.laws._law import Law

_f1 = ti.types.ndarray(dtype=f64, ndim=1)
_f2 = ti.types.ndarray(dtype=f64, ndim=2)
_f3 = ti.types.ndarray(dtype=f64, ndim=3)
_f4 = ti.types.ndarray(dtype=f64, ndim=4)
_i2 = ti.types.ndarray(dtype=i32, ndim=2)


@cache
def point_kernel(law: Law, features: Features = NONE) -> Kernel:
    """Kernel that fills psi (m, q) [J/m3] and the first Piola-Kirchhoff stress P (m, q, 9) [Pa], row by row.

    Both include the pressure of the element, kb mean(theta), if it has one. They are 0 at points where det F
    is not positive, as in the forces.
    """
    ensure_runtime()
    theta, _, stress, _, _ = make_response(law, features)
    mean_theta, _ = force_functions(law, features)
    load_point = make_load_point(features)

    @ti.kernel
    def points(
        x: _f2, conn: _i2, grad: _f4, weight: _f2, prm: _f1, state: _f3, kp: _f1, kb: f64, psi: _f2, P: _f3
    ):
        ti.loop_config(serialize=True)
        for _ in range(1):
            xe = ti.Vector.zero(f64, 3 * MOST_NODES)
            for e in range(conn.shape[0]):
                load_nodes(x, conn, e, xe)
                mean = 0.0
                if kb != 0.0:
                    mean, _v, _j = mean_theta(xe, grad, weight, e, 1e300)
                for q in range(weight.shape[1]):
                    F = deformation_gradient(xe, grad, e, q)
                    J = determinant(F)
                    psi[e, q] = 0.0
                    for r in ti.static(range(9)):
                        P[e, q, r] = 0.0
                    if J > 0.0:
                        w, S = stress(F, J, prm, kp[q], kb * mean, load_point(state, e, q))
                        if kb != 0.0:
                            w += kb * mean * (0.5 * mean - theta(F.norm_sqr(), J)[0])
                        psi[e, q] = w
                        for r in ti.static(range(9)):
                            P[e, q, r] = S[r // 3, r % 3]

    return points


@cache
def isochoric_kernels(law: Law, features: Features) -> tuple[Kernel, Kernel]:
    """Kernels (of a mesh, of given F) for the data of a point's history, see `isochoric` of `make_response`.

    They fill C and S [Pa] (m, q, 6), components 00, 11, 22, 01, 02, 12, and the isochoric energy before
    softening w (m, q) [J/m3]. Given deformation gradients F (n, 3, 3) are points of one element (m = 1).
    """
    ensure_runtime()
    _, _, _, _, isochoric = make_response(law, features)
    load_point = make_load_point(features)
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

    @ti.kernel
    def of_mesh(x: _f2, conn: _i2, grad: _f4, prm: _f1, state: _f3, C: _f3, S: _f3, w: _f2):
        ti.loop_config(serialize=True)
        for _ in range(1):
            xe = ti.Vector.zero(f64, 3 * MOST_NODES)
            for e in range(conn.shape[0]):
                load_nodes(x, conn, e, xe)
                for q in range(w.shape[1]):
                    F = deformation_gradient(xe, grad, e, q)
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
