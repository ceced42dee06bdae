"""Cases of synthetic indentations: hidden causes, their sizes, test protocols and files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from benchmarks.blind.indentation.model import (
    BASES,
    LARGEST,
    LIBRARY,
    OUTSIDE,
    TABLED,
    Case,
    Hidden,
    Trial,
    force,
    table,
)
from benchmarks.blind.records import SEVERAL, apart, in_turn, reaching, write_yaml

Array = NDArray[np.float64]
# relative error of the diagnosis' simulation: common part MESH, larger below SHALLOW radii, and varying
# parts (sd, correlation length of the contact's width)
REFINED = 1.5
MESH, SHALLOW = 0.025 / REFINED**2, 0.4
WANDER = ((0.008 / REFINED**2, 0.04 / REFINED), (0.006 / REFINED**2, 0.5 / REFINED))


@lru_cache(maxsize=4)
def _root(trials: tuple[Trial, ...]) -> Array:
    """Lower Cholesky factor of the covariance of all forces [N2]: noise, contact depth, simulation error."""
    base = [force(t, ()) for t in trials]
    parts, width, radii, relative = [], [], [], []
    for t, f in zip(trials, base, strict=True):
        _, depth, _ = t.path()
        radius = 1e-3 * table()[t.base]["setup"]["rod"]
        slope = np.abs(np.interp(depth, *_unique(depth, f)))
        white = t.force_sd**2 + (slope * t.depth_sd) ** 2
        parts.append((white, slope * t.depth_sd))
        shallow = np.sqrt(1 + (SHALLOW * radius / np.maximum(depth, 0.1 * SHALLOW * radius)) ** 2)
        width.append(np.sqrt(np.maximum(depth, 0.0) / radius))
        relative.append(shallow * f)
        radii.append(np.full(len(depth), BASES.index(t.base), dtype=float))
    w, g, r, f = (np.concatenate(x) for x in (width, radii, relative, base))
    same = g[:, None] == g[None, :]
    alike = sum(sd**2 * np.exp(-0.5 * ((w[:, None] - w) / over) ** 2) for sd, over in WANDER)
    total = same * np.outer(r, r) * alike + MESH**2 * np.outer(f, f)
    first = 0
    for white, touch in parts:
        mine = slice(first, first + len(white))
        total[mine, mine] += np.diag(white + 1e-14) + np.outer(touch, touch)
        first += len(white)
    return np.asarray(np.linalg.cholesky(total))


def whitened(trials: tuple[Trial, ...], hidden: Sequence[Hidden]) -> Array:
    """Forces without noise, whitened by their covariance."""
    found = np.concatenate([force(t, tuple(hidden)) for t in trials])
    return np.asarray(solve_triangular(_root(trials), found, lower=True))


def free(trials: tuple[Trial, ...], hidden: Sequence[Hidden] = ()) -> Array:
    """Whitened columns of one modulus per material, in the presence of these causes."""
    base = [force(t, tuple(hidden)) for t in trials]
    columns = [
        np.concatenate([b * (t.material == m) for t, b in zip(trials, base, strict=True)])
        for m in sorted({t.material for t in trials})
    ]
    return np.asarray(solve_triangular(_root(trials), np.column_stack(columns), lower=True))


def _unique(depth: Array, f: Array) -> tuple[Array, Array]:
    """Depths of the first stroke, and the derivative of its force."""
    last = int(np.argmax(depth)) + 1
    x, y = depth[:last], f[:last]
    return x, np.gradient(y, x)


def sigmas(trials: tuple[Trial, ...], hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, with one modulus per material projected out."""
    z = whitened(trials, (*others, hidden)) - whitened(trials, others)
    q, _ = np.linalg.qr(free(trials, others))
    return float(np.linalg.norm(z - q @ (q.T @ z)))


