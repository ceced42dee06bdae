"""Which cause hides in a made poke experiment, and by what protocol it was measured."""

from __future__ import annotations

import numpy as np
from _blind_poke_case import LIBRARY, OUTSIDE, TABLED, Case, Hidden, Trial
from _blind_poke_curve import table
from _blind_poke_sigma import sigmas, sized
from _blind_record_case import SEVERAL, apart, in_turn

RIG = ("depth-offset", "force-gain", "force-offset", "force-drift", "friction")


def make_poke(seed: int, kind: str, name: str = "", *, target: float | None = None) -> Case:
    """kind: clean, one (of LIBRARY), two or three at once, trap (a gain of everything) or outside (one of
    OUTSIDE); name: of the cause, drawn where empty. target: its size in sigmas, drawn from 4 to 40 where
    None."""
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
        hidden = tuple(_hidden(rng, n, trials, wanted) for n in names)
        if all(h.sigma > (4.0 if h.table else 0.8 * wanted) for h in hidden) and apart(
            sigmas, trials, hidden
        ):
            return Case(seed=seed, kind=kind, trials=trials, hidden=hidden, moduli=moduli)
    raise RuntimeError(f"seed {seed}: no protocol shows {kind} {name} at {target} sigmas")


def draw_cases(count: int, seed: int) -> list[Case]:
    """A quarter clean, a tenth each of traps, outside the library and two at once, the rest one each in
    turn."""
    return in_turn(count, seed, make_poke, library=LIBRARY, outside=OUTSIDE, trap=True)


def _trials(rng: np.random.Generator, names: list[str]) -> tuple[Trial, ...]:
    """Pokes that a lab would make; where a cause needs a protocol, it has it."""
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


def _hidden(rng: np.random.Generator, name: str, trials: tuple[Trial, ...], target: float) -> Hidden:
    where = "all"
    ending = ""
    if name in TABLED:
        ending = str(rng.choice(TABLED[name]))
        holders = [t for t in trials if f"{t.base}{ending}" in table()]
        if len(holders) < len(trials):
            # several trials of this geometry, in each material: said to be one block
            where = holders[0].base
    elif name == "inclusion-debonded":
        where = "core"
    elif name == "force-gain" or (name in RIG and rng.random() < 0.4):
        where = str(rng.choice([t.id for t in trials]))
    shape = {"mullins": rng.uniform(0.8, 1.5), "relaxation": float(rng.choice([0.0, rng.uniform(2.0, 15.0)]))}
    sign = float(rng.choice([-1.0, 1.0])) if name in RIG else 1.0
    hidden = Hidden(name=name, amplitude=sign, where=where, shape=float(shape.get(name, 0.0)), table=ending)
    return sized(trials, hidden, target)
