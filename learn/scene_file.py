"""A poke to predict, as a YAML file; lengths in mm, angles in degrees, because people write it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import torch
import yaml
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from learn.data import Store
from learn.data._format import RIGID
from learn.errors import InputError
from learn.models import Pokes, Scene, make_scene

_MM = 1e-3


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


Length = Annotated[float, Field(gt=0, lt=1000)]
Pair = tuple[float, float]


class Sphere(_Strict):
    """centre_mm: in the block's frame, z from the base up."""

    kind: Literal["sphere"]
    radius_mm: Length
    centre_mm: tuple[float, float, float]


class Cylinder(_Strict):
    """Upright."""

    kind: Literal["cylinder"]
    radius_mm: Length
    height_mm: Length
    centre_mm: tuple[float, float, float]


class Cube(_Strict):
    """Turned by angle_deg about the vertical."""

    kind: Literal["cube"]
    side_mm: Length
    centre_mm: tuple[float, float, float]
    angle_deg: float = 0.0


class PokeFile(_Strict):
    """One poke: where, how deep, how inclined, into what.

    site_mm: where the rod's axis meets the rest surface. angle_deg: from the surface's normal;
    heading_deg: of the push's horizontal part, from x towards y. shape: one of the dataset's, or inclusion:
    a body of one's own. softness: one of the dataset's, or shear_modulus_kPa: at small strain.
    """

    site_mm: Pair
    depth_mm: Length
    angle_deg: Annotated[float, Field(ge=0, lt=80)] = 0.0
    heading_deg: float = 0.0
    shape: str | None = None
    inclusion: Annotated[Sphere | Cylinder | Cube, Field(discriminator="kind")] | None = None
    softness: str | None = None
    shear_modulus_kPa: Annotated[float, Field(gt=0, lt=1e6)] | None = None


def load_poke(path: Path) -> PokeFile:
    """The file's poke; InputError names the key that is wrong."""
    if not path.is_file():
        raise InputError(f"{path}: no such scene file")
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not YAML ({' '.join(str(error).split())[:120]})") from None
    try:
        poke = PokeFile.model_validate(values)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"]) or "(the whole file)"
        raise InputError(f"{path}: key {key}: {first['msg']}") from None
    for one, other in (("shape", "inclusion"), ("softness", "shear_modulus_kPa")):
        if (getattr(poke, one) is None) == (getattr(poke, other) is None):
            raise InputError(f"{path}: expected either {one} or {other}")
    return poke


def scene_and_poke(file: PokeFile, store: Store, path: Path) -> tuple[Scene, Pokes]:
    """The poke on the store's grid, one interior; InputError where it does not fit the block."""
    points = store.points
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    site = np.array(file.site_mm) * _MM
    if (site < low).any() or (site > high).any():
        bounds = ", ".join(f"{a * 1e3:.1f} to {b * 1e3:.1f}" for a, b in zip(low, high, strict=True))
        raise InputError(f"{path}: key site_mm: expected x and y within {bounds}")
    scene = make_scene(
        points=points,
        normals=store.normals,
        profile=_profile(file, store, path)[None],
        level_depth=store.level_depth,
        rod_radius=store.rod_radius,
        rod_edge=store.rod_edge,
    )
    lean, heading = math.radians(file.angle_deg), math.radians(file.heading_deg)
    sine, cosine = math.sin(lean), math.cos(lean)
    direction = np.array([sine * math.cos(heading), sine * math.sin(heading), -cosine])
    start = np.array([*site, points[0, 2]]) - direction * _set_back(store, sine, cosine) / cosine

    def tensor(*values: float) -> torch.Tensor:
        return torch.tensor(values, dtype=torch.float64)

    pokes = Pokes(
        geometry=torch.zeros(1, dtype=torch.int64),
        start=torch.from_numpy(start)[None],
        direction=torch.from_numpy(direction)[None],
        depth=tensor(file.depth_mm * _MM),
        modulus=tensor(_modulus(file, store, path)),
    )
    return scene, pokes


def _set_back(store: Store, sine: float, cosine: float) -> float:
    """How high above the surface the middle of the inclined tip is at first touch [m]."""
    return store.rod_edge * (1 - cosine) + (store.rod_radius - store.rod_edge) * sine


def _modulus(file: PokeFile, store: Store, path: Path) -> float:
    if file.shear_modulus_kPa is not None:
        return file.shear_modulus_kPa * 1e3
    assert file.softness is not None
    if file.softness not in store.softness_names:
        raise InputError(f"{path}: key softness: expected one of {', '.join(store.softness_names)}")
    level = store.softness_names.index(file.softness)
    return float(store.modulus[store.softness == level][0])


def _profile(file: PokeFile, store: Store, path: Path) -> NDArray[np.uint8]:
    """Interior under each point, (n, levels); silicone as 0: our model sees what is rigid alone."""
    if file.shape is not None:
        if file.shape not in store.shapes:
            raise InputError(f"{path}: key shape: expected one of {', '.join(store.shapes)}")
        mine = store.shape == store.shapes.index(file.shape)
        if file.softness is not None and file.softness in store.softness_names:
            mine &= store.softness == store.softness_names.index(file.softness)
        return store.profile[store.geometry[mine][0]]
    body = file.inclusion
    assert body is not None
    columns = np.repeat(store.points[:, None], len(store.level_depth), axis=1)
    columns[..., 2] -= store.level_depth
    local = columns - np.array(body.centre_mm) * _MM
    if isinstance(body, Sphere):
        inside = (local**2).sum(axis=2) <= (body.radius_mm * _MM) ** 2
    elif isinstance(body, Cylinder):
        radial = (local[..., :2] ** 2).sum(axis=2) <= (body.radius_mm * _MM) ** 2
        inside = radial & (np.abs(local[..., 2]) <= body.height_mm * _MM / 2)
    else:
        c, s = math.cos(math.radians(body.angle_deg)), math.sin(math.radians(body.angle_deg))
        half = body.side_mm * _MM / 2
        u, v = c * local[..., 0] + s * local[..., 1], c * local[..., 1] - s * local[..., 0]
        inside = (np.abs(u) <= half) & (np.abs(v) <= half) & (np.abs(local[..., 2]) <= half)
    return np.where(inside, RIGID, 0).astype(np.uint8)
