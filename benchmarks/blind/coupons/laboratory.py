"""Homogeneous material tests for the controls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.coupons.cases import hide, make_coupon, write
from benchmarks.blind.coupons.model import LIBRARY, OUTSIDE, Case, Hidden, curve, errors
from benchmarks.blind.laboratory import Laboratory, smooth_error_of_records
from benchmarks.blind.under_test import diagnose_coupons

Array = NDArray[np.float64]

NEAR = (0.8, 1.25)  # size of a cause relative to the requested one


def half(seed: int, size: float) -> Case | None:
    """Case with one cause of the library and one outside it; None if protocols cannot show both so large."""
    rng = np.random.default_rng([seed, 8])
    case = make_coupon(seed, "one", str(rng.choice(LIBRARY)), target=size)
    for name in rng.permutation(OUTSIDE):
        other = hide(rng, str(name), case.protocols, size)
        if NEAR[0] * size < other.sigma < NEAR[1] * size:
            return replace(case, hidden=(*case.hidden, other))
    return None


def whitened(case: Case, hidden: Sequence[Hidden]) -> Array:
    return np.concatenate([curve(p, tuple(hidden)) / errors(p) for p in case.protocols])


def free(case: Case) -> Array:
    """Columns of one modulus per specimen, or per material if specimens have no names; whitened."""
    owners = [p.specimen or p.material for p in case.protocols]
    base = [curve(p, ()) / errors(p) for p in case.protocols]
    return np.column_stack(
        [
            np.concatenate([b * (o == owner) for b, o in zip(base, owners, strict=True)])
            for owner in dict.fromkeys(owners)
        ]
    )


LABORATORY = Laboratory(
    clean=lambda seed: make_coupon(seed, "clean"),
    one=lambda seed, size: make_coupon(seed, "one", target=size),
    half=half,
    two=lambda seed, size: make_coupon(seed, "two", target=size),
    write=write,
    hidden=lambda case: case.hidden,
    whitened=whitened,
    free=free,
    diagnose=diagnose_coupons,
    smooth_error=smooth_error_of_records(measured=1, stated="stress_sd_kPa"),
    same={
        "law-form": frozenset({"strain-stiffening", "second-invariant", "limited-extensibility"}),
        "relaxation": frozenset({"rate-dependence"}),
    },
)
