"""Where a fit over time of made indentations without noise is moved from the truth to, to first order.

    python -m studies.calibration.shift 101 103 118        # a minute, most of it the first seed

The model at the true parameters less the forces of `benchmarks.blind.timed`, weighed as the fit weighs them;
a row a seed, changes of the logarithms of the free parameters in per cent, and their standard deviations.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.blind.timed.cases import draw_indentation, write
from calibration.experiment import read
from calibration.inference import Problem
from calibration.parameters import parametrisation
from calibration.study import parts
from calibration.study.measurements import measurements

STEP = 0.01  # of the logarithms


def shift(seed: int) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names of the free parameters, their shifts and standard deviations."""
    case = draw_indentation(seed)
    with tempfile.TemporaryDirectory() as scratch:
        write(case, Path(scratch) / "made", noise=0.0)
        experiment = read(Path(scratch) / "made")
    law = parts.with_parts(parametrisation("neo-hookean"), ("prony:2",), experiment, "M")
    data = measurements(experiment, "M", law, workers=1)
    assert data.pokes is not None
    problem = Problem(parametrisation=data.law, objectives=data.objectives)
    prony = case.solid.prony
    assert prony is not None
    truth = {"shear_modulus": case.solid.shear_modulus, "bulk_ratio": 300.0}
    for k, (fraction, time) in enumerate(zip(prony.fractions, prony.times, strict=True), 1):
        truth |= {f"prony_fraction_{k}": fraction, f"prony_time_{k}": time}
    names = [c.name for c in data.law.coordinates]
    u = np.log([truth[name] for name in names])
    if not problem.linearise(u):
        raise SystemExit(f"seed {seed}: no equilibrium at the truth")
    free = [k for k, c in enumerate(data.law.coordinates) if not c.held]
    moves = np.concatenate([sign * STEP * np.eye(len(u))[free] for sign in (1.0, -1.0)])
    ahead, behind = np.split(problem.residuals(u + moves), 2)
    jacobian = (ahead - behind).T / (2.0 * STEP)
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    found = -covariance @ (jacobian.T @ problem.residuals(u[None])[0])
    return [names[k] for k in free], found, np.sqrt(np.diag(covariance))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seeds", type=int, nargs="+")
    given = parser.parse_args()
    shifts = []
    for seed in given.seeds:
        names, moved, sd = shift(seed)
        row = [f"{n} {100 * m:+.1f} ({100 * s:.1f})" for n, m, s in zip(names, moved, sd, strict=True)]
        print(seed, *row, sep="  ", flush=True)
        shifts.append(moved)
    print("median", *(f"{100 * m:+.1f}" for m in np.median(shifts, axis=0)), sep="  ")


if __name__ == "__main__":
    main()
