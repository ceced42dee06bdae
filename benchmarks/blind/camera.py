"""Ray-cast photographs of known beams: a separate camera model (perspective, radial distortion), light, blur
and noise.

Frame as in docs/reference/experiment-format.md, in mm: x along the beam, z up, y away from the camera;
the board is at y = board_y.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, gaussian_filter
from scipy.spatial import cKDTree

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Lens:
    """Image size (width, height), focal length and centre [pixel], radial distortion k1, k2."""

    size: tuple[int, int] = (2000, 1500)
    focal: float = 4650.0
    centre: tuple[float, float] = (1004.0, 743.0)
    k1: float = 0.0
    k2: float = 0.0


@dataclass(frozen=True, kw_only=True)
class View:
    """Pose of the camera: it looks at `target` [mm] from `distance` [mm].

    Angles in degrees: yaw (to the right, seen from the beam's front), pitch (up), roll about the camera's
    axis.
    """

    target: tuple[float, float, float] = (52.0, 0.0, 16.0)
    distance: float = 400.0
    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0

    def frame(self) -> tuple[Array, Array]:
        """Centre of the camera, and its axes (right, down, forward) as rows."""
        yaw, pitch, roll = np.radians([self.yaw, self.pitch, self.roll])
        away = np.array([np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)])
        right = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        down = np.cross(-away, right)
        turned = np.array(
            [np.cos(roll) * right + np.sin(roll) * down, np.cos(roll) * down - np.sin(roll) * right]
        )
        return np.asarray(self.target) + self.distance * away, np.vstack([turned, -away])


@dataclass(frozen=True, eq=False, kw_only=True)
class Tube:
    """A body of circular section about a planar axis, (k, 2) points x, z [mm], with flat ends.

    `radius` [mm] is a number or (k,) along the axis, since a heavy beam thins where it is stretched.
    """

    axis: Array
    radius: float | Array
    shade: float = 120.0
    gloss: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Clamp:
    """A box from corner `low` to corner `high`: x, y, z [mm]."""

    low: tuple[float, float, float] = (-40.0, -10.0, -22.0)
    high: tuple[float, float, float] = (0.0, 10.0, 22.0)
    shade: float = 60.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Setting:
    """The scene in front of the camera; board_corner: the board's lower left outer corner, x and z [mm]."""

    tubes: tuple[Tube, ...]
    clamps: tuple[Clamp, ...] = (Clamp(),)
    squares: tuple[int, int] = (9, 6)
    square: float = 8.0
    board_corner: tuple[float, float] = (12.0, 26.0)
    board_y: float = 10.0
    board: bool = True
    paper: float = 205.0
    uneven: float = 25.0
    light: tuple[float, float, float] = (-0.25, -0.85, 0.45)
    blur: float = 1.1
    noise: float = 2.5
    glare: tuple[tuple[float, float, float], ...] = field(default=())  # x, z, radius in the plane y = 0
    seed: int = 1


def photograph(setting: Setting, lens: Lens, view: View) -> NDArray[np.uint8]:
    """8-bit grey photograph (height, width)."""
    width, height = lens.size
    caster = _Caster(setting, lens, view)
    v, u = np.mgrid[0 : height + 2 : 2, 0 : width + 2 : 2]
    coarse, label = caster.cast(np.column_stack([u.ravel(), v.ravel()]).astype(float))
    coarse, label = coarse.reshape(u.shape), label.reshape(u.shape)
    image = np.empty((height, width))  # smooth parts interpolated from every second pixel, edges supersampled
    image[::2, ::2] = coarse[:-1, :-1]
    image[1::2, ::2] = 0.5 * (coarse[:-1, :-1] + coarse[1:, :-1])
    image[::2, 1::2] = 0.5 * (coarse[:-1, :-1] + coarse[:-1, 1:])
    image[1::2, 1::2] = 0.25 * (coarse[:-1, :-1] + coarse[1:, :-1] + coarse[:-1, 1:] + coarse[1:, 1:])
    edge = np.zeros(label.shape, bool)
    edge[:, 1:] |= label[:, 1:] != label[:, :-1]
    edge[1:] |= label[1:] != label[:-1]
    edge = np.repeat(np.repeat(binary_dilation(edge), 2, 0), 2, 1)[:height, :width]
    where = np.argwhere(edge)[:, ::-1].astype(float)
    steps = (np.arange(4) + 0.5) / 4 - 0.5
    fine = (where[:, None, None, :] + np.stack(np.meshgrid(steps, steps), -1)[None]).reshape(-1, 2)
    image[edge] = caster.cast(fine)[0].reshape(len(where), -1).mean(axis=1)
    image = gaussian_filter(image, setting.blur)
    rng = np.random.default_rng(setting.seed)
    image += rng.normal(0.0, setting.noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


class _Caster:
    def __init__(self, setting: Setting, lens: Lens, view: View) -> None:
        self.setting, self.lens = setting, lens
        self.centre, self.axes = view.frame()
        self.fields = [_field(tube) for tube in setting.tubes]

    def cast(self, pixels: Array) -> tuple[Array, NDArray[np.int64]]:
        """Brightness of each ray, and a label of the object that it hits."""
        direction = self._directions(pixels)
        step = (self.setting.board_y - self.centre[1]) / direction[:, 1]
        hit = self.centre + step[:, None] * direction
        image, label = self._paper(hit[:, 0], hit[:, 2])
        nearest = step.copy()
        for number, clamp in enumerate(self.setting.clamps):
            near, lit = self._box(direction, clamp)
            seen = near < nearest
            nearest[seen], image[seen], label[seen] = near[seen], lit[seen], 10 + number
        for number, body in enumerate(self.fields):
            rows, near, lit = body.meet(self.centre, direction, np.asarray(self.setting.light))
            seen = near < nearest[rows]
            nearest[rows[seen]], image[rows[seen]], label[rows[seen]] = near[seen], lit[seen], 20 + number
        for x, z, radius in self.setting.glare:
            point = self.centre - self.centre[1] / direction[:, 1:2] * direction
            away = np.hypot(point[:, 0] - x, point[:, 2] - z)
            image = image + 400.0 * np.exp(-((away / radius) ** 4))
        return np.minimum(image, 255.0), label

    def _directions(self, pixels: Array) -> Array:
        x, y = ((p - c) / self.lens.focal for p, c in zip(pixels.T, self.lens.centre, strict=True))
        square = x**2 + y**2
        stretch = np.ones(len(pixels))
        for _ in range(6 if self.lens.k1 or self.lens.k2 else 0):
            now = square * stretch**2
            stretch = 1.0 / (1 + self.lens.k1 * now + self.lens.k2 * now**2)
        return np.column_stack([x * stretch, y * stretch, np.ones(len(x))]) @ self.axes

    def _paper(self, x: Array, z: Array) -> tuple[Array, NDArray[np.int64]]:
        s = self.setting
        across, up = (x - 40) / 100, (z - 10) / 100
        image = s.paper - s.uneven * (0.5 * across**2 + 0.8 * up**2 - 0.5 * across + 0.3 * across * up)
        label = np.zeros(len(x), np.int64)
        if s.board:
            i, j = (x - s.board_corner[0]) / s.square, (z - s.board_corner[1]) / s.square
            on = (i >= 0) & (i < s.squares[0]) & (j >= 0) & (j < s.squares[1])
            black = on & ((np.floor(i) + np.floor(j)) % 2 == 0)
            image[black] *= 0.18
            label[on] = 1
            label[black] = 2
        return image, label

    def _box(self, direction: Array, clamp: Clamp) -> tuple[Array, Array]:
        with np.errstate(divide="ignore", invalid="ignore"):
            a = (np.asarray(clamp.low) - self.centre) / direction
            b = (np.asarray(clamp.high) - self.centre) / direction
        near, far = np.minimum(a, b).T, np.maximum(a, b).T
        enter = np.maximum(np.maximum(near[0], near[1]), near[2])
        leave = np.minimum(np.minimum(far[0], far[1]), far[2])
        factor = np.where(near[0] == enter, 0.75, np.where(near[1] == enter, 1.0, 1.2))
        return np.where((enter < leave) & (enter > 0), enter, np.inf), clamp.shade * factor


class _Field:
    """Distance to a tube's axis on a grid of its plane, and sphere tracing against it."""

    CELL = 0.5

    def __init__(self, tube: Tube) -> None:
        self.tube = tube
        self.widest = float(np.max(tube.radius))
        self.low = tube.axis.min(axis=0) - 2.5 * self.widest
        size = np.ceil((tube.axis.max(axis=0) + 2.5 * self.widest - self.low) / self.CELL).astype(int) + 1
        grid = self.low + self.CELL * np.stack(np.meshgrid(*map(np.arange, size), indexing="ij"), -1)
        fine = _dense(tube.axis)
        _, nearest = cKDTree(fine).query(grid.reshape(-1, 2))
        start, end = fine[1] - fine[0], fine[-1] - fine[-2]
        offset = grid.reshape(-1, 2) - fine[nearest]
        # signed, so that it is smooth across the axis; cells past an end measure from the tangent
        tangent = np.gradient(fine, axis=0)[nearest]
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        across = tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]
        past = np.maximum(
            -(grid.reshape(-1, 2) - fine[0]) @ (start / np.linalg.norm(start)),
            (grid.reshape(-1, 2) - fine[-1]) @ (end / np.linalg.norm(end)),
        )
        near_end = (nearest < 20) | (nearest > len(fine) - 21)
        past = np.where(near_end, past, -5.0)
        self.tables = [across.reshape(size), np.maximum(past, -5.0).reshape(size)]
        if np.ndim(tube.radius):
            along = np.linspace(0.0, _arc(tube.axis)[-1], len(fine))
            self.tables.append(np.interp(along, _arc(tube.axis), tube.radius)[nearest].reshape(size))
        self.size = size
        self.slope = np.gradient(self.tables[0], self.CELL)
        outward = [-start / np.linalg.norm(start), end / np.linalg.norm(end)]
        self.ends = [np.concatenate([fine[0], outward[0]]), np.concatenate([fine[-1], outward[1]])]

    def _look(self, tables: Sequence[Array], x: Array, z: Array) -> list[Array]:
        """Bilinear values of tables at the same places, beyond the grid those of its rim.

        Most of a photograph's time: scipy's `map_coordinates`, a table at a time, takes twice as long.
        """
        u, v = ((w - low) / self.CELL for w, low in zip((x, z), self.low, strict=True))
        u, v = (np.clip(w, 0.0, n - 1) for w, n in zip((u, v), self.size, strict=True))
        i, j = (np.minimum(w.astype(np.int64), n - 2) for w, n in zip((u, v), self.size, strict=True))
        u, v, at, row = u - i, v - j, i * self.size[1] + j, self.size[1]
        found = []
        for table in tables:
            flat = table.ravel()
            one, other = flat.take(at), flat.take(at + row)
            one += v * (flat.take(at + 1) - one)
            other += v * (flat.take(at + row + 1) - other)
            found.append(one + u * (other - one))
        return found

    def _distances(self, x: Array, y: Array, z: Array) -> tuple[Array, Array]:
        """Distance to the round surface and to the ends' planes."""
        across, past, *radius = self._look(self.tables, x, z)
        return np.sqrt(across**2 + y**2) - (radius[0] if radius else self.widest), past

    def _normal(self, point: Array) -> Array:
        x, y, z = point.T
        across, *slopes = self._look((self.tables[0], *self.slope), x, z)
        normal = np.column_stack([slopes[0] * across, y, slopes[1] * across])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
        far = np.hypot(x - self.ends[0][0], z - self.ends[0][1]) > np.hypot(
            x - self.ends[1][0], z - self.ends[1][1]
        )
        round_part, past = self._distances(x, y, z)
        cut = np.abs(past) < np.abs(round_part)
        face = np.where(far[:, None], self.ends[1][2:], self.ends[0][2:])
        normal[cut] = np.column_stack([face[:, 0], np.zeros(len(face)), face[:, 1]])[cut]
        return normal

    def meet(self, centre: Array, direction: Array, light: Array) -> tuple[NDArray[np.int64], Array, Array]:
        """Indices of the rays that hit, the step along them, and the brightness there."""
        radius = self.widest
        enter = (-1.05 * radius - centre[1]) / direction[:, 1]
        leave = (1.05 * radius - centre[1]) / direction[:, 1]
        middle = centre + (0.5 * (enter + leave))[:, None] * direction
        high = self.low + self.CELL * (self.size - 1)
        flat = middle[:, [0, 2]]
        rows = np.flatnonzero(((flat > self.low) & (flat < high)).all(axis=1))
        rows = rows[np.abs(self._look(self.tables[:1], *flat[rows].T)[0]) < 1.8 * radius]
        step, end, speed = enter[rows], leave[rows], np.linalg.norm(direction[rows], axis=1)
        rays = np.ascontiguousarray(direction[rows].T)
        active = np.arange(len(rows))
        hit = np.zeros(len(rows), bool)

        def gap_at(t: Array, ray: Array) -> Array:
            return np.maximum(*self._distances(*(c + t * d for c, d in zip(centre, ray, strict=True))))

        for _ in range(40):
            gap = gap_at(step[active], rays[:, active])
            touch = gap < 1e-4
            hit[active[touch]] = True
            active, gap = active[~touch], gap[~touch]
            step[active] += 0.98 * gap / speed[active]
            active = active[step[active] < end[active]]
            if len(active) == 0:
                break
        graze = active  # sphere tracing creeps along the limb: closest approach, then bisection
        if len(graze):
            ray, low, high = rays[:, graze], step[graze], end[graze]
            part = 0.5 * (3.0 - 5.0**0.5)  # golden section: one of two places is that of the last turn
            a, b = low + part * (high - low), high - part * (high - low)
            at_a, at_b = gap_at(a, ray), gap_at(b, ray)
            for _ in range(22):
                left = at_a < at_b
                low, high = np.where(left, low, a), np.where(left, b, high)
                new = np.where(left, low + part * (high - low), high - part * (high - low))
                at_new = gap_at(new, ray)
                a, at_a, b, at_b = (
                    np.where(left, *pair) for pair in ((new, b), (at_new, at_b), (a, new), (at_a, at_new))
                )
            inside = 0.5 * (low + high)
            hit[graze] = gap_at(inside, ray) < 0.0
            outside = step[graze]
            for _ in range(16):
                middle_step = 0.5 * (outside + inside)
                within = gap_at(middle_step, ray) < 0.0
                inside, outside = (
                    np.where(within, middle_step, inside),
                    np.where(within, outside, middle_step),
                )
            step[graze] = inside
        rows, step = rows[hit], step[hit]
        point = centre + step[:, None] * direction[rows]
        normal = self._normal(point)
        facing = np.clip(normal @ (light / np.linalg.norm(light)), 0.0, None)
        bright = self.tube.shade * (0.55 + 0.45 * facing) + self.tube.gloss * facing**40
        return rows, step, bright


@lru_cache(maxsize=4)  # a tube hashes by its identity: one is photographed from several sides
def _field(tube: Tube) -> _Field:
    return _Field(tube)


def _dense(axis: Array) -> Array:
    length = _arc(axis)
    s = np.linspace(0.0, length[-1], int(length[-1] / 0.04))
    return np.column_stack([np.interp(s, length, axis[:, 0]), np.interp(s, length, axis[:, 1])])


def _arc(axis: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(axis, axis=0), axis=1))])
