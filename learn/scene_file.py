"""A poke to predict, as a YAML file or a dictionary in users' units: lengths in mm, angles in degrees.

The keys are those of `PokeScene`. A poke that does not fit the block is refused with the name of
the key, since no model can predict it. `learn.validity` checks whether a poke is inside the trained ranges.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from learn._yaml import Finite, first_fault, read_yaml
from learn.data._format import RIGID
from learn.data.setup import Setup
from learn.data.store import Store
from learn.errors import InputError
from learn.models import Pokes, Scene, scene_on
from learn.pose_limits import STEEPEST, SiteLimits, in_inclusion
from learn.quantities import Interior, interior_of, obstacle, shape_kind

_MM = 1e-3


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


Length = Annotated[float, Field(strict=True, gt=0, lt=1000)]
Pair = tuple[Finite, Finite]
Triple = tuple[Finite, Finite, Finite]
Name = Annotated[str, Field(strict=True, min_length=1)]


class NoInclusion(_Strict):
    """A block without an inclusion."""

    kind: Literal["none"]

    def inside(self, local: NDArray[np.float64]) -> NDArray[np.bool_]:
        return np.zeros(local.shape[:-1], dtype=bool)


class Sphere(_Strict):
    """A rigid sphere; `centre_mm` is in the block's frame, z above the base."""

    kind: Literal["sphere"]
    radius_mm: Length
    centre_mm: Triple

    @property
    def half_mm(self) -> Triple:
        """Half extents in x, y and z."""
        return self.radius_mm, self.radius_mm, self.radius_mm

    def inside(self, local: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Mask of the points (..., 3), relative to the centre [m], that lie in it."""
        return np.asarray((local**2).sum(axis=-1) <= (self.radius_mm * _MM) ** 2)


class Cylinder(_Strict):
    """A rigid upright cylinder; `centre_mm` is the centre of its volume."""

    kind: Literal["cylinder"]
    radius_mm: Length
    height_mm: Length
    centre_mm: Triple

    @property
    def half_mm(self) -> Triple:
        return self.radius_mm, self.radius_mm, self.height_mm / 2

    def inside(self, local: NDArray[np.float64]) -> NDArray[np.bool_]:
        radial = (local[..., :2] ** 2).sum(axis=-1) <= (self.radius_mm * _MM) ** 2
        return np.asarray(radial & (np.abs(local[..., 2]) <= self.height_mm * _MM / 2))


class Cube(_Strict):
    """A rigid cube, rotated by `angle_deg` about the vertical; `centre_mm` is the centre of its volume."""

    kind: Literal["cube"]
    side_mm: Length
    centre_mm: Triple
    angle_deg: Finite = 0.0

    @property
    def half_mm(self) -> Triple:
        turn, half = math.radians(self.angle_deg), self.side_mm / 2
        reach = half * (abs(math.cos(turn)) + abs(math.sin(turn)))
        return reach, reach, half

    def inside(self, local: NDArray[np.float64]) -> NDArray[np.bool_]:
        c, s = math.cos(math.radians(self.angle_deg)), math.sin(math.radians(self.angle_deg))
        half = self.side_mm * _MM / 2
        u, v = c * local[..., 0] + s * local[..., 1], c * local[..., 1] - s * local[..., 0]
        return np.asarray((np.abs(u) <= half) & (np.abs(v) <= half) & (np.abs(local[..., 2]) <= half))


Inclusion = Annotated[Sphere | Cylinder | Cube | NoInclusion, Field(discriminator="kind")]


class PokeScene(_Strict):
    """One poke.

    Attributes
    ----------
    site_mm : intersection of the indenter's axis with the rest surface, (x, y), in the dataset's frame, whose
        origin is the middle of the block.
    depth_mm : travel along the push since first contact.
    angle_deg : angle between the push and the surface's normal, 0 to 45.
    heading_deg : direction of the push's horizontal part, from x towards y.
    shape, inclusion : a shape of the dataset by name, or any other inclusion; exactly one of the two.
    block_mm : length, width and height of the block around an `inclusion`; by default that of the dataset,
        if all its shapes stand in blocks of one size.
    time_s, rod_speed_mm_per_s, approach_speed_mm_per_s : time since first contact, current speed of the rod
        (0 in a hold, negative in a retraction), speed of approach; all three, for models trained with time.
    softness, shear_modulus_kPa : a level of the dataset by name, or the shear modulus at small strain;
        exactly one of the two.
    law : material law of the tissue, named as in datasets ("ogden"). The model always predicts for its
        dataset's law: another one is flagged, and widens the intervals.
    """

    site_mm: Pair
    depth_mm: Length
    angle_deg: Annotated[float, Field(strict=True, ge=0, le=STEEPEST)] = 0.0
    heading_deg: Annotated[float, Field(strict=True, ge=-360, le=360)] = 0.0
    shape: Name | None = None
    inclusion: Inclusion | None = None
    block_mm: tuple[Length, Length, Length] | None = None
    softness: Name | None = None
    shear_modulus_kPa: Annotated[float, Field(strict=True, gt=0, lt=1e6)] | None = None
    law: Name | None = None
    time_s: Annotated[float, Field(strict=True, gt=0, lt=1e9)] | None = None
    rod_speed_mm_per_s: Annotated[float, Field(strict=True, gt=-1e6, lt=1e6)] | None = None
    approach_speed_mm_per_s: Annotated[float, Field(strict=True, gt=0, lt=1e6)] | None = None

    @model_validator(mode="after")
    def _one_each(self) -> Self:
        for one, other in (("shape", "inclusion"), ("softness", "shear_modulus_kPa")):
            if (getattr(self, one) is None) == (getattr(self, other) is None):
                raise ValueError(f"expected either {one} or {other}")
        if self.shape is not None and self.block_mm is not None:
            raise ValueError("expected no key block_mm beside shape, which stands in its own block")
        if len({value is None for value in self._clock}) > 1:
            raise ValueError(
                "expected time_s, rod_speed_mm_per_s and approach_speed_mm_per_s, or none of them"
            )
        return self

    @property
    def _clock(self) -> tuple[float | None, float | None, float | None]:
        return self.time_s, self.rod_speed_mm_per_s, self.approach_speed_mm_per_s

    @property
    def clock(self) -> tuple[float, float, float] | None:
        """Time [s], the indenter's speed and its speed of approach [m/s]; None without time."""
        time, speed, approach = self._clock
        if time is None or speed is None or approach is None:
            return None
        return time, speed * _MM, approach * _MM

    @property
    def free(self) -> bool:
        """True if inclusion or modulus are given by value, not by a name of the dataset."""
        return self.inclusion is not None or self.shear_modulus_kPa is not None


def load_poke(source: Path | str | Mapping[str, Any] | PokeScene) -> PokeScene:
    """Load a poke from a YAML file or from keys and values; InputError names a wrong key."""
    if isinstance(source, PokeScene):
        return source
    where = "scene"
    if not isinstance(source, Mapping):
        path = Path(source)
        if not path.is_file():
            raise InputError(f"{path}: no such scene file")
        source, where = read_yaml(path), str(path)
    try:
        return PokeScene.model_validate(dict(source))
    except ValidationError as error:
        raise InputError(f"{where}: {first_fault(error, source)}") from None


def setup_of_scene(file: PokeScene, store: Store, where: str = "scene") -> Setup:
    """The setup of a poke: that of its shape, or the indenter on the stated block, or on the only one."""
    if file.shape is not None:
        return store.setups[int(store.setup_index[_geometry(file, store, where)])]
    if file.block_mm is not None:
        return store.setups[0].with_block([v * _MM for v in file.block_mm])
    if len(store.setups) > 1:
        raise InputError(
            f"{where}: expected key block_mm, the block's sides, since the dataset has "
            f"{store.describe_blocks()}"
        )
    return store.setup


class PokeInput(NamedTuple):
    """Input for the prediction of a poke: the model's is `scene` and `pokes`."""

    setup: Setup
    interior: Interior
    scene: Scene
    pokes: Pokes


def scene_and_poke(file: PokeScene, store: Store, where: str = "scene") -> PokeInput:
    """Input for the prediction of a poke, with the setup's grid over one interior.

    InputError, which begins with `where`, for a poke that does not fit the block.
    """
    setup = setup_of_scene(file, store, where)
    _check_fit(file, setup, where)
    profile = _profile(file, store, setup, where)
    scene = scene_on(setup, profile[None])
    lean, heading = math.radians(file.angle_deg), math.radians(file.heading_deg)
    sine, cosine = math.sin(lean), math.cos(lean)
    direction = np.array([sine * math.cos(heading), sine * math.sin(heading), -cosine])
    start = setup.first_touch((file.site_mm[0] * _MM, file.site_mm[1] * _MM), direction)
    interior = interior_of(setup, profile)
    met = obstacle(setup, interior, start, direction)
    if met is not None and file.depth_mm * _MM >= met.depth:
        raise InputError(f"{where}: key depth_mm: {in_inclusion(met, 'mm')}, got {file.depth_mm:g}")

    def tensor(*values: float) -> torch.Tensor:
        return torch.tensor(values, dtype=torch.float64)

    pokes = Pokes(
        geometry=torch.zeros(1, dtype=torch.int64),
        start=torch.from_numpy(start)[None],
        direction=torch.from_numpy(direction)[None],
        depth=tensor(file.depth_mm * _MM),
        modulus=tensor(_modulus(file, store, where)),
        clock=tensor(*(file.clock or ()))[None],
    )
    return PokeInput(setup, interior, scene, pokes)


def kind_of(file: PokeScene, store: Store) -> str | None:
    """Kind of the inclusion; None if it is not known."""
    return file.inclusion.kind if file.inclusion else shape_kind(store, file.shape or "")


def _check_fit(file: PokeScene, setup: Setup, where: str) -> None:
    size = np.array(setup.block_size) * 1e3
    middle = setup.middle * 1e3
    low, high = middle - size[:2] / 2, middle + size[:2] / 2
    radius = setup.rod_radius * 1e3
    if min(size[:2]) < 2 * radius:
        raise InputError(
            f"{where}: key block_mm: expected sides of the indenter's diameter, {2 * radius:.4g} mm, or more,"
            f" got {size[0]:.4g} x {size[1]:.4g}"
        )
    limits = SiteLimits.of(setup)
    for a, b, value in zip(limits.low, limits.high, file.site_mm, strict=True):
        if not a * 1e3 <= value <= b * 1e3:
            raise InputError(f"{where}: key site_mm: {limits.site_text('mm')}, got {value:g}")
    if file.depth_mm >= size[2]:
        raise InputError(f"{where}: key depth_mm: {limits.height_text('mm')}, got {file.depth_mm:g}")
    body = file.inclusion
    if body is None or isinstance(body, NoInclusion):
        return
    centre, half = np.array(body.centre_mm), np.array(body.half_mm)
    base = setup.top * 1e3 - size[2]
    sides = [(low[0], high[0]), (low[1], high[1]), (base, base + size[2])]
    for k, (axis, (a, b)) in enumerate(zip("xyz", sides, strict=True)):
        # an inclusion may be sunk into the base, but some of it has to be in the block
        below = centre[k] + half[k] <= a if axis == "z" else centre[k] - half[k] < a - 1e-9
        above = centre[k] + half[k] >= b if axis == "z" else centre[k] + half[k] > b + 1e-9
        if below or above:
            raise InputError(
                f"{where}: key inclusion: expected within the block, {axis} {a:.4g} to {b:.4g} mm, but it "
                f"reaches from {centre[k] - half[k]:.4g} to {centre[k] + half[k]:.4g} mm"
            )


def _modulus(file: PokeScene, store: Store, where: str) -> float:
    if file.shear_modulus_kPa is not None:
        return file.shear_modulus_kPa * 1e3
    assert file.softness is not None
    if file.softness not in store.softness_names:
        raise InputError(
            f"{where}: key softness: expected one of {', '.join(store.softness_names)}, got {file.softness!r}"
        )
    level = store.softness_names.index(file.softness)
    moduli = store.modulus[(store.softness == level) & store.done]
    if not len(moduli):
        raise InputError(f"{where}: key softness: the dataset has no poke of {file.softness}")
    return float(moduli[0])


def _geometry(file: PokeScene, store: Store, where: str) -> int:
    """The interior of the named shape, at the named level of softness if there is one."""
    if file.shape not in store.shapes:
        raise InputError(f"{where}: key shape: expected one of {', '.join(store.shapes)}, got {file.shape!r}")
    mine = store.shape == store.shapes.index(file.shape)
    if file.softness is not None and file.softness in store.softness_names:
        mine &= store.softness == store.softness_names.index(file.softness)
    if not mine.any():
        raise InputError(f"{where}: key shape: the dataset has no poke of {file.shape}")
    return int(store.geometry[mine][0])


def _profile(file: PokeScene, store: Store, setup: Setup, where: str) -> NDArray[np.uint8]:
    """Profile under each point, (n, levels); silicone around `inclusion` is 0: only rigidity is read."""
    if file.shape is not None:
        return np.asarray(store.profile[_geometry(file, store, where)])
    body = file.inclusion
    assert body is not None
    columns = np.repeat(setup.points[:, None], len(setup.level_depth), axis=1)
    columns[..., 2] -= setup.level_depth
    centre = np.zeros(3) if isinstance(body, NoInclusion) else np.array(body.centre_mm) * _MM
    # heights count from the base of the block
    centre[2] += setup.top - setup.block_size[2]
    return np.where(body.inside(columns - centre), RIGID, 0).astype(np.uint8)
