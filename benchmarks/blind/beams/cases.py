"""A case of the blind beams, drawn from one seed: nominal values, true values and hidden effects."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.effects import (
    EFFECTS,
    IMAGE,
    OUTSIDE,
    PARAMETER,
    SIZE,
    Effect,
    at_work,
    photographed,
)
from benchmarks.blind.beams.ideal_beams import LENGTHS, POINTS, RADIUS, Table, interpolate, true_edges
from benchmarks.blind.beams.model import Beam, Resolution

Array = NDArray[np.float64]
TIMES = (10.0, 100.0, 1000.0)  # of the photographs [s]
MODULI = {"S0": (25e3, 40e3), "S0.5": (12e3, 22e3), "S1": (9.0e3, 12.5e3)}  # [Pa]
SOFTEST = 9.0e3  # below, the lower edge creases at the clamp [Pa]
RADIUS_SD, LENGTH_SD, DENSITY_SD = 0.05e-3, 0.2e-3, 0.005
NAMES = ("cantilever-050", "cantilever-100", "bridge-150")


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One true beam without the hidden effect, in SI units; kind: index of `ideal_beams.LENGTHS`."""

    id: str
    kind: int
    material: str
    specimen: str
    length: float
    radius: float
    mu: float
    density: float

    def beam(self) -> Beam:
        return Beam(
            length=self.length,
            bridge=LENGTHS[self.kind][1],
            mu=self.mu,
            density=self.density,
            radius=self.radius,
        )


@dataclass(frozen=True, kw_only=True)
class Hidden:
    """A hidden effect.

    Attributes
    ----------
    effect : its name.
    amplitude : in SI units.
    scope : "all", "bridges", a material or a trial.
    trials : indices of the trials that it acts on.
    place : position of a void, as a fraction of the free length.
    target : size aimed at, in sigmas.
    """

    effect: str
    amplitude: float
    scope: str
    trials: tuple[int, ...]
    place: float
    target: float

    def parameters(self) -> dict[str, float]:
        """Amplitude by the name and in the unit of a diagnosis; outside the library: {"amplitude": in SI}."""
        if self.effect not in PARAMETER:
            return {"amplitude": self.amplitude}
        name, unit = PARAMETER[self.effect]
        return {name: self.amplitude * SIZE.get(self.effect, 1.0) / unit}


@dataclass(frozen=True, kw_only=True)
class Case:
    """A case, identified by index and seed.

    Attributes
    ----------
    category : "clean", "density", "single", "two" or "outside".
    per_beam : True if each beam is a specimen, False if each material is.
    stated : density that the lab assumes for each material [kg/m3].
    dice : standard normal numbers, shape (trials, photographs).
    """

    index: int
    seed: int
    category: str
    per_beam: bool
    trials: tuple[Trial, ...]
    stated: dict[str, float]
    hidden: tuple[Hidden, ...]
    dice: Array


def trial_names(*, per_beam: bool) -> list[dict[str, Any]]:
    """Id, kind, material and specimen of each trial."""
    return [
        {
            "id": f"{material}-{name}",
            "kind": kind,
            "material": material,
            "specimen": f"{material}-{'abc'[kind]}" if per_beam else material,
        }
        for material in MODULI
        for kind, name in enumerate(NAMES)
    ]


def draw(index: int, seed: int, category: str, effects: tuple[str, ...], sizes: tuple[float, float]) -> Case:
    """Draw a case from its seed.

    Targets are log-uniform between the two `sizes` [sigma]. An amplitude is the effect's threshold (5 sigma)
    scaled to the target, and 1.7 times that if it acts on one material only.
    """
    rng = np.random.default_rng([seed, index, 1])
    per_beam = bool(rng.random() < 0.5)
    scatter = rng.uniform(0.10, 0.20)
    trials: list[Trial] = []
    names = trial_names(per_beam=per_beam)
    stated = {}
    wrong = [m for m in MODULI if rng.random() < 0.6] or ["S0.5"]
    for material, (low, high) in MODULI.items():
        mu, density = rng.uniform(low, high), rng.uniform(975.0, 1035.0)
        stated[material] = density * (1 + DENSITY_SD * rng.standard_normal())
        if category == "density" and material in wrong:
            stated[material] *= 1 + rng.choice([-1, 1]) * rng.uniform(0.04, 0.06)
        radius = RADIUS + RADIUS_SD * rng.standard_normal()
        for length, _ in LENGTHS:
            factor = np.exp(scatter * np.clip(rng.standard_normal(), -2, 2)) if per_beam else 1.0
            if per_beam:
                radius = RADIUS + RADIUS_SD * rng.standard_normal()
            trials.append(
                Trial(
                    **names[len(trials)],
                    length=length + LENGTH_SD * float(np.clip(rng.standard_normal(), -2.5, 2.5)),
                    radius=radius,
                    mu=float(max(mu * factor, SOFTEST)),
                    density=density,
                )
            )
    catalogue = EFFECTS | OUTSIDE
    hidden = tuple(_hide(name, catalogue[name], tuple(trials), sizes, rng) for name in effects)
    dice = rng.standard_normal((len(trials), len(TIMES)))
    return Case(
        index=index,
        seed=seed,
        category=category,
        per_beam=per_beam,
        trials=tuple(trials),
        stated=stated,
        hidden=hidden,
        dice=dice,
    )


