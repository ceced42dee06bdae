"""Cases of synthetic homogeneous material tests: hidden causes, their sizes, test protocols and files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.coupons.model import (
    CHAINS,
    LARGEST,
    LIBRARY,
    OUTSIDE,
    Case,
    Hidden,
    Protocol,
    Solid,
    curve,
    errors,
    first_invariant,
)
from benchmarks.blind.records import SEVERAL, apart, in_turn, reaching, write_yaml

Array = NDArray[np.float64]


def sigmas(case_protocols: tuple[Protocol, ...], hidden: Hidden, others: tuple[Hidden, ...] = ()) -> float:
    """Size of a cause in standard deviations, with one modulus per specimen projected out."""
    changed: list[Array] = []
    free: dict[str, Array] = {}
    first = 0
    sizes = [len(p.path()[0]) for p in case_protocols]
    for p, size in zip(case_protocols, sizes, strict=True):
        sd = errors(p)
        base = curve(p, others)
        changed.append((curve(p, (*others, hidden)) - base) / sd)
        column = free.setdefault(p.specimen or p.material, np.zeros(sum(sizes)))
        column[first : first + size] = base / sd
        first += size
    q, _ = np.linalg.qr(np.column_stack(list(free.values())))
    z = np.concatenate(changed)
    return float(np.linalg.norm(z - q @ (q.T @ z)))


def sized(protocols: tuple[Protocol, ...], hidden: Hidden, target: float) -> Hidden:
    """Cause with an amplitude of `target` sigmas, or the largest amplitude in a lab if that is smaller."""
    high = LARGEST[hidden.name] / hidden.amplitude
    if hidden.name == "limited-extensibility":
        furthest = max(first_invariant(p) for p in protocols if hidden.hits(p))
        high = min(high, CHAINS * 3.0 / furthest / hidden.amplitude)
    if hidden.name == "machine-compliance":
        # the rig's deflection is at most a fifth of the travel
        travel = [
            abs(p.top - 1.0) / float(np.abs(Solid(G=p.G).stress(p.mode, np.array([p.top])))[0])
            for p in protocols
            if hidden.hits(p)
        ]
        high = min(high, 0.2 * min(travel) / hidden.amplitude)

    def scaled(factor: float) -> Hidden:
        return replace(hidden, amplitude=factor * hidden.amplitude)

    factor = reaching(lambda f: sigmas(protocols, scaled(f)), target, largest=high, steps=40)
    found = scaled(factor)
    return replace(found, sigma=sigmas(protocols, found))


NEEDS_TWO_MODES = ("anisotropy", "second-invariant")


def make_coupon(seed: int, kind: str, name: str = "", *, target: float | None = None) -> Case:
    """Draw a case.

    Parameters
    ----------
    seed : int
    kind : str
        "clean", "one" (of LIBRARY), "two", "three" (that many at once) or "outside" (one of OUTSIDE).
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
    for _ in range(200):
        if kind == "clean":
            names: list[str] = []
        elif kind in SEVERAL:
            names = [str(n) for n in rng.choice(LIBRARY, SEVERAL[kind], replace=False)]
        else:
            names = [name or str(rng.choice(LIBRARY if kind == "one" else OUTSIDE))]
        protocols = _protocols(rng, names)
        wanted = target or float(np.exp(rng.uniform(np.log(4.0), np.log(40.0))))
        if kind in SEVERAL:
            wanted = max(wanted, 8.0)
        hidden = tuple(hide(rng, n, protocols, wanted) for n in names)
        if all(h.sigma > 0.8 * wanted for h in hidden) and apart(sigmas, protocols, hidden):
            moduli: dict[str, list[float]] = {}
            for p in {q.specimen or q.material: q for q in protocols}.values():
                moduli.setdefault(p.material, []).append(p.G)
            mean = {m: float(np.exp(np.mean(np.log(g)))) for m, g in moduli.items()}
            return Case(seed=seed, kind=kind, protocols=protocols, hidden=hidden, moduli=mean)
    raise RuntimeError(f"seed {seed}: no protocol shows {kind} {name} at {target} sigmas")


def draw_cases(count: int, seed: int) -> list[Case]:
    """Draw a quarter clean cases, a tenth outside the library, a tenth of two effects, the rest of one.

    The effects take turns.
    """
    return in_turn(count, seed, make_coupon, library=LIBRARY, outside=OUTSIDE, trap=False)


