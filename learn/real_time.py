"""Predictions in real time (about 1 kHz): one interior, then poke by poke.

>>> lump = {"kind": "sphere", "radius_mm": 8, "centre_mm": [0, 0, 17]}
>>> predictor = learn.load("covers")
>>> touch = predictor.real_time({"inclusion": lump, "shear_modulus_kPa": 12})  # once an interior
>>> answer = touch(site=(5e-3, -10e-3), direction=(0, 0, -1), depth=4e-3)  # each millisecond
>>> answer.force, answer.force_interval, answer.displacement, answer.inside

Lengths here are in metres. A pose that no indentation can have, such as a tip in the inclusion, raises
`learn.errors.ImpossiblePokeError`, whose `reason` a loop can read. `torch.set_num_threads(1)` is the
fastest if the machine has other work.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import BaseModel

from learn.data import Store
from learn.errors import ImpossiblePokeError, InputError
from learn.evaluation import Intervals
from learn.models import InvariantGnn
from learn.models.single_poke import SinglePoke
from learn.pose_limits import ANGLE_TEXT, LEAST_COSINE, SiteLimits, in_inclusion
from learn.quantities import Obstacle, covariates, cover_at, obstacle, poke_values
from learn.scene_file import kind_of, load_poke, scene_and_poke
from learn.training import Run
from learn.validity import Domain, unknown_checks
from learn.verdict import Check, verdict

Floats = NDArray[np.float64]
_ONE = 1e-6  # tolerance on the length of a direction
MAIN = ("depth_mm", "angle_deg", "cover_mm")  # quantities whose trained ranges `repr` shows


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """Prediction of one poke. SI units.

    Attributes
    ----------
    depth : travel since first contact [m].
    displacement : displacement of the surface's points [m], shape (n, 3), float32.
    force : magnitude of the force on the indenter [N].
    force_interval : 90 % interval of the force [N]; None without intervals or without contact.
    inside : True if the poke is inside the domain of validity; None if that is not known.
    distance : distance from the trained ranges, 0 inside (`learn.validity.Domain.distance`); NaN if they are
        not known.
    """

    depth: float
    displacement: NDArray[np.float32]
    force: float
    force_interval: tuple[float, float] | None
    inside: bool | None
    distance: float
    _radius_mm: Callable[[Floats], Floats] | None
    _checks: Callable[[], list[Check]]

    @cached_property
    def checks(self) -> list[Check]:
        """Comparison of each quantity with its trained range, made when it is first read."""
        return self._checks()

    @property
    def verdict(self) -> str:
        """The domain of validity in words (`learn.verdict`)."""
        if not self.depth > 0.0:
            return "No contact: nothing moves."
        return verdict(self.checks, intervals=self.force_interval is not None)

    @cached_property
    def radius(self) -> Floats | None:
        """Radius of the 90 % interval at each point [m], shape (n,); None without intervals or contact."""
        if self._radius_mm is None:
            return None
        size = np.sqrt(np.einsum("nk,nk->n", self.displacement, self.displacement))
        return self._radius_mm(size) * 1e-3


class _Contact(NamedTuple):
    """First contact: the tip [m], the cover below it [m], and the points' distances from it (n,) [m]."""

    start: Floats
    cover: float
    away: Floats


