"""3 x 3 tensors in Taichi: invariants, cofactor, principal stretches."""

# mypy: disable-error-code="no-untyped-def,valid-type"
# (Taichi compiles these functions; their annotations mean something to Taichi only)

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
        for p, q in ti.static(PAIRS):
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


@ti.func
def invariants(F):
    """C = F^T F and its I1, I2."""
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
    """eps_ijm of the permutation symbol, m the third index."""
    return 1 if (j - i) % 3 == 1 else -1


COFACTOR_ENTRIES = tuple(
    (i, k, j, l)
    for i in range(3)
    for k in range(3)
    for j in range(3)
    for l in range(3)
    if i != j and k != l and 3 * i + k < 3 * j + l
)
