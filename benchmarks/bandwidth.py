"""Fraction of the memory-bandwidth and arithmetic limits that a poke's main kernels reach; prints a table.

    python -m benchmarks.bandwidth                # the default poke mesh: 20 s
    python -m benchmarks.bandwidth --refinement 1.5

Set OMP_NUM_THREADS, MKL_NUM_THREADS and OPENBLAS_NUM_THREADS to 1.

The limits are measured on one core. Bandwidth: a copy (NumPy, 16 B per float64 entry: read and written) and a
read (a float32 dot product of two arrays), each with 256 MiB, which exceeds the caches, and with as many
bytes as the factor has, which the caches may hold. Arithmetic: a float64 matrix product of 1000 x 1000;
float32, in which the factor is computed, can be twice as fast.

Bytes that must be moved at least: a solve reads the factor (float32) once forward and once backward; assembly
reads gradients, weights, node numbers and slots of each element and the node positions once, and reads and
writes each block once. Operations of the assembly are counted from the kernel's loops (multiplications and
additions); the tangent of the constitutive law counts as LAW_OPERATIONS per quadrature point. Times are
medians of --repeats, in CPU seconds.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import tisim
from tisim.discretisation.body import Discretisation
from tisim.linear.pardiso import Pardiso
from tisim.mesh import poke_mesh
from tisim.problems.indentation.system import PokeSystem

LAW_OPERATIONS = 1100  # invariants, cofactors, 45 entries of the tangent by outer products, its mirror


def seconds(run: Callable[[], object], repeats: int) -> float:
    """Median CPU seconds of a call, after one warm-up call."""
    run()
    found = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        found.append(time.process_time() - start)
    return statistics.median(found)


def many(run: Callable[[], object], times: int) -> Callable[[], None]:
    """Function that makes the call `times` times, for calls too short for the clock's resolution."""

    def loop() -> None:
        for _ in range(times):
            run()

    return loop


def copying(size: int, repeats: int) -> float:
    """Throughput [B/s] of a copy whose two arrays take `size` bytes together."""
    a = np.ones(size // 16)
    b = np.empty_like(a)
    times = max(1, (1 << 28) // size)
    return 16.0 * len(a) * times / seconds(many(lambda: np.copyto(b, a), times), repeats)


def reading(size: int, repeats: int) -> float:
    """Throughput [B/s] of a dot product whose two arrays take `size` bytes together."""
    a = np.ones(size // 8, dtype=np.float32)
    b = np.ones_like(a)
    times = max(1, (1 << 28) // size)
    return 8.0 * len(a) * times / seconds(many(lambda: np.dot(a, b), times), repeats)


def assembly_operations(elements: int, points: int, nodes: int) -> float:
    """Number of floating-point operations of `stiffness` with an element pressure."""
    gradient = 2 * 18 * nodes  # F twice: for the mean volume change and for the stress
    vector = nodes * (3 * 7 + 3 * 7)  # forces and the pressure's vector
    blocks = nodes * 27 * 6 + nodes * (nodes + 1) // 2 * 9 * 6
    condensed = nodes * (nodes + 1) // 2 * 9 * 4
    return float(elements * (points * (gradient + vector + blocks + LAW_OPERATIONS) + condensed))


def main() -> None:
    """Print the limits and the fractions reached."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--refinement", type=float, default=1.0)
    parser.add_argument("--repeats", type=int, default=7)
    args = parser.parse_args()
    scene = tisim.Poke(
        material=tisim.material_from_moduli("neo-hookean", shear_modulus=30e3, bulk_modulus=600e3),
        refinement=args.refinement,
    )
    mesh = poke_mesh(
        block=scene.block,
        site=scene.site,
        direction=scene.direction,
        rod=scene.rod,
        refinement=args.refinement,
    )
    discretisation = Discretisation.build(mesh, mesh.node_sets["base"])
    system = PokeSystem(scene, discretisation)
    body, pattern = system.body, discretisation.pattern
    blocks = body.stiffness(mesh.nodes)[0]
    factor = Pardiso(pattern.indptr, pattern.indices, single=True)
    factor._iparm[17] = -1  # request the number of entries of the factor
    factor._iparm[18] = -1  # and the number of operations
    factor.factorise(blocks)
    rhs = np.random.default_rng(0).normal(size=(len(pattern.free), 3))
    solve = seconds(many(lambda: factor.solve(rhs), 10), args.repeats) / 10
    factorise = seconds(lambda: factor.factorise(blocks), args.repeats)
    assemble = seconds(lambda: body.stiffness(mesh.nodes), args.repeats)

    # PARDISO counts 3 x 3 blocks, consistent with the memory that it reports
    entries, held = 9 * int(factor._iparm[17]), 1024 * int(factor._iparm[16])
    factor_bytes = 4.0 * entries
    ref = discretisation.reference
    elements, points, nodes, _ = ref.gradients.shape
    inputs = (ref.gradients, ref.weights, mesh.elements, pattern.slot, mesh.nodes)
    assembly_bytes = float(sum(a.nbytes for a in inputs) + 2 * blocks.nbytes)
    operations = assembly_operations(elements, points, nodes)

    big = 1 << 28
    near = max(1 << 20, int(factor_bytes))
    limits = {
        "copy, 256 MiB": copying(big, args.repeats),
        "read, 256 MiB": reading(big, args.repeats),
        "copy, the factor's size": copying(near, args.repeats),
        "read, the factor's size": reading(near, args.repeats),
    }
    a = np.ones((1000, 1000))
    peak = 2e9 / seconds(lambda: a @ a, args.repeats)

    print(f"poke mesh: {mesh.n_nodes} nodes, {elements} hexahedra; factor {entries / 1e6:.1f} M entries,"
          f" {factor_bytes / 2**20:.0f} MiB (PARDISO holds {held / 2**20:.0f} MiB)")  # fmt: skip
    for name, rate in limits.items():
        print(f"limit: {name:26s} {rate / 1e9:7.1f} GB/s")
    print(f"limit: {'matrix product':26s} {peak / 1e9:7.1f} Gflop/s\n")
    names = ("copy, memory", "read, memory", "copy, cached", "read, cached")
    columns = "".join(f"{'of ' + n:>18s}" for n in names)
    print(f"{'':24s} {'ms':>7s} {'MB':>7s} {'GB/s':>7s}{columns} {'Gflop/s':>9s} of product")
    rows = [
        ("GMRES: factor solve", solve, 2 * factor_bytes, 4.0 * entries),
        ("factorisation", factorise, factor_bytes, 27e6 * float(factor._iparm[18])),
        ("assembly (stiffness)", assemble, assembly_bytes, operations),
    ]
    for name, took, moved, work in rows:
        rate = moved / took
        shares = "".join(f"{100 * rate / limit:17.0f}%" for limit in limits.values())
        print(f"{name:24s} {took * 1e3:7.2f} {moved / 1e6:7.1f} {rate / 1e9:7.1f}{shares}"
              f" {work / took / 1e9:9.1f} {100 * work / took / peak:9.0f}%")  # fmt: skip


if __name__ == "__main__":
    main()
