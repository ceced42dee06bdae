"""Ray-cast photographs of known beams: a separate camera model (perspective, radial distortion), light, blur
and noise.

Frame as in docs/reference/experiment-format.md, in mm: x along the beam, z up, y away from the camera;
the board is at y = board_y.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, gaussian_filter, map_coordinates
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
        self.fields = [_Field(tube) for tube in setting.tubes]

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
        distorted = (pixels - self.lens.centre) / self.lens.focal
        plain = distorted.copy()
        for _ in range(6):
            square = plain[:, :1] ** 2 + plain[:, 1:] ** 2
            plain = distorted / (1 + self.lens.k1 * square + self.lens.k2 * square**2)
        return np.column_stack([plain, np.ones(len(plain))]) @ self.axes

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
        self.radius = None
        if np.ndim(tube.radius):
            along = np.linspace(0.0, _arc(tube.axis)[-1], len(fine))
            self.radius = np.interp(along, _arc(tube.axis), tube.radius)[nearest].reshape(size)
        self.across, self.past = across.reshape(size), np.maximum(past, -5.0).reshape(size)
        self.size = size
        self.slope = np.gradient(self.across, self.CELL)
        outward = [-start / np.linalg.norm(start), end / np.linalg.norm(end)]
        self.ends = [np.concatenate([fine[0], outward[0]]), np.concatenate([fine[-1], outward[1]])]

    def _look(self, table: Array, x: Array, z: Array) -> Array:
        at = np.array([(x - self.low[0]) / self.CELL, (z - self.low[1]) / self.CELL])
        return map_coordinates(table, at, order=1, mode="nearest")

    def _radius(self, x: Array, z: Array) -> Array | float:
        return self.widest if self.radius is None else self._look(self.radius, x, z)

    def _distance(self, point: Array) -> Array:
        x, z = point[:, 0], point[:, 2]
        round_part = np.hypot(self._look(self.across, x, z), point[:, 1]) - self._radius(x, z)
        return np.maximum(round_part, self._look(self.past, point[:, 0], point[:, 2]))

    def _normal(self, point: Array) -> Array:
        x, z = point[:, 0], point[:, 2]
        across, past = self._look(self.across, x, z), self._look(self.past, x, z)
        flat = np.stack([self._look(table, x, z) for table in self.slope], axis=1) * across[:, None]
        normal = np.column_stack([flat[:, 0], point[:, 1], flat[:, 1]])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
        far = np.hypot(x - self.ends[0][0], z - self.ends[0][1]) > np.hypot(
            x - self.ends[1][0], z - self.ends[1][1]
        )
        cut = np.abs(past) < np.abs(np.hypot(across, point[:, 1]) - self._radius(x, z))
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
        rows = rows[np.abs(self._look(self.across, flat[rows, 0], flat[rows, 1])) < 1.8 * radius]
        step, speed = enter[rows].copy(), np.linalg.norm(direction[rows], axis=1)
        active = np.arange(len(rows))
        hit = np.zeros(len(rows), bool)
        for _ in range(40):
            gap = self._distance(centre + step[active, None] * direction[rows[active]])
            touch = gap < 1e-4
            hit[active[touch]] = True
            active, gap = active[~touch], gap[~touch]
            step[active] += 0.98 * gap / speed[active]
            active = active[step[active] < leave[rows[active]]]
            if len(active) == 0:
                break
        graze = active  # sphere tracing creeps along the limb: closest approach, then bisection
        if len(graze):
            ray = direction[rows[graze]]

            def gap_at(t: Array) -> Array:
                return self._distance(centre + t[:, None] * ray)

            low, high = step[graze], leave[rows[graze]]
            for _ in range(22):
                a, b = low + 0.382 * (high - low), high - 0.382 * (high - low)
                left = gap_at(a) < gap_at(b)
                low, high = np.where(left, low, a), np.where(left, b, high)
            inside = 0.5 * (low + high)
            hit[graze] = gap_at(inside) < 0.0
            outside = step[graze]
            for _ in range(16):
                middle_step = 0.5 * (outside + inside)
                within = gap_at(middle_step) < 0.0
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


def _dense(axis: Array) -> Array:
    length = _arc(axis)
    s = np.linspace(0.0, length[-1], int(length[-1] / 0.04))
    return np.column_stack([np.interp(s, length, axis[:, 0]), np.interp(s, length, axis[:, 1])])


def _arc(axis: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(axis, axis=0), axis=1))])
