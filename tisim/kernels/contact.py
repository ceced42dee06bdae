"""Contact of a facet set with a rigid rod: hardening penalty, Coulomb friction with memory.

The rod is a cylinder with a rounded edge (a hemisphere if the edge radius is the radius), axis `a`
pointing ahead of the tip, centre of the tip `c`. Its signed distance in the meridian plane, with r the
distance from the axis and s the height ahead of the tip, is that of a rounded box:
q = (r - (R - e), s + e), d = |max(q, 0)| + min(max(q), 0) - e.

Contact is integrated at many points per facet (with nodes alone, the edge passes through the surface).
Energy of a point of area A: A [kn/2 o^2 (1 + (o/h)^4/3) + mu p w(g)], with the overlap o = max(-d, 0), g
the elastic part of the slip and w(g) = g^2/(2 l) up to the elastic slip l, g - l/2 beyond it. So friction
grows linearly with g to the Coulomb limit mu p, which it reaches at the same slip l whatever the pressure
is. This is a return mapping whose history variable is g at the last converged step, so that a sticking
point does not creep from step to step. The pressure p = kn o (1 + (o/h)^4) is almost linear below the
overlap h and grows with the fifth power of o above it, which bounds the penetration.
p is fixed during a line search and updated at every linearisation: the residual is Coulomb's law without lag.
The dependence of mu p and of the tangent plane on x makes the tangent unsymmetric. The unsymmetric part, a
3 x 3 matrix per point, is stored separately for the linear solver (without it convergence is slow where
points slip and where they pass the rounded edge).
A point that first touches in this step slips only for the fraction of the step in which it touches, estimated
from the step's start value.

The kernels read the contact's constants from `law`: kn [Pa/m], l [m], mu, h [m].
"""

# mypy: disable-error-code="no-untyped-def,valid-type,index,attr-defined,operator"

from functools import cache
from typing import Any

import numpy as np

from tisim.kernels._taichi import Kernel, ensure_runtime, f64, i32, ti

_f1 = ti.types.ndarray(dtype=f64, ndim=1)
_f2 = ti.types.ndarray(dtype=f64, ndim=2)
_f3 = ti.types.ndarray(dtype=f64, ndim=3)
_i2 = ti.types.ndarray(dtype=i32, ndim=2)
_i3 = ti.types.ndarray(dtype=i32, ndim=3)


@ti.func
def rod_distance(y, rod: ti.template()):
    """Signed distance d [m], outward normal n, principal curvatures km and kr [1/m], and direction t.

    km is the curvature of d's level set along the meridian (direction n x t), kr that around the axis
    (direction t). For `rod` see `pack_rod`.
    """
    c = ti.Vector([rod[0], rod[1], rod[2]])
    a = ti.Vector([rod[3], rod[4], rod[5]])
    core = rod[6] - rod[7]
    e = rod[7]
    s = (y - c).dot(a)
    radial = (y - c) - s * a
    r = radial.norm()
    er = radial / ti.max(r, 1e-12)
    qr = r - core
    qs = s + e
    d = 0.0
    n = a
    km = 0.0
    kr = 0.0
    if qr > 0.0 and qs > 0.0:  # around the rounded edge
        g = ti.sqrt(qr * qr + qs * qs)
        d = g - e
        n = (qr * er + qs * a) / ti.max(g, 1e-12)
        km = 1.0 / ti.max(g, 1e-12)
        kr = qr / ti.max(g, 1e-12) / ti.max(r, 1e-12)
    elif qr > qs:  # beside the shaft
        d = qr - e
        n = er
        kr = 1.0 / ti.max(r, 1e-12)
    else:  # under the flat
        d = qs - e
    t = er.cross(a)  # around the axis
    return d, n, km, kr, t


@ti.func
def penalty(d, law: ti.template()):
    """Energy [J/m2], pressure [Pa] and stiffness [Pa/m] at the signed distance d [m]."""
    overlap = ti.max(0.0, -d)
    harder = (overlap / law[3]) ** 4
    energy = 0.5 * law[0] * overlap * overlap * (1.0 + harder / 3.0)
    return energy, law[0] * overlap * (1.0 + harder), law[0] * (1.0 + 5.0 * harder)


