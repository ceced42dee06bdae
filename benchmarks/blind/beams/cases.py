"""A case of the blind beams, drawn from one seed: nominal values, true values and hidden effects.

Amplitudes are in SI. `PARAMETER` holds, for each effect, the parameter that a diagnosis reports (the name
contains its unit) and the factor that converts it to SI. Signs are defined in `model.Beam` and below.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.ideal_beams import LENGTHS, POINTS, RADIUS, Table, interpolate, true_edges
from benchmarks.blind.beams.model import Beam, Resolution

Array = NDArray[np.float64]
Scope = Literal["all", "material", "beam", "bridges"]
DEGREE = np.pi / 180


@dataclass(frozen=True, kw_only=True)
class Effect:
    """Range of an effect's amplitude [SI].

    Attributes
    ----------
    threshold : amplitude of a size of about 5 sigma, which `draw` scales to the target size.
    largest : largest amplitude, limited by physics or by the solver.
    signed : True if both signs occur.
    scopes : which beams the effect may act on; one of them is drawn.
    """

    threshold: float
    largest: float
    signed: bool = True
    scopes: tuple[Scope, ...] = ("all", "material")


# thresholds: from the project's facts on diagnosis (nine beams, three photographs); SI
EFFECTS: dict[str, Effect] = {
    "grip-length": Effect(threshold=0.49e-3, largest=3e-3, signed=False),
    "clamp-compliance": Effect(threshold=1.4, largest=9.0, signed=False, scopes=("all",)),
    "clamp-tilt": Effect(threshold=0.50 * DEGREE, largest=4 * DEGREE, scopes=("all",)),
    "gravity-tilt": Effect(threshold=1.2 * DEGREE, largest=8 * DEGREE, scopes=("all",)),
    "camera-roll": Effect(threshold=0.33 * DEGREE, largest=3 * DEGREE, scopes=("all",)),
    "free-length": Effect(threshold=0.33e-3, largest=3e-3, signed=False),
    "grip-squeeze": Effect(threshold=0.017, largest=0.12, signed=False),
    "radius": Effect(threshold=0.0041, largest=0.03),
    "taper": Effect(threshold=0.08, largest=0.5),
    "stiffness-gradient-axial": Effect(threshold=0.7, largest=4.0),
    "stiffness-gradient-transverse": Effect(threshold=12.0, largest=50.0),
    "residual-curvature": Effect(threshold=0.21, largest=1.5),
    "void": Effect(threshold=0.11, largest=0.6, signed=False, scopes=("beam",)),
    "strain-stiffening": Effect(threshold=0.14, largest=1.2, signed=False),
    "compressibility": Effect(threshold=0.23, largest=0.40, signed=False),
    "creep": Effect(threshold=0.032, largest=0.13, signed=False),
    "clamp-gap": Effect(threshold=0.25e-3, largest=2e-3, scopes=("bridges",)),
    "image-scale": Effect(threshold=0.0055, largest=0.04, scopes=("all",)),
    "lens-distortion": Effect(threshold=2.0, largest=15.0, scopes=("all",)),
    "skin": Effect(threshold=0.07, largest=0.6, signed=False),
    "added-mass": Effect(threshold=0.2e-3, largest=3e-3, signed=False, scopes=("beam",)),
}
OUTSIDE: dict[str, Effect] = {
    "far-end-pinned": Effect(threshold=1.0, largest=1.0, signed=False, scopes=("bridges", "material")),
    "string": Effect(threshold=5e-3, largest=60e-3, signed=False, scopes=("material", "beam")),
    "swapped-photograph": Effect(threshold=1.0, largest=1.0, signed=False, scopes=("beam",)),
    "lamp": Effect(threshold=0.04, largest=0.25, signed=False, scopes=("all", "material")),
    "swinging": Effect(threshold=0.03, largest=0.20, signed=False, scopes=("all",)),
    "shadow": Effect(threshold=0.08e-3, largest=0.8e-3, scopes=("all", "material")),
}
PARAMETER: dict[str, tuple[str, float]] = {
    "grip-length": ("depth_mm", 1e-3),
    "clamp-compliance": ("rad_per_Nm", 1.0),
    "clamp-tilt": ("angle_deg", DEGREE),
    "gravity-tilt": ("angle_deg", DEGREE),
    "camera-roll": ("angle_deg", DEGREE),
    "free-length": ("slip_mm", 1e-3),
    "grip-squeeze": ("squeeze", 1.0),
    "radius": ("excess_mm", 1e-3),
    "taper": ("per_100mm", 10.0),
    "stiffness-gradient-axial": ("per_100mm", 10.0),
    "stiffness-gradient-transverse": ("per_radius", 100.0),
    "residual-curvature": ("curvature_per_m", 1.0),
    "void": ("lost_EI", 1.0),
    "strain-stiffening": ("c2_over_c1", 1.0),
    "compressibility": ("poisson_drop", 1.0),
    "creep": ("per_decade", 1.0),
    "clamp-gap": ("gap_mm", 1e-3),
    "image-scale": ("excess", 1.0),
    "lens-distortion": ("per_m2", 1.0),
    "skin": ("excess", 1.0),
    "added-mass": ("mass_g", 1e-3),
}
# a relative radius is drawn; the reported amplitude is a length
SIZE = {"radius": 0.010}
IMAGE = ("camera-roll", "image-scale", "lens-distortion")


def at_work(beam: Beam, effect: str, amplitude: float, *, place: float, time: float, dice: float) -> Beam:
    """True beam with an effect at `time` [s].

    `place` is the x coordinate of a void [m], `dice` a standard normal number of this photograph.
    """
    a = amplitude
    changes: dict[str, dict[str, float | bool]] = {
        "grip-length": {"grip_depth": a},
        "clamp-compliance": {"compliance": a},
        "clamp-tilt": {"near_tilt": a},
        "gravity-tilt": {"gravity_angle": a},
        "grip-squeeze": {"squeeze": a},
        "radius": {"radius": beam.radius * (1 + a)},
        "taper": {"taper": a},
        "stiffness-gradient-axial": {"axial_gradient": a},
        "stiffness-gradient-transverse": {"transverse_gradient": a},
        "residual-curvature": {"curvature": a},
        "void": {"void": a, "void_at": place},
        "strain-stiffening": {"stiffening": a},
        "skin": {"skin": a},
        "added-mass": {"blob": a},
        "creep": {"mu": beam.mu * (1 - a * np.log10(time))},
        "free-length": {} if beam.bridge else {"length": beam.length + a},
        "clamp-gap": {"gap": a} if beam.bridge else {},
        "far-end-pinned": {"far_pinned": True} if beam.bridge else {},
        "string": {"string": a},
        # a lamp warms the specimen for the second photograph only
        "lamp": {"mu": beam.mu * (1 - a)} if 50.0 < time < 500.0 else {},
        # photographed while it vibrates: the deflection varies about the static one between photographs
        "swinging": {} if beam.bridge else {"mu": beam.mu / (1 + a * float(np.clip(dice, -2, 2)))},
    }
    if effect == "compressibility":
        poisson = 0.4995 - a
        return replace(beam, bulk_ratio=2 * (1 + poisson) / (3 * (1 - 2 * poisson)))
    return replace(beam, **changes.get(effect, {}))  # type: ignore[arg-type]


def photographed(edges: Array, length: float, effect: str, amplitude: float) -> Array:
    """Edges (2, k, 2) [m] in the image of a camera with a fault.

    camera-roll [rad]: counter-clockwise rotation about the frame's origin as seen with x right and z up
    (raises the free end). image-scale: relative scaling about the origin. lens-distortion [1/m2]: r grows by
    amplitude r^3 about the middle of the free length, z = 0. shadow [m]: downward displacement of the lower
    edge over 40 mm about 45 % of the length.
    """
    x, z = edges[..., 0], edges[..., 1]
    if effect == "camera-roll":
        c, s = np.cos(amplitude), np.sin(amplitude)
        return np.stack([c * x - s * z, s * x + c * z], axis=-1)
    if effect == "image-scale":
        return edges * (1 + amplitude)
    if effect == "lens-distortion":
        arm = edges - np.array([length / 2, 0.0])
        return edges + amplitude * (arm**2).sum(axis=-1, keepdims=True) * arm
    if effect == "shadow":
        along = (x[1] - 0.45 * length) / 0.020
        moved = edges.copy()
        moved[1, :, 1] -= amplitude * np.where(np.abs(along) < 1, np.cos(np.pi * along / 2) ** 2, 0.0)
        return moved
    return edges


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
