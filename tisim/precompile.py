"""Compile kernels before they are needed, so that processes started later find them on disk.

    python -m tisim.precompile                                  # each law, without further parts
    python -m tisim.precompile ogden neo-hookean+prony          # chosen ones: a law, and parts after "+"

A kernel is compiled at its first use, which takes seconds, and Taichi writes compiled kernels to disk at the
end of the process. Processes that run at the same time therefore compile the same kernels each. Run this
command once before many processes start together: in a container's image, before the jobs of a cluster,
before a test run.
"""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from multiprocessing import get_context
from typing import Any

import numpy as np

import tisim

_log = logging.getLogger(__name__)

PARTS: dict[str, tuple[str, Any]] = {
    "prony": ("viscosity", tisim.Prony(fractions=(0.3,), times=(1.0,))),
    "ogden-roxburgh": ("softening", tisim.OgdenRoxburgh(r=2.0, m=1e3)),
    "holzapfel-gasser-ogden": ("fibres", tisim.HolzapfelGasserOgden(direction=(1.0, 0.0, 0.0), k1=1e4)),
}
"""Parts by name, with the material's field; kernels depend on the type of a part, not on its parameters."""


def material(name: str) -> tisim.Material:
    """Material with the law and parts in `name`, separated by "+" (`ogden+prony`).

    Raises
    ------
    ValueError
        For an unknown law or part; the message lists the known ones.
    """
    law, *parts = name.split("+")
    if law not in tisim.laws.all_names():
        raise ValueError(f"{name}: expected a law of {', '.join(tisim.laws.all_names())}, got {law!r}")
    for part in parts:
        if part not in PARTS:
            raise ValueError(f"{name}: expected parts of {', '.join(PARTS)}, got {part!r}")
    plain = tisim.material_from_moduli(law, shear_modulus=2e4, bulk_modulus=1e6)
    return replace(plain, **dict(PARTS[part] for part in parts))


def precompile(names: Iterable[str] = (), *, workers: int = 1) -> list[str]:
    """Compile the kernels of materials in other processes, which write them to disk.

    Parameters
    ----------
    names : iterable of str
        Names of materials (see `material`); if empty, all laws without further parts.
    workers : int
        Number of processes; a law's kernels take five seconds and 300 MB.

    Returns
    -------
    list of str
        Names of the compiled materials, in the order given.

    Raises
    ------
    ValueError
        For an unknown law or part, or less than one worker, before anything is compiled.
    """
    if workers < 1:
        raise ValueError(f"--workers: expected 1 or more, got {workers}")
    wanted = list(names) or list(tisim.laws.all_names())
    for name in wanted:
        material(name)
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(_compile, name): name for name in wanted}
        for count, done in enumerate(as_completed(running), 1):
            done.result()
            _log.info("%d of %d: %s", count, len(wanted), running[done])
    return wanted


def _compile(name: str) -> None:
    """Call each kernel of a material once, those of explicit steps only for a material without history."""
    from tisim.discretisation.body import Discretisation, DiscretisedBody
    from tisim.material_points import MaterialPoints
    from tisim.problems.dynamics.explicit import march

    made = material(name)
    mesh = tisim.mesh.beam_mesh(
        length=0.02, section=tisim.Circle(radius=0.005), axial_element_size=0.01, radial_elements=1
    )
    body = DiscretisedBody(Discretisation.build(mesh, mesh.node_sets["clamp"]), made)
    body.begin(0.1)
    body.energy(mesh.nodes)
    body.internal_forces(mesh.nodes)
    body.stiffness(mesh.nodes)
    body.accept(mesh.nodes)
    body.point_response(mesh.nodes)
    if not body.remembers:
        march(body, tisim.Solver(method="explicit", duration=1e-5))
    point = MaterialPoints(made)
    point.begin(0.1)
    point.evaluate(np.eye(3)[None])
    point.accept(np.eye(3)[None])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m tisim.precompile", description="Compile kernels before they are needed."
    )
    parser.add_argument(
        "material", nargs="*", help=f"law, or law+part+...; laws: {', '.join(tisim.laws.all_names())} (all"
        f" when none is given); parts: {', '.join(PARTS)}"
    )  # fmt: skip
    parser.add_argument("--workers", type=int, default=1, help="number of processes (default: 1)")
    parser.add_argument("--version", action="version", version=f"tisim {tisim.__version__}")
    given = parser.parse_args(arguments)
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    try:
        precompile(given.material, workers=given.workers)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
