"""Common parts of homogeneous tests and indentations: mixture of cases, sizes, truth, experiment.yaml."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

import yaml

SEVERAL = {"two": 2, "three": 3}  # number of causes in kinds of cases with several

T = TypeVar("T")
H = TypeVar("H")


class Put(Protocol):
    """A hidden cause: amplitude in SI; `where`: the trials that have it; sigma: its size."""

    @property
    def name(self) -> str: ...

    @property
    def amplitude(self) -> float: ...

    @property
    def where(self) -> str: ...

    @property
    def sigma(self) -> float: ...


def truth_of(seed: int, kind: str, hidden: Sequence[Put], moduli: Mapping[str, float]) -> dict[str, Any]:
    """Truth of a case in the form that the scores use."""
    return {
        "seed": seed,
        "kind": kind,
        "shear_modulus_Pa": moduli,
        "effects": [
            {"effect": h.name, "amplitude": h.amplitude, "scope": h.where, "sigma": h.sigma} for h in hidden
        ],
    }


def in_turn(
    count: int,
    seed: int,
    make: Callable[[int, str, str], T],
    *,
    library: Sequence[str],
    outside: Sequence[str],
    trap: bool,
) -> list[T]:
    """Make `count` cases of all kinds.

    A quarter are clean, a tenth each traps (if `trap`), outside the library and with two causes, the rest
    have one cause each, in turn. `make` makes a case from its seed, kind, and cause ("": drawn).
    """
    kinds = ["clean"] * round(0.25 * count)
    for kind in (*(["trap"] if trap else []), "outside", "two"):
        kinds += [kind] * round(0.1 * count)
    kinds += ["one"] * (count - len(kinds))
    found = []
    for n, kind in enumerate(kinds):
        name = ""
        if kind == "one":
            name = library[n % len(library)]
        elif kind == "outside":
            name = outside[(n + seed) % len(outside)]
        found.append(make(1000 * seed + n, kind, name))
    return found


def draw_several(count: int, seed: int, make: Callable[[int, str], T], kind: str) -> list[T]:
    """Cases that all have several causes; kind: a key of SEVERAL."""
    return [make(1000 * seed + n, kind) for n in range(count)]


def apart(size: Callable[[T, H, tuple[H, ...]], float], trials: T, hidden: tuple[H, ...]) -> bool:
    """True if each of several causes exceeds 3 sigmas beside the others; `size` gives this size."""
    return all(size(trials, h, tuple(o for o in hidden if o is not h)) > 3.0 for h in hidden)


def reaching(size: Callable[[float], float], target: float, *, largest: float, steps: int) -> float:
    """Amplitude of size `target` [sigma] by bisection in `steps` steps, at most `largest`."""
    low, high = 0.0, largest
    if size(high) > target:
        for _ in range(steps):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if size(middle) < target else (low, middle)
    return high


def write_yaml(folder: Path, name: str, materials: Sequence[str], trials: list[dict[str, Any]]) -> None:
    """Write experiment.yaml."""
    known: dict[str, Any] = {m: {} for m in materials}
    content = {"format": 1, "name": name, "materials": known, "trials": trials}
    (folder / "experiment.yaml").write_text(yaml.safe_dump(content, sort_keys=False))
