"""Indentation for the controls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.blind.indentation.cases import free, hide, make_poke, whitened, write
from benchmarks.blind.indentation.model import LIBRARY, OUTSIDE, TABLED, Case
from benchmarks.blind.laboratory import Laboratory, smooth_error_of_records
from benchmarks.blind.under_test import diagnose_indentation

NEAR = (0.8, 1.25)  # size of a cause relative to the requested one
SIZED = tuple(n for n in LIBRARY if n not in TABLED)  # tabled causes have fixed, simulated sizes
ADDED = tuple(n for n in OUTSIDE if n not in TABLED)


def half(seed: int, size: float) -> Case | None:
    """Case with one cause of the library and one outside it; None if protocols cannot show both so large."""
    rng = np.random.default_rng([seed, 8])
    case = make_poke(seed, "one", str(rng.choice(SIZED)), target=size)
    for name in rng.permutation(ADDED):
        other = hide(rng, str(name), case.trials, size)
        if NEAR[0] * size < other.sigma < NEAR[1] * size:
            return replace(case, hidden=(*case.hidden, other))
    return None


LABORATORY = Laboratory(
    clean=lambda seed: make_poke(seed, "clean"),
    one=lambda seed, size: make_poke(
        seed, "one", str(np.random.default_rng([seed, 9]).choice(SIZED)), target=size
    ),
    half=half,
    two=lambda seed, size: make_poke(seed, "two", target=size),
    write=write,
    hidden=lambda case: case.hidden,
    whitened=lambda case, hidden: whitened(case.trials, hidden),
    free=lambda case: free(case.trials),
    diagnose=diagnose_indentation,
    smooth_error=smooth_error_of_records(measured=2, stated="force_sd_N"),
)