def _protocols(rng: np.random.Generator, names: list[str]) -> tuple[Protocol, ...]:
    """Plausible trials of one or two materials, with the protocols that the causes require."""
    modes = ["tension", "equibiaxial", "planar", "simple-shear", "compression"]
    number = int(rng.integers(2 if any(n in NEEDS_TWO_MODES for n in names) else 1, 4))
    chosen = [str(m) for m in rng.choice(modes, number, replace=False)]
    if "platen-friction" in names and "compression" not in chosen:
        chosen[0] = "compression"
    pressed = chosen.index("compression") if "platen-friction" in names else None
    if "limited-extensibility" in names and not {"tension", "planar", "equibiaxial"} & set(chosen):
        if pressed == 0:
            chosen, pressed = ["", *chosen], 1
        chosen[0] = "tension"
    if "anisotropy" in names and set(chosen) <= {"tension", "compression"}:
        chosen[0 if pressed == len(chosen) - 1 else -1] = "equibiaxial"
    if "tension-compression-asymmetry" in names:
        chosen = ["tension", "compression", "simple-shear"]
    if "gauge-length" in names:
        chosen = ["tension", "planar", "simple-shear"]
    turns = int(rng.choice([0, 1, 3], p=[0.6, 0.25, 0.15]))
    if "permanent-set" in names:
        turns = max(turns, 1)
    if "hysteresis" in names:
        turns = max(turns, 1)
    if "mullins" in names:
        turns = 3
    rates = [float(10.0 ** rng.uniform(-3, -1))]
    if "rate-dependence" in names or rng.random() < 0.2:
        rates += [rates[0] * 10.0, *([rates[0] * 100.0] if rng.random() < 0.5 else [])]
    if "slip" in names or "wrong-area" in names:
        number = 2
    own = rng.random() < 0.5 and "wrong-area" not in names
    found = []
    for m in range(int(rng.integers(1, 3))):
        G = float(np.exp(rng.uniform(np.log(1e4), np.log(4e5))))
        scatter = rng.uniform(0.10, 0.20)
        reach = rng.uniform(0.35, 1.0)
        for mode in chosen:
            drawn = G * float(np.exp(scatter * rng.standard_normal())) if own else G
            top = _top(mode, reach, "limited-extensibility" in names)
            for k, rate in enumerate(rates):
                found.append(
                    Protocol(
                        id=f"M{m}-{mode}" + (f"-rate{k}" if len(rates) > 1 else ""),
                        material=f"M{m}",
                        specimen=f"M{m}-{mode}-piece" if own else None,
                        mode="uniaxial" if mode in ("tension", "compression") else mode,
                        top=top,
                        turns=turns,
                        rate=rate,
                        points=int(rng.integers(30, 70)),
                        G=drawn,
                        before=top if own and k > 0 else 1.0,
                    )
                )
    if "wrong-area" in names and len(found) < 3:
        return _protocols(rng, names)
    noise, jitter = float(rng.uniform(0.004, 0.015)), float(rng.choice([0.0, 0.0005, 0.002]))
    return tuple(
        replace(
            p,
            stress_sd=noise * float(np.abs(Solid(G=p.G).stress(p.mode, np.array([p.top])))[0]),
            stretch_sd=jitter,
        )
        for p in found
    )


def _top(mode: str, reach: float, far: bool) -> float:
    if mode == "compression":
        return 1.0 - 0.45 * reach
    return 1.0 + {"tension": 1.5, "planar": 1.2, "equibiaxial": 0.9, "simple-shear": 0.8}[mode] * reach * (
        1.6 if far else 1.0
    )


def hide(rng: np.random.Generator, name: str, protocols: tuple[Protocol, ...], target: float) -> Hidden:
    where = "all"
    materials = sorted({p.material for p in protocols})
    if name in ("strain-offset", "machine-compliance", "platen-friction"):
        ids = [p.id for p in protocols if name != "platen-friction" or p.top < 1.0]
        if rng.random() < 0.4:
            where = str(rng.choice(ids))
    elif name in ("slip", "wrong-area", "cell-saturates"):
        where = str(rng.choice([p.id for p in protocols]))
    elif len(materials) > 1 and rng.random() < 0.4 and name in LIBRARY:
        where = str(rng.choice(materials))
    shape = {
        "hysteresis": rng.uniform(0.8, 1.3),
        "mullins": rng.uniform(0.8, 1.5),
        "slip": rng.uniform(0.3, 0.8),
        "wavy-gauge": rng.uniform(1.5, 3.0),
    }.get(name, 1.0)
    unit = {"machine-compliance": 1e-8}.get(name, 1e-3)
    return sized(protocols, Hidden(name=name, amplitude=unit, where=where, shape=float(shape)), target)


def write(case: Case, folder: Path, *, noise: float = 1.0) -> None:
    """Write experiment.yaml and its CSV files, without the truth; `noise` multiplies the stated noise."""
    rng = np.random.default_rng([case.seed, 1])
    (folder / "coupons").mkdir(parents=True)
    trials: list[dict[str, Any]] = []
    for p in case.protocols:
        recorded, time, _ = p.path()
        # the lab measures the stretch with an error; the stress is that of the true stretch
        stress = curve(p, case.hidden) + noise * p.stress_sd * rng.standard_normal(len(recorded))
        shown = recorded + noise * p.stretch_sd * rng.standard_normal(len(recorded))
        rows = ["stretch,nominal_stress_kPa,time_s"]
        rows += [f"{s:.7g},{1e-3 * q:.7g},{t:.7g}" for s, q, t in zip(shown, stress, time, strict=True)]
        (folder / "coupons" / f"{p.id}.csv").write_text("\n".join(rows) + "\n")
        trial: dict[str, Any] = {
            "id": p.id,
            "kind": "coupon",
            "material": p.material,
            "mode": p.mode,
            "record": f"coupons/{p.id}.csv",
            "stretch_sd": p.stretch_sd,
            "stress_sd_kPa": round(1e-3 * p.stress_sd, 9),
        }
        if p.specimen:
            trial["specimen"] = p.specimen
        trials.append(trial)
    write_yaml(folder, f"coupons {case.seed}", [p.material for p in case.protocols], trials)