def sized(trials: tuple[Trial, ...], hidden: Hidden, target: float) -> Hidden:
    """Cause with an amplitude of `target` sigmas, or the largest amplitude in a lab if that is smaller.

    A tabled cause keeps its simulated size.
    """
    if hidden.table:
        return replace(hidden, sigma=sigmas(trials, hidden))
    sign = math.copysign(1.0, hidden.amplitude)

    def scaled(amplitude: float) -> Hidden:
        return replace(hidden, amplitude=sign * amplitude)

    found = scaled(
        reaching(lambda a: sigmas(trials, scaled(a)), target, largest=LARGEST[hidden.name], steps=12)
    )
    return replace(found, sigma=sigmas(trials, found))


RIG = ("depth-offset", "force-gain", "force-offset", "force-drift", "friction")


def make_poke(seed: int, kind: str, name: str = "", *, target: float | None = None) -> Case:
    """Draw a case.

    Parameters
    ----------
    seed : int
    kind : str
        "clean", "one" (of LIBRARY), "two", "three" (that many at once), "trap" (a common factor of
        all forces, which cannot be identified) or "outside" (one of OUTSIDE).
    name : str
        Name of the cause; drawn if empty.
    target : float, optional
        Size of each cause [sigma]; log-uniform from 4 to 40 if None. At least 8 for several causes.

    Raises
    ------
    RuntimeError
        If no protocol shows the causes.
    """
    rng = np.random.default_rng([seed, 0])
    for _ in range(60):
        if kind == "clean":
            names: list[str] = []
        elif kind == "trap":
            names = ["force-gain"]
        elif kind in SEVERAL:
            free = [n for n in LIBRARY if n not in TABLED]
            names = [str(n) for n in rng.choice(free, SEVERAL[kind], replace=False)]
        else:
            names = [name or str(rng.choice(LIBRARY if kind == "one" else OUTSIDE))]
        trials = _trials(rng, names)
        wanted = target or float(np.exp(rng.uniform(np.log(4.0), np.log(40.0))))
        if kind in SEVERAL:
            wanted = max(wanted, 8.0)
        moduli = {t.material: t.G for t in trials}
        if kind == "trap":
            trap = Hidden(name="force-gain", amplitude=float(rng.uniform(-0.3, 0.3)))
            return Case(seed=seed, kind=kind, trials=trials, hidden=(trap,), moduli=moduli)
        hidden = tuple(hide(rng, n, trials, wanted) for n in names)
        if all(h.sigma > (4.0 if h.table else 0.8 * wanted) for h in hidden) and apart(
            sigmas, trials, hidden
        ):
            return Case(seed=seed, kind=kind, trials=trials, hidden=hidden, moduli=moduli)
    raise RuntimeError(f"seed {seed}: no protocol shows {kind} {name} at {target} sigmas")


def draw_cases(count: int, seed: int) -> list[Case]:
    """Draw a quarter clean cases, a tenth each of traps, outside the library and of two, the rest of one.

    The effects take turns.
    """
    return in_turn(count, seed, make_poke, library=LIBRARY, outside=OUTSIDE, trap=True)


def _trials(rng: np.random.Generator, names: list[str]) -> tuple[Trial, ...]:
    """Plausible indentations of one or two materials, with the protocols that the causes require."""
    some = ["thick", "thin", "ball"]
    if any(n.startswith("inclusion") for n in names) or rng.random() < 0.2:
        some = ["core", *([str(rng.choice(some))] if rng.random() < 0.5 else [])]
    else:
        rng.shuffle(some)
        some = some[: int(rng.integers(1, 4))]
    if "thickness" in names and "thin" not in some:
        some[0] = "thin"
    if {"thickness", "force-gain"} & set(names) and len(some) == 1:
        some.append("thick" if some == ["ball"] else "ball")
    if "inclusion-misplaced" in names and len(some) == 1:
        some.append("thick")
    back = rng.random() < 0.6 or bool({"adhesion", "mullins", "backlash", "force-drift"} & set(names))
    twice = rng.random() < 0.25 or "mullins" in names
    hold = float(rng.uniform(10.0, 40.0)) if rng.random() < 0.4 or "relaxation" in names else 0.0
    speed = float(10.0 ** rng.uniform(-3.7, -2.7))
    found = []
    for m in range(int(rng.integers(1, 3))):
        shear = float(np.exp(rng.uniform(np.log(5e3), np.log(1e5))))
        for base in some:
            deepest = 1e-3 * min(table()[k]["depth"][-1] for k in table() if k.startswith(base))
            to = float(rng.uniform(0.8, 0.98)) * deepest
            strokes = [(to, speed, hold)]
            if back or twice:
                strokes.append((-0.3e-3 if "adhesion" in names else 0.0, speed, 0.0))
            if twice:
                strokes += [(to, speed, 0.0), (0.0, speed, 0.0)]
            whole = shear * 1e-6 * table()[base]["in"][-1]
            found.append(
                Trial(
                    id=f"M{m}-{base}",
                    material=f"M{m}",
                    base=base,
                    G=shear,
                    strokes=tuple(strokes),
                    samples=int(rng.integers(30, 60)),
                    force_sd=float(rng.uniform(0.001, 0.006)) * whole,
                    depth_sd=float(rng.choice([0.0, 0.005e-3, 0.02e-3])),
                )
            )
    return tuple(found)