def _hide(
    name: str, effect: Effect, trials: tuple[Trial, ...], sizes: tuple[float, float], rng: np.random.Generator
) -> Hidden:
    scopes = effect.scopes
    kind = scopes[0] if len(scopes) == 1 or rng.random() < 0.5 else scopes[1]
    target = float(np.exp(rng.uniform(*np.log(sizes))))
    sign = float(rng.choice([-1, 1])) if effect.signed else 1.0
    material = str(rng.choice(list(MODULI)))
    one = int(rng.integers(len(trials)))
    if name in ("added-mass", "string") and kind == "beam":
        one = 3 * int(rng.integers(3)) + int(rng.integers(2))  # hung on a cantilever
    if name == "string":
        one = 3 * int(rng.integers(3)) + int(rng.integers(1, 3))
    chosen = {
        "all": range(len(trials)),
        "material": [k for k, t in enumerate(trials) if t.material == material],
        "beam": [one],
        "bridges": [k for k, t in enumerate(trials) if t.kind == 2],
    }[kind]
    scope = {"all": "all", "material": material, "beam": trials[one].id, "bridges": "bridges"}[kind]
    if name == "swapped-photograph":
        chosen = [one, (one + 3) % len(trials)]
    if name == "far-end-pinned":
        chosen = [k for k in chosen if trials[k].kind == 2]
    place = rng.uniform(0.12, 0.45) if trials[one].kind < 2 else rng.choice([0.15, 0.5, 0.85])
    amplitude = min(effect.threshold * target / 5, effect.largest)
    if kind == "material" and effect.largest != effect.threshold:
        amplitude = min(1.7 * amplitude, effect.largest)
    return Hidden(
        effect=name,
        amplitude=float(sign * amplitude),
        scope=scope,
        trials=tuple(chosen),
        place=float(place),
        target=target,
    )


def resized(case: Case, amplitudes: tuple[float, ...]) -> Case:
    """Case with other amplitudes [SI], limited to the largest that each effect allows."""
    catalogue = EFFECTS | OUTSIDE
    hidden = []
    for old, wanted in zip(case.hidden, amplitudes, strict=True):
        size = min(abs(wanted), catalogue[old.effect].largest)
        hidden.append(replace(old, amplitude=float(np.copysign(size, old.amplitude))))
    return replace(case, hidden=tuple(hidden))


def true_beam(case: Case, trial: int, photograph: int) -> Beam:
    """Beam of a trial at the time of a photograph, with all hidden effects."""
    return beam_at(case, trial, time=TIMES[photograph], dice=float(case.dice[trial, photograph]))


def beam_at(case: Case, trial: int, *, time: float, dice: float) -> Beam:
    """Beam of a trial `time` [s] after its release; dice: a standard normal number of the photograph."""
    own = case.trials[trial]
    beam = own.beam()
    for hidden in case.hidden:
        if trial in hidden.trials:
            beam = at_work(
                beam,
                hidden.effect,
                hidden.amplitude,
                place=hidden.place * own.length,
                time=time,
                dice=dice,
            )
    return beam


def stiff_enough(case: Case) -> Case:
    """Case with moduli raised for specimens that would be softer than SOFTEST at some time."""
    trials = list(case.trials)
    lowest: dict[str, float] = {}
    for k, trial in enumerate(trials):
        least = min(true_beam(case, k, photograph).mu for photograph in range(len(TIMES)))
        lowest[trial.specimen] = min(lowest.get(trial.specimen, np.inf), least)
    for k, trial in enumerate(trials):
        factor = max(1.0, SOFTEST / lowest[trial.specimen])
        trials[k] = replace(trial, mu=trial.mu * factor)
    return replace(case, trials=tuple(trials))


def solve_case(case: Case, kept: Table, resolution: Resolution) -> Array:
    """True silhouettes (trials, photographs, 2, POINTS, 2) [m], without camera faults."""
    edges = np.empty((len(case.trials), len(TIMES), 2, POINTS, 2))
    for k, trial in enumerate(case.trials):
        done: dict[Beam, Array] = {}
        for photograph in range(len(TIMES)):
            beam = true_beam(case, k, photograph)
            if beam not in done:
                done[beam] = true_edges(kept, beam, trial.kind, resolution)
            edges[k, photograph] = done[beam]
    return edges


def seen(case: Case, edges: Array, trial: int, photograph: int, s: Array) -> Array:
    """Edges (2, len(s), 2) [m] in a photograph, without noise and registration; s: length fractions."""
    source = trial
    for hidden in case.hidden:
        if hidden.effect == "swapped-photograph" and trial in hidden.trials and photograph == 1:
            source = hidden.trials[1 - hidden.trials.index(trial)]
    kind = case.trials[trial].kind
    points = interpolate(kind, edges[source, photograph], s)
    for hidden in case.hidden:
        if trial in hidden.trials and hidden.effect in (*IMAGE, "shadow"):
            points = photographed(points, LENGTHS[kind][0], hidden.effect, hidden.amplitude)
    return points
