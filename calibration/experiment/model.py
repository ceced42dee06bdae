"""A measured experiment: frozen, SI units, nominal values with their standard deviations.

Files hold millimetres; everything here is in m, N, Pa, kg, s and radians.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tisim import Beam, Block, Circle, Material, Rectangle

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Supports = Literal["clamped-free", "clamped-clamped"]
CouponMode = Literal["uniaxial", "equibiaxial", "planar", "simple-shear"]


@dataclass(frozen=True, kw_only=True)
class MaterialBelief:
    """A material as the lab describes it.

    Attributes
    ----------
    name : str
    softener_ratio : float, optional
        Parts of softener to one part of silicone.
    density, density_sd : float
        [kg/m3]; the density is None where the lab does not state it.
    """

    name: str
    softener_ratio: float | None = None
    density: float | None = None
    density_sd: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Registration:
    """Standard deviations of a photograph's position.

    Attributes
    ----------
    shift : float
        Standard deviation of the shift along x and along z [m].
    roll : float
        Standard deviation of the rotation about the frame's origin [rad].
    scale : float
    """

    shift: float = 0.0
    roll: float = 0.0
    scale: float = 0.0

    def plus(self, other: Registration) -> Registration:
        """Standard deviations of the sum with an independent error."""
        return Registration(
            shift=math.hypot(self.shift, other.shift),
            roll=math.hypot(self.roll, other.roll),
            scale=math.hypot(self.scale, other.scale),
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class TracedOutline:
    """The contour of a beam in the image plane.

    Attributes
    ----------
    upper, lower : array, shape (k, 2)
        x, z of the edges [m], along the beam from the clamp.
    sd : float
        Standard deviation of the error along the normal [m].
    correlation : float
        Length over which that error holds along the contour [m].
    registration : Registration
        One draw a photograph.
    shared : Registration
        One draw for all photographs of an experiment: errors of the board, its mounting and the camera.
    """

    upper: Array
    lower: Array
    sd: float
    correlation: float
    registration: Registration = field(default_factory=Registration)
    shared: Registration = field(default_factory=Registration)


@dataclass(frozen=True, kw_only=True)
class Checkerboard:
    """Squares along the two sides of the board in the photograph, and the side of one [m]."""

    squares: tuple[int, int]
    square: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Capture:
    """One photograph of a beam: traced, or still to be traced.

    Attributes
    ----------
    time : float
        Time after the beam's release [s].
    outline : TracedOutline, optional
    photo : Path, optional
    checkerboard : Checkerboard, optional
        The board in the photograph.
    registration : Registration, optional
        As the lab states it; a traced outline has its own too.
    """

    time: float
    outline: TracedOutline | None = None
    photo: Path | None = None
    checkerboard: Checkerboard | None = None
    registration: Registration | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Marker:
    """One marker on a beam.

    Attributes
    ----------
    name : str
    position : tuple
        Position in the unloaded pose [m].
    time : array, shape (t,)
        [s]
    displacement : array, shape (t, 3)
        Displacement from that position [m].
    """

    name: str
    position: Vector
    time: Array
    displacement: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class BeamTrial:
    """A beam in its grips.

    Attributes
    ----------
    id, material : str
    section, free_length, grip_length, supports, gravity, tip_force
        As in `tisim.Beam`, SI.
    tip_force_height : float
        Height over the axis at which the tip force acts on the end face, which turns [m].
    specimen : str, optional
        Trials of one specimen share its faults.
    section_sd : tuple of float
        Standard deviation of the radius, or of (width, height) [m].
    free_length_sd : float
        [m]
    captures : tuple of Capture
    markers : tuple of Marker
    marker_sd : float, optional
        Standard deviation of each component of a marker's displacement [m].
    """

    id: str
    material: str
    section: Circle | Rectangle
    free_length: float
    grip_length: float
    supports: Supports
    gravity: Vector
    tip_force: Vector = (0.0, 0.0, 0.0)
    tip_force_height: float = 0.0
    specimen: str | None = None
    section_sd: tuple[float, ...] = (0.0,)
    free_length_sd: float = 0.0
    captures: tuple[Capture, ...] = ()
    markers: tuple[Marker, ...] = ()
    marker_sd: float | None = None

    @property
    def traced(self) -> bool:
        """True if the outline of at least one photograph is traced."""
        return any(c.outline is not None for c in self.captures)


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeRecord:
    """Record of an indentation: loading, holds and unloading as they came.

    Attributes
    ----------
    time, depth, force : array, shape (t,)
        [s], [m], and the force along the indenter [N], positive where it pushes.
    force_vector : array, shape (t, 3), optional
        [N]
    """

    time: Array
    depth: Array
    force: Array
    force_vector: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceScan:
    """Points of the block's top surface at one instant.

    Attributes
    ----------
    time : float
        [s]
    points : array, shape (k, 3)
        [m]
    sd : float
        Standard deviation of each coordinate [m].
    """

    time: float
    points: Array
    sd: float


@dataclass(frozen=True, eq=False, kw_only=True)
class PokeTrial:
    """Indentation of a block, as in `tisim.Poke`.

    Attributes
    ----------
    id, material : str
    block : tisim.Block
    rod_radius : float
        Radius of the indenter [m].
    rod_tip : str
        "flat" or "hemisphere".
    start : tuple
        Centre of the tip at depth 0 [m].
    direction : tuple
        Unit vector of the indenter's motion.
    record : PokeRecord
    force_sd, depth_sd : float
        [N], None where the lab does not state it; [m].
    specimen : str, optional
        Trials of one specimen share its faults.
    inclusion_mesh : Path, optional
        A rigid inclusion given as a mesh file.
    surfaces : tuple of SurfaceScan
    """

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
    """A homogeneous test.

    Attributes
    ----------
    id, material : str
    mode : str
    stretch : array, shape (k,)
        Simple shear: 1 + gamma.
    stress : array, shape (k,)
        Nominal [Pa].
    time : array, shape (k,), optional
        [s]
    stretch_sd : float
    stress_sd : float, optional
        [Pa]; None where the lab does not state it.
    specimen : str, optional
        Trials of one specimen share its faults.
    samples : array, shape (k,), optional
        Number of samples that each point is the mean of, where the record was too long to fit point by point;
        None for one each. The standard deviations are those of one sample.
    """

    id: str
    material: str
    mode: CouponMode
    stretch: Array
    stress: Array
    time: Array | None = None
    stretch_sd: float = 0.0
    stress_sd: float | None = None
    specimen: str | None = None
    samples: Array | None = None


Trial = BeamTrial | PokeTrial | CouponTrial


def kind_of(trial: Trial) -> str:
    """Kind of a trial, as experiment.yaml names it: beam, poke, coupon."""
    return type(trial).__name__.removesuffix("Trial").lower()


def specimen_of(trial: Trial) -> str:
    """Name of a trial's specimen: that of its material, if the trial names none."""
    return trial.specimen or trial.material


