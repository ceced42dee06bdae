"""Simulated pokes of the test part, quantised, which the page shows beside the surrogate's predictions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learn.data import Store

STEPS = 32767  # in the largest component of a frame: the rounding error is half a step at most


def choose(store: Store, tested: NDArray[np.int64], shapes: list[str], most: int) -> list[int]:
    """At most `most` pokes of the test part over these shapes, evenly spread over their order."""
    shown = np.array([p for p in tested if store.shapes[store.shape[p]] in shapes], dtype=np.int64)
    picked = np.linspace(0, len(shown) - 1, min(most, len(shown))).round().astype(int)
    return shown[picked].tolist() if len(shown) else []


def shortage(store: Store, tested: NDArray[np.int64], shapes: list[str], most: int) -> str | None:
    """Why there are fewer pokes than the `most` that were asked for, as one sentence; None if there are not.

    The other parameters are those of `choose`.
    """
    found = len(choose(store, tested, shapes, most))
    if found >= most:
        return None
    number = f"{found or 'no'} simulated poke{'' if found == 1 else 's'} to compare with, of {most} asked for"
    if not len(tested):
        return f"{number}: the run has no test part"
    if found:
        return f"{number}: the test part has no more over the page's inclusions"
    others = dict.fromkeys(store.shapes[k] for k in store.shape[tested])
    return f"{number}: none of the page's inclusions is in the test part, which has {', '.join(others)}"


def quantised(moved: NDArray[np.float32]) -> tuple[NDArray[np.int16], list[float]]:
    """Displacements (f, n, 3) as 16-bit numbers of steps, and the step of each frame [m]."""
    largest = np.abs(moved).max(axis=(1, 2)).astype(np.float64)
    step = np.where(largest > 0, largest, 1.0) / STEPS
    return np.rint(moved / step[:, None, None]).astype(np.int16), step.tolist()


def described(store: Store, poke: int, interior: int) -> tuple[dict[str, Any], NDArray[np.int16]]:
    """Description of a poke in the controls' units (mm, degrees, kPa), and its quantised displacements.

    The description also holds depths [mm], forces [N] and steps [m] of the frames.
    """
    rows = slice(int(store.frame_start[poke]), int(store.frame_start[poke] + store.frame_count[poke]))
    keep = store.presses[rows]
    moved, steps = quantised(store.displacement(rows)[keep])
    push = store.direction[poke]
    angle = math.degrees(math.acos(min(1.0, -float(push[2]))))
    x, y = (store.setup_of(poke).contact_site(store.path_start[poke], push) * 1e3).tolist()
    shape, level = store.shapes[store.shape[poke]], store.softness_names[store.softness[poke]]
    about = {
        "label": f"{shape}, {level}, {angle:.0f}\N{DEGREE SIGN} (poke {poke})",
        "poke": {
            "interior": interior,
            "x": x,
            "y": y,
            "angle": angle,
            "heading": math.degrees(math.atan2(push[1], push[0])),
            "modulus": float(store.modulus[poke]) * 1e-3,
        },
        "depths": (store.depth[rows][keep] * 1e3).tolist(),
        "forces": np.linalg.norm(store.rod_force[rows][keep], axis=1).tolist(),
        "steps": steps,
    }
    return about, moved