@cache
def contact_kernels() -> tuple[Kernel, Kernel, Kernel]:
    """Kernels (measure, energy, assemble); see each of them."""
    ensure_runtime()

    @ti.func
    def sample(x: ti.template(), conn: ti.template(), shape: ti.template(), f, q):
        y = ti.Vector([0.0, 0.0, 0.0])
        for b in range(conn.shape[1]):
            n = conn[f, b]
            for i in ti.static(range(3)):
                y[i] += shape[q, b] * x[n, i]
        return y

    @ti.func
    def rod_shift(y, rod: ti.template()):
        """Displacement since the last converged step of the rod's point that is now at y."""
        shift = ti.Vector([rod[8], rod[9], rod[10]])
        return shift + rod_spin(rod) @ (y - ti.Vector([rod[0], rod[1], rod[2]]))

    @ti.func
    def rod_spin(rod: ti.template()):
        """I - R^T, R the rod's rotation since the last converged step."""
        W = ti.Matrix.zero(f64, 3, 3)
        for i in ti.static(range(3)):
            for j in ti.static(range(3)):
                W[i, j] = rod[11 + 3 * i + j]
        return W

    @ti.func
    def total_slip(y, z, shift, memory: ti.template(), part: ti.template(), f, q):
        """Trial slip: that of the last converged step (`memory`) plus that since then.

        z is the point at the last converged step, shift the rod's displacement there since then, part the
        fraction of the step in which the point touches (0: no friction).
        """
        g = ti.Vector([memory[f, q, 0], memory[f, q, 1], memory[f, q, 2]])
        return g + part[f, q] * (y - z - shift)

    @ti.kernel
    def measure(x: _f2, conn: _i2, shape: _f2, rod: _f1, distance: _f2):
        """Fill distance (f, q), the signed distance of every point from the rod [m]."""
        ti.loop_config(serialize=True)
        for f in range(conn.shape[0]):
            for q in range(shape.shape[0]):
                d, _n, _km, _kr, _t = rod_distance(sample(x, conn, shape, f, q), rod)
                distance[f, q] = d

    @ti.kernel
    def energy(
        x: _f2, z: _f2, conn: _i2, shape: _f2, area: _f2, rod: _f1, law: _f1,
        memory: _f3, part: _f2, pressure: _f2, out: _f1,
    ):  # fmt: skip
        """Fill out: energy at fixed pressures in the friction [J], smallest distance [m]."""
        total = 0.0
        least = 1e300
        ti.loop_config(serialize=True)
        for _ in range(1):
            for f in range(conn.shape[0]):
                for q in range(shape.shape[0]):
                    y = sample(x, conn, shape, f, q)
                    d, n, _km, _kr, _t = rod_distance(y, rod)
                    least = ti.min(least, d)
                    if d < 0.0:
                        total += area[f, q] * penalty(d, law)[0]
                    limit = law[2] * pressure[f, q]
                    if limit > 0.0 and part[f, q] > 0.0:
                        shift = rod_shift(y, rod)
                        g0 = total_slip(y, sample(z, conn, shape, f, q), shift, memory, part, f, q)
                        g = (g0 - g0.dot(n) * n).norm()
                        part_of_limit = g - 0.5 * law[1]
                        if g <= law[1]:
                            part_of_limit = 0.5 * g * g / law[1]
                        total += area[f, q] * limit * part_of_limit
            out[0] = total
            out[1] = least

    @ti.kernel
    def assemble(
        x: _f2, z: _f2, conn: _i2, shape: _f2, area: _f2, rod: _f1, law: _f1,
        memory: _f3, part: _f2, pressure: _f2, slip: _f3, skew: _f3, slot: _i3,
        force: _f2, blocks: _f3, out: _f1,
    ):  # fmt: skip
        """Add the energy gradient to force (n, 3) and the symmetric part of the tangent to blocks.

        Also fills pressure (f, q) [Pa], slip (f, q, 3), the elastic slip after the return mapping [m], and
        skew (f, q, 9), the unsymmetric rest of each point's tangent, row by row. out[0:3]: force of the body
        on the rod [N], out[3]: smallest distance [m], out[4]: area in contact [m2], out[5]: 1 if friction
        acts at a point, else 0.
        """
        out[5] = 0.0
        total = ti.Vector([0.0, 0.0, 0.0])
        least = 1e300
        touching = 0.0
        ti.loop_config(serialize=True)
        for _ in range(1):
            for f in range(conn.shape[0]):
                for q in range(shape.shape[0]):
                    y = sample(x, conn, shape, f, q)
                    d, n, km, kr, t = rod_distance(y, rod)
                    least = ti.min(least, d)
                    _e, p, k = penalty(d, law)
                    pressure[f, q] = p
                    for i in ti.static(range(3)):
                        slip[f, q, i] = 0.0
                    for i in ti.static(range(9)):
                        skew[f, q, i] = 0.0
                    if d < 0.0:
                        touching += area[f, q]
                        m = n.cross(t)
                        grad = -p * n
                        H = k * n.outer_product(n) - p * (km * m.outer_product(m) + kr * t.outer_product(t))
                        limit = law[2] * pressure[f, q]
                        if limit > 0.0 and part[f, q] > 0.0:
                            shift = rod_shift(y, rod)
                            z_q = sample(z, conn, shape, f, q)
                            g0 = total_slip(y, z_q, shift, memory, part, f, q)
                            g = g0 - g0.dot(n) * n
                            size = g.norm()
                            N = km * m.outer_product(m) + kr * t.outer_product(t)  # dn/dy
                            T = ti.Matrix.identity(f64, 3) - n.outer_product(n)
                            G = (
                                part[f, q] * T @ (ti.Matrix.identity(f64, 3) - rod_spin(rod))
                                - n.outer_product(N @ g0)
                                - g0.dot(n) * N
                            )  # dg/dy
                            stiffness = limit / ti.max(size, law[1])
                            u = g / ti.max(size, law[1])  # part of the limit
                            along = ti.Matrix.zero(f64, 3, 3)
                            if size > law[1]:
                                along = u.outer_product(u)
                            D = stiffness * (G - along @ G) - law[2] * k * u.outer_product(n)
                            symmetric = part[f, q] * stiffness * (T - along)
                            grad += limit * u
                            H += symmetric
                            for i in ti.static(range(3)):
                                slip[f, q, i] = law[1] * u[i]
                                for j in ti.static(range(3)):
                                    skew[f, q, 3 * i + j] = area[f, q] * (D[i, j] - symmetric[i, j])
                            out[5] = 1.0
                        w = area[f, q]
                        total += w * grad
                        for b in range(conn.shape[1]):
                            node = conn[f, b]
                            for i in ti.static(range(3)):
                                force[node, i] = force[node, i] + w * shape[q, b] * grad[i]
                            for a in range(b + 1):
                                s = slot[f, a, b]
                                if s >= 0:
                                    v = w * shape[q, a] * shape[q, b]
                                    for i in ti.static(range(3)):
                                        for j in ti.static(range(3)):
                                            h = v * H[i, j]
                                            if s % 4 != 1:
                                                blocks[s // 4, i, j] = blocks[s // 4, i, j] + h
                                            if s % 4 != 0:
                                                blocks[s // 4, j, i] = blocks[s // 4, j, i] + h
            for i in ti.static(range(3)):
                out[i] = total[i]
            out[3] = least
            out[4] = touching

    return measure, energy, assemble


def pack_rod(tip: Any, axis: Any, radius: float, edge_radius: float, shift: Any, rotation: Any = None) -> Any:
    """The rod for the kernels: tip (3), unit axis (3), radius, edge radius, displacement (3), I - R^T (9).

    shift is the displacement of the tip [m] and rotation the rotation R (3, 3) of the rod since the last
    converged step; None if it kept its direction.
    """
    spin = np.zeros(9) if rotation is None else (np.eye(3) - np.asarray(rotation).T).ravel()
    return np.concatenate([tip, axis, [radius, edge_radius], shift, spin]).astype(np.float64)