def beam_as_stated(trial: BeamTrial, material: Material, **settings: Any) -> Beam:
    """Scene of a beam's trial as the lab states it; `settings` are further arguments of `tisim.Beam`."""
    return Beam(
        material=material,
        length=trial.free_length,
        section=trial.section,
        supports=trial.supports,
        grip_length=trial.grip_length,
        gravity=trial.gravity,
        tip_force=trial.tip_force,
        **settings,
    )


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Experiment:
    """A folder of measurements, read and checked.

    Attributes
    ----------
    name, notes : str
    folder : Path
    materials : mapping
        `MaterialBelief` by name.
    trials : tuple of Trial
    digest : str
        sha256 over experiment.yaml and all files that it names: a card states what data it came from.
    """

    name: str
    folder: Path
    notes: str
    materials: Mapping[str, MaterialBelief]
    trials: tuple[Trial, ...]
    digest: str

    @property
    def counts(self) -> dict[str, int]:
        """Number of trials by kind: beam, poke, coupon."""
        found: dict[str, int] = {}
        for trial in self.trials:
            found[kind_of(trial)] = found.get(kind_of(trial), 0) + 1
        return found

    def __reduce__(self) -> tuple[Any, ...]:
        """For other processes: a read-only view of a mapping cannot be sent."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return _experiment, (type(self), values | {"materials": dict(self.materials)})

    def __repr__(self) -> str:
        kinds = ", ".join(f"{n} {kind}{'s' if n > 1 else ''}" for kind, n in self.counts.items())
        return f"Experiment({self.name!r}: {kinds} of {', '.join(self.materials)}; {self.folder})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(t.id)}</td><td>{kind_of(t)}</td><td>{escape(t.material)}</td></tr>"
            for t in self.trials
        )
        head = "<tr><th>trial</th><th>kind</th><th>material</th></tr>"
        return f"<p>{escape(self.name)} ({escape(str(self.folder))})</p><table>{head}{rows}</table>"


def _experiment(kind: type[Experiment], values: dict[str, Any]) -> Experiment:
    return kind(**values | {"materials": MappingProxyType(values["materials"])})
