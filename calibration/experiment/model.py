"""A measured experiment as the code sees it: frozen, SI units, what the lab believes and how sure it is.

Files hold millimetres (`measured/FORMAT.md`); everything here is in m, N, Pa, kg, s and radians.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tisim import Block, Circle, Rectangle

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Supports = Literal["clamped-free", "clamped-clamped"]
CouponMode = Literal["uniaxial", "equibiaxial", "planar", "simple-shear"]


@dataclass(frozen=True, kw_only=True)
class MaterialBelief:
    """density [kg/m3] and its standard deviation; None where the lab does not say."""

    name: str
    softener_ratio: float | None = None
    density: float | None = None
    density_sd: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Registration:
    """Standard deviations of where a photograph lies: one draw a photograph. shift [m] (x and z alike), roll
    [rad] about the frame's origin, scale [-]."""

    shift: float = 0.0
    roll: float = 0.0
    scale: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class TracedOutline:
    """The contour in the image plane: upper and lower edge as (k, 2) arrays of x, z [m], along the beam from
    the clamp; sd [m] of its error along the normal, correlation [m] of that error along the contour."""

    upper: Array
    lower: Array
    sd: float
    correlation: float
    registration: Registration = field(default_factory=Registration)


@dataclass(frozen=True, kw_only=True)
class Checkerboard:
    """Squares along the two sides of the board in the photograph, and the side of one [m]."""

    squares: tuple[int, int]
    square: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Capture:
    """One photograph of a beam, `time` [s] after its release: traced, or still to be traced.

    registration: what the lab says of where the photograph lies, None where it does not; a traced outline has
    it too.
    """

    time: float
    outline: TracedOutline | None = None
    photo: Path | None = None
    checkerboard: Checkerboard | None = None
    registration: Registration | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Marker:
    """One marker: where it sits in the unloaded pose [m], and its displacement from there [m], shape (t, 3),
    at `time` [s], shape (t,)."""

    name: str
    position: Vector
    time: Array
    displacement: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class BeamTrial:
    """A beam in its grips. section, free_length, grip_length, gravity, tip_force as in `tisim.Beam`.

    specimen: trials with one specimen share its faults. section_sd: of the radius, or of (width, height) [m].
    marker_sd [m]: of each component of a marker's displacement.
    """

    id: str
    material: str
    section: Circle | Rectangle
    free_length: float
    grip_length: float
    supports: Supports
    gravity: Vector
    tip_force: Vector = (0.0, 0.0, 0.0)
    specimen: str | None = None
    section_sd: tuple[float, ...] = (0.0,)
    free_length_sd: float = 0.0
    captures: tuple[Capture, ...] = ()
    markers: tuple[Marker, ...] = ()
    marker_sd: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeRecord:
    """time [s], depth [m], force along the rod [N] (positive pushing), each (t,); force_vector (t, 3) [N]
    where the lab has it. Loading, holds and unloading as they came."""

    time: Array
    depth: Array
    force: Array
    force_vector: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceScan:
    """Points of the block's top surface at one instant [s], (k, 3) [m]."""

    time: float
    points: Array
    sd: float


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeTrial:
    """A rod pushed into a block (as in `tisim.Poke`); inclusion_mesh: a rigid body given as a mesh file."""

    id: str
    material: str
    block: Block
    rod_radius: float
    rod_tip: Literal["flat", "hemisphere"]
    start: Vector
    direction: Vector
    record: PokeRecord
    force_sd: float | None = None
    depth_sd: float = 0.0
    specimen: str | None = None
    inclusion_mesh: Path | None = None
    surfaces: tuple[SurfaceScan, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class CouponTrial:
    """A homogeneous test: stretch (simple-shear: 1 + gamma) and nominal stress [Pa], each (k,); time [s]
    where the lab has it. stress_sd [Pa]; None where the lab does not say."""

    id: str
    material: str
    mode: CouponMode
    stretch: Array
    stress: Array
    time: Array | None = None
    stretch_sd: float = 0.0
    stress_sd: float | None = None
    specimen: str | None = None


Trial = BeamTrial | PokeTrial | CouponTrial


@dataclass(frozen=True, eq=False, kw_only=True)
class Experiment:
    """A folder of measurements, read and checked. digest: sha256 over experiment.yaml and all files that it
    names, so that a card can say what data it came from."""

    name: str
    folder: Path
    notes: str
    materials: Mapping[str, MaterialBelief]
    trials: tuple[Trial, ...]
    digest: str
