"""How often made presses are diagnosed rightly: counts of verdicts, for docs/compression-diagnosis.md.

    python tests/calibration/diagnosis_presses/survey_presses.py [CASES]      # 12 of each kind: a core-minute

Noise of 0.1 to 0.6 % of the largest stress; bonded data are FElupe's. Seeds are fixed.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable

import numpy as np
from diagnosis_press_cases import SHEAR, bonded, both, experiment, pressed, ramps, sliding

from calibration.diagnosis.presses import PressModel
from calibration.diagnosis.run import diagnose
from calibration.experiment import Experiment


def clean(seed: int, rng: np.random.Generator) -> Experiment:
    """One to three ramps."""
    strain = ramps(int(rng.integers(1, 4)))
    return both(sliding, strain=strain, seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def repeats(seed: int, rng: np.random.Generator) -> Experiment:
    """Five tests that differ smoothly by a percent, and by nothing else."""
    strain = ramps(1)
    odd = [0.01 * a + 0.01 * b * (4 * strain - 1) for a, b in rng.standard_normal((5, 2))]
    tests = [
        pressed(f"A{k}", sliding(strain) * np.exp(x), seed=seed + k, noise=0.002) for k, x in enumerate(odd)
    ]
    return experiment(*tests)


def stuck(seed: int, rng: np.random.Generator) -> Experiment:
    """Bonded platens."""
    return both(bonded(), seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def mooney(seed: int, rng: np.random.Generator) -> Experiment:
    """Bonded, and a second invariant beside."""
    return both(bonded("mooney-rivlin 0.3"), seed=seed, noise=float(rng.uniform(0.001, 0.006)))


def kink(seed: int, rng: np.random.Generator) -> Experiment:
    """A drop by 2 to 6 % somewhere, in no library."""
    at, by = rng.uniform(0.08, 0.4), rng.uniform(0.02, 0.06)
    return both(lambda strain: sliding(strain) * (1.0 - by * (strain > at)), seed=seed, noise=0.002)


KINDS: tuple[Callable[[int, np.random.Generator], Experiment], ...] = (clean, repeats, stuck, mooney, kink)


def main() -> None:
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    for kind in KINDS:
        counts: Counter[str] = Counter()
        off = []
        for k in range(cases):
            found = diagnose(PressModel(kind(100 * k, np.random.default_rng(1000 + k))), gain=False)
            rivals = " or ".join(" + ".join(names) for names in found.finding.rivals)
            counts[f"{found.finding.verdict} {rivals}".strip()] += 1
            numbers = found.extended or found.baseline
            off += [abs(g / SHEAR[m] - 1.0) for m, g in numbers.shear_modulus_Pa.items()]
        print(kind.__name__, dict(counts), f"moduli off by {100 * max(off):.1f} % at most", flush=True)


if __name__ == "__main__":
    main()