class RealTime:
    """One interior of a predictor, made by `Predictor.real_time`.

    What depends on the contact alone (`site` and `direction`) is kept for the next poke: the first answer of
    a contact takes longer than those at other depths. One thread may call it at a time.

    Parameters
    ----------
    run, store, domain, intervals : those of the predictor. The run is one of invariant-gnn or
        invariant-gnn-small, trained without time.
    interior : keys of `learn.scene_file.PokeScene` that describe the tissue: shape or inclusion, block_mm,
        softness or shear_modulus_kPa, and law.

    Attributes
    ----------
    points : rest positions of the surface's points [m], shape (n, 3).
    modulus : shear modulus at small strain [Pa]; may be changed between pokes.

    Raises
    ------
    InputError
        If the run has another model, a key is wrong, or the inclusion does not fit the block.
    """

    def __init__(
        self,
        run: Run,
        store: Store,
        interior: Mapping[str, Any],
        *,
        domain: Domain | None,
        intervals: Intervals | None,
    ) -> None:
        if not isinstance(run.model, InvariantGnn):
            raise InputError(
                f"{run.folder}: in real time expected one run of invariant-gnn or invariant-gnn-small, got "
                f"{f'one of {run.recipe.model}' if not run.members else 'several'}"
            )
        for key in ("site_mm", "depth_mm", "angle_deg", "heading_deg"):
            if key in interior:
                raise InputError(f"scene: unexpected key {key}: it is given with each poke")
        for key in ("time_s", "rod_speed_mm_per_s", "approach_speed_mm_per_s"):
            if key in interior:
                raise InputError(f"scene: unexpected key {key}: the model was trained without time")
        middle = (store.setups[0].middle * 1e3).tolist()
        file = load_poke({**interior, "site_mm": middle, "depth_mm": 1e-3})
        self._setup, self._interior, scene, pokes = scene_and_poke(file, store)
        with torch.no_grad():
            encoded = run.model.encode(scene, run.model.prepare(scene))
        self._single = SinglePoke(run.model, encoded)
        self._domain = domain
        self._kind = kind_of(file, store)
        self._known = self._domain is None or self._domain.knows(self._kind)
        self._law = file.law
        self._network = f"{run.folder.name}, {run.recipe.model}"
        self._inclusion = file.shape or _described(file.inclusion)
        self._intervals = intervals
        self.points, self.modulus = self._setup.points, float(pokes.modulus[0])
        self._points = np.ascontiguousarray(self.points.T)
        self._limits = SiteLimits.of(self._setup)
        self._least_cover = float(self._interior.soft.min())
        self._last: tuple[tuple[float, ...], _Contact] | None = None
        self._way: tuple[tuple[float, ...], Obstacle | None] | None = None

    def __repr__(self) -> str:
        length, width, height = (1e3 * side for side in self._setup.block_size)
        rows = {
            "network": self._network,
            "inclusion": self._inclusion,
            "block": f"{length:.4g} x {width:.4g} x {height:.4g} mm, {len(self.points)} points on top",
            "shear modulus": f"{1e-3 * self.modulus:.4g} kPa",
            "intervals": "none" if self._intervals is None else self._intervals.text,
            "trained": "not known" if self._domain is None else ", ".join(self._domain.texts(MAIN)),
            "threads": f"{torch.get_num_threads()} of torch",
        }
        return "RealTime(\n" + "".join(f"  {key}: {value}\n" for key, value in rows.items()) + ")"

    def __call__(
        self,
        *,
        site: Sequence[float],
        direction: Sequence[float],
        depth: float,
    ) -> Answer:
        """Displacement, force and its interval of one poke.

        Parameters
        ----------
        site : intersection of the indenter's axis with the rest surface, (x, y) [m].
        direction : unit vector of the push, (3,).
        depth : travel since first contact [m]; at 0 or less the indenter does not touch, wherever it is, and
            nothing moves.

        Raises
        ------
        ImpossiblePokeError
            If the indenter touches beside the block, is as deep as the block is high, is inclined by more
            than 45 degrees, or its tip has come to the inclusion, as `Predictor.predict` refuses them.
            `reason` names which.
        InputError
            If a value is not finite, the direction does not point into the block or is not a unit vector, or
            `modulus` is not above 0.
        """
        push, depth = np.asarray(direction, dtype=np.float64), float(depth)
        if push.shape != (3,) or not abs(math.sqrt(float(push @ push)) - 1.0) <= _ONE or not push[2] < 0.0:
            raise InputError(
                f"direction: expected a unit vector that points down into the block, got {direction}"
            )
        if len(site) != 2:
            raise InputError(f"site: expected (x, y), got {tuple(site)}")
        if not (math.isfinite(depth) and math.isfinite(site[0]) and math.isfinite(site[1])):
            raise InputError(f"expected finite site and depth, got {tuple(site)} and {depth}")
        modulus = float(self.modulus)
        if not 0.0 < modulus < math.inf:
            raise InputError(f"modulus: expected a shear modulus above 0 Pa, got {modulus}")
        if depth > 0.0:
            self._check_touch(site, push, depth)
        key = (*site, *push)
        if self._last is None or self._last[0] != key:
            self._last = key, self._contact(site, push)
        start, cover, away = self._last[1]
        if depth > self._least_cover:  # most pokes are not as deep as the thinnest cover
            self._check_way(key, start, push, depth)
        u, force = self._single(start, push, depth, modulus)
        values = poke_values(
            self._setup,
            self._interior,
            start=start,
            direction=push,
            depth=depth,
            modulus=modulus,
            cover=cover,
        )
        distance = math.nan if self._domain is None else self._domain.distance(values, self._law)
        if depth <= 0.0:
            distance = 0.0  # nothing moves, whatever was trained
        interval, radius_mm = None, None
        if self._intervals is not None and depth > 0.0:
            near = covariates(self._setup, self._interior, start=start, direction=push, depth=depth)
            known = 0.0 if math.isnan(distance) else distance
            factor = math.exp(self._intervals.force_log(covariates=near, distance=known))
            interval = (force / factor, force * factor)
            radius_mm = partial(
                self._intervals.radius_at_mm, away=away, depth=depth, covariates=near, distance=known
            )
        checked = values, self._kind, self._law
        checks = partial(unknown_checks if self._domain is None else self._domain.check, *checked)
        return Answer(
            depth=depth,
            displacement=u,
            force=force,
            force_interval=interval,
            inside=depth <= 0.0 or (None if math.isnan(distance) else self._known and distance == 0.0),
            distance=distance,
            _radius_mm=radius_mm,
            _checks=checks,
        )

    def _check_touch(self, site: Sequence[float], push: Floats, depth: float) -> None:
        """Refuse what is no indentation of the block: most often millimetres in the place of metres."""
        limits, (x, y) = self._limits, site
        (x0, y0), (x1, y1) = limits.low, limits.high
        if not (x0 <= x <= x1 and y0 <= y <= y1):
            raise ImpossiblePokeError(f"site: {limits.site_text('m')}, got ({x:.4g}, {y:.4g}) m", "site")
        if depth >= limits.height:
            raise ImpossiblePokeError(f"depth: {limits.height_text('m')}, got {depth:.4g} m", "depth")
        if -push[2] < LEAST_COSINE:
            angle = math.degrees(math.acos(-push[2]))
            raise ImpossiblePokeError(f"direction: {ANGLE_TEXT}, got {angle:.4g}", "angle")

    def _check_way(self, key: tuple[float, ...], start: Floats, push: Floats, depth: float) -> None:
        """Refuse a tip that has come to the inclusion; `key` is that of the contact."""
        if self._way is None or self._way[0] != key:
            self._way = key, obstacle(self._setup, self._interior, start, push)
        met = self._way[1]
        if met is not None and depth >= met.depth:
            raise ImpossiblePokeError(f"depth: {in_inclusion(met, 'm')}, got {depth:.4g} m", "inclusion")

    def _contact(self, site: Sequence[float], push: Floats) -> _Contact:
        start = self._setup.first_touch(site, push)
        r = self._points - start[:, None]
        cover = cover_at(self._setup, self._interior, start, push)
        return _Contact(start, cover, np.sqrt((r * r).sum(axis=0)))


def _described(inclusion: BaseModel | None) -> str:
    """Keys and values of an inclusion: "sphere, radius_mm 8, centre_mm (0, 0, 17)"."""
    keys = {} if inclusion is None else inclusion.model_dump()
    return ", ".join(_text(key, value) for key, value in keys.items())


def _text(key: str, value: Any) -> str:
    if key == "kind":
        return "no inclusion" if value == "none" else str(value)
    numbers = value if isinstance(value, tuple) else (value,)
    text = ", ".join(f"{number:.4g}" for number in numbers)
    return f"{key} {f'({text})' if isinstance(value, tuple) else text}"
