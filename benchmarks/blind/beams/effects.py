"""Effects that a case of the blind beams may hide: their ranges, what they do to a beam or to its photograph.

Amplitudes are in SI. `PARAMETER` holds, for each effect, the parameter that a diagnosis reports (the name
contains its unit) and the factor that converts it to SI. Signs are defined in `model.Beam` and below.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.blind.beams.model import Beam

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