def hide(rng: np.random.Generator, name: str, trials: tuple[Trial, ...], target: float) -> Hidden:
    where = "all"
    ending = ""
    if name in TABLED:
        ending = str(rng.choice(TABLED[name]))
        holders = [t for t in trials if f"{t.base}{ending}" in table()]
        if len(holders) < len(trials):
            # one trial of this geometry for each material, on the same block
            where = holders[0].base
    elif name == "inclusion-debonded":
        where = "core"
    elif name == "force-gain" or (name in RIG and rng.random() < 0.4):
        where = str(rng.choice([t.id for t in trials]))
    shape = {"mullins": rng.uniform(0.8, 1.5), "relaxation": float(rng.choice([0.0, rng.uniform(2.0, 15.0)]))}
    sign = float(rng.choice([-1.0, 1.0])) if name in RIG else 1.0
    hidden = Hidden(name=name, amplitude=sign, where=where, shape=float(shape.get(name, 0.0)), table=ending)
    return sized(trials, hidden, target)


def write(case: Case, folder: Path, *, noise: float = 1.0) -> None:
    """Write experiment.yaml and its records, without the truth; `noise` multiplies the stated noise."""
    rng = np.random.default_rng([case.seed, 1])
    (folder / "pokes").mkdir(parents=True)
    trials: list[dict[str, Any]] = []
    for t in case.trials:
        moved = replace(t, touch=noise * t.depth_sd * float(rng.standard_normal()))
        time, depth, _ = t.path()
        shown = depth + noise * t.depth_sd * rng.standard_normal(len(depth))
        f = force(moved, case.hidden) + noise * t.force_sd * rng.standard_normal(len(depth))
        rows = "\n".join(
            f"{a:.6g},{1e3 * b:.6g},{c:.6g}" for a, b, c in zip(time + 1.0, shown, f, strict=True)
        )
        name = f"pokes/{t.id}.csv"
        (folder / name).write_text(f"time_s,depth_mm,force_N\n{rows}\n")
        setup = table()[t.base]["setup"]
        entry: dict[str, Any] = {
            "id": t.id,
            "kind": "poke",
            "material": t.material,
            "block_mm": [100.0, 100.0, setup["height"]],
            "rod": {"radius_mm": setup["rod"], "tip": setup["tip"]},
            "start_mm": [0.0, 0.0, setup["height"]],
            "direction": [0.0, 0.0, -1.0],
            "record": name,
            "force_sd_N": t.force_sd,
            "depth_sd_mm": 1e3 * t.depth_sd,
        }
        if setup["cylinder"]:
            radius, below, above = setup["cylinder"]
            centre = [0.0, 0.0, 0.5 * (below + above)]
            shape = {"radius_mm": radius, "height_mm": above - below, "centre_mm": centre}
            entry["inclusion"] = {"cylinder": shape}
        trials.append(entry)
    write_yaml(folder, f"pokes {case.seed}", [t.material for t in case.trials], trials)
