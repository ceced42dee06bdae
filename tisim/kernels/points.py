"""Taichi kernel of one material over a mesh: energy density and stress at the points of integration.

Arguments as in `tisim.kernels.elements`, whose forces are the sum of these stresses.
"""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"
# (Taichi compiles these functions; their annotations mean something to Taichi only)

from functools import cache

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti
from tisim.kernels.elements import MOST_NODES, deformation_gradient, force_functions, load_nodes
from tisim.kernels.isochoric import NONE, Features, make_load_point
from tisim.kernels.response import make_response
from tisim.kernels.tensors import determinant
from tisim.laws import Law

_f1 = ti.types.ndarray(dtype=f64, ndim=1)
_f2 = ti.types.ndarray(dtype=f64, ndim=2)
_f3 = ti.types.ndarray(dtype=f64, ndim=3)
_f4 = ti.types.ndarray(dtype=f64, ndim=4)
_i2 = ti.types.ndarray(dtype=i32, ndim=2)


@cache
def point_kernel(law: Law, features: Features = NONE) -> Kernel:
    """Kernel that fills psi (m, q) [J/m3] and P (m, q, 9) [Pa], first Piola-Kirchhoff, row by row.

    The pressure of an element that has one, kb mean(theta), is in both; they are 0 where det F is not
    positive, as in the forces.
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
