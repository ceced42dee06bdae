"""3 x 3 tensors in Taichi: invariants, cofactor, principal stretches."""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions and interprets their annotations)

from tisim.kernels._taichi import ti

PAIRS = ((0, 1), (0, 2), (1, 2))


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
def _cos_of_third(r):
    """cos(acos(r) / 3) for r from 0 to 1: the root x of 4 x^3 - 3 x = r, by Newton's method."""
    x = 0.8660254037844386 + r * (0.16667 - 0.0327 * r)
    for _ in ti.static(range(3)):
        x -= ((4.0 * x * x - 3.0) * x - r) / (12.0 * x * x - 3.0)
    return x


@ti.func
def _frame_of_eigenvector(C):
    """Rotation whose last column is an eigenvector of C, up to rounding; the identity if C is isotropic.

    The eigenvector of the most distinct eigenvalue, in closed form: the longest cross product of two rows of
    C minus that eigenvalue (Scherzinger and Dohrmann, Comput. Methods Appl. Mech. Eng. 197, 2008).
    """
    V = ti.Matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    mean = (C[0, 0] + C[1, 1] + C[2, 2]) / 3.0
    B = C - mean * V
    size = B.norm_sqr() / 6.0
    if size > 1e-24 * mean * mean:
        p = ti.sqrt(size)
        r = 0.5 * determinant(B) / (size * p)
        root = 2.0 * p * _cos_of_third(ti.min(ti.abs(r), 1.0))
        if r < 0.0:
            root = -root
        x = ti.Vector([B[0, 0] - root, B[0, 1], B[0, 2]])
        y = ti.Vector([B[1, 0], B[1, 1] - root, B[1, 2]])
        z = ti.Vector([B[2, 0], B[2, 1], B[2, 2] - root])
        w = x.cross(y)
        length = w.norm_sqr()
        for other in ti.static((y.cross(z), z.cross(x))):
            if other.norm_sqr() > length:
                w = other
                length = other.norm_sqr()
        w /= ti.sqrt(length)
        u = ti.Vector([0.0, w[2], -w[1]])
        if ti.abs(w[0]) > ti.abs(w[1]):
            u = ti.Vector([-w[2], 0.0, w[0]])
        u /= u.norm()
        v = w.cross(u)
        for k in ti.static(range(3)):
            V[k, 0] = u[k]
            V[k, 1] = v[k]
            V[k, 2] = w[k]
    return V


@ti.func
def eigen_symmetric(C):
    """Eigenvalues (3) and eigenvectors (columns) of a symmetric 3 x 3 matrix.

    Jacobi rotations from the closed-form `_frame_of_eigenvector`, after which usually one is left. They are
    backward stable, also for repeated eigenvalues. `ti.sym_eig` has errors of 6e-6 near the identity.
    """
    V = _frame_of_eigenvector(C)
    A = V.transpose() @ C @ V
    small = 1e-31 * (A[0, 0] * A[0, 0] + A[1, 1] * A[1, 1] + A[2, 2] * A[2, 2])
    for _ in range(12):
        for p, q in ti.static(PAIRS):
            r = ti.static(3 - p - q)
            apq = A[p, q]
            if apq * apq > small:
                half = 0.5 * (A[q, q] - A[p, p])
                t = apq / (ti.abs(half) + ti.sqrt(half * half + apq * apq))
                if half < 0.0:
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
        if ti.max(A[0, 1] * A[0, 1], A[0, 2] * A[0, 2], A[1, 2] * A[1, 2]) <= small:
            break
    return ti.Vector([A[0, 0], A[1, 1], A[2, 2]]), V


@ti.func
def invariants(F):
    """C = F^T F and its invariants I1 and I2."""
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
    """Principal stretches (3) and their directions (columns)."""
    lam2, V = eigen_symmetric(C)
    return ti.sqrt(ti.max(lam2, 1e-300)), V


def sign(i: int, j: int) -> int:
    """Permutation symbol eps_ijm, m being the third index."""
    return 1 if (j - i) % 3 == 1 else -1


COFACTOR_ENTRIES = tuple(
    (i, k, j, l)
    for i in range(3)
    for k in range(3)
    for j in range(3)
    for l in range(3)
    if i != j and k != l and 3 * i + k < 3 * j + l
)
