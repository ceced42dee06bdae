"""Cantilever releases, for tests of their diagnosis: a Timoshenko beam of linear finite elements, its modes
integrated with a viscoelastic material, written in the file format. No code is shared with calibration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _folders import Entry, beam_entry, write_experiment
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

Array = NDArray[np.float64]

LENGTH, WIDTH, HEIGHT, DENSITY, GRAVITY = 0.1, 0.02, 0.02, 1000.0, 9.81
ELEMENTS, MODES = 60, 3
CREEPS = 1e-3  # speed below which what rubs moves on slowly [m/s]
MARKERS = {  # x, y, z [mm]
    "top": (100.0, 0.0, 14.0),
    "left": (100.0, 12.0, -6.0),
    "right": (98.0, -12.0, 2.0),
    "base": (-4.0, 0.0, 16.0),
}


@dataclass(frozen=True, kw_only=True)
class Truth:
    """shear [Pa]: at rest, all relaxed. branches: (part of it, time [s]) besides. clamp [rad/Nm]. loose: part
    of the hung mass that does not move with the bar. rub: dry friction against the tip of a bar with a hung
    mass [N]. held: drop at which a bar without a hung mass is held, of where it settles. extra: a further
    height of the tip [m], by the time."""

    shear: float = 6e5
    viscous: float = 4e-4
    branches: Sequence[tuple[float, float]] = ()
    clamp: float = 0.0
    loose: float = 0.0
    rub: float = 0.0
    held: float = 0.0
    extra: Callable[[Array], Array] | None = None


def beam(truth: Truth, hung: float) -> tuple[Array, Array, Array]:
    """Stiffness, mass and load of a clamped bar with nodes (w, theta); the root's rotation is free on a
    spring."""
    young, area, inertia = 3.0 * truth.shear, WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
    sheared = 10.0 * 1.5 / (12.0 + 11.0 * 0.5)
    n, h = ELEMENTS + 1, LENGTH / ELEMENTS
    stiff, mass, load = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    bend = young * inertia / h * np.array([[0, 0, 0, 0], [0, 1, 0, -1], [0, 0, 0, 0], [0, -1, 0, 1.0]])
    slip = np.array([-1.0 / h, -0.5, 1.0 / h, -0.5])  # shear strain in the middle: one point, no locking
    part = h * np.array([[1 / 3, 1 / 6], [1 / 6, 1 / 3]])
    for e in range(ELEMENTS):
        at = slice(2 * e, 2 * e + 4)
        stiff[at, at] += bend + sheared * truth.shear * area * h * np.outer(slip, slip)
        for offset, line in ((0, DENSITY * area), (1, DENSITY * inertia)):
            where = np.array([2 * e + offset, 2 * e + 2 + offset])
            mass[np.ix_(where, where)] += line * part
        load[[2 * e, 2 * e + 2]] -= 0.5 * h * DENSITY * area * GRAVITY
    moving = (1.0 - truth.loose) * hung
    mass[-2, -2] += moving
    mass[-1, -1] += moving * HEIGHT**2 / 12.0  # spread over the face
    load[-2] -= hung * GRAVITY
    stiff[1, 1] += 1.0 / truth.clamp if truth.clamp else 1e9
    return stiff[1:, 1:], mass[1:, 1:], load[1:]


def swing(truth: Truth, hung: float, time: Array, *, start: float = 0.0) -> Array:
    """Nodes (t, n, 2) of w and theta at times since the release (0 before it), let go from `start` times
    where it settles."""
    stiff, mass, load = beam(truth, hung)
    squares, shapes = eigh(stiff, mass)
    rest = np.linalg.solve(stiff, load)
    whole = shapes.T @ mass @ rest  # of each mode, where it settles
    parts = np.array([p for p, _ in truth.branches])
    times = np.array([t for _, t in truth.branches])
    b = len(parts)

    at_tip = shapes[-2, :MODES]
    friction = truth.rub if hung else 0.0

    def rate(_: float, state: Array) -> Array:
        y, v, memory = state[:MODES], state[MODES : 2 * MODES], state[2 * MODES :].reshape(b, MODES)
        k = squares[:MODES]
        pull = y + truth.viscous * v + parts @ (y - memory)
        rubs = friction * np.tanh(at_tip @ v / CREEPS)
        return np.concatenate(
            [v, k * (whole[:MODES] - pull) - rubs * at_tip, ((y - memory) / times[:, None]).ravel()]
        )

    first = np.concatenate([start * whole[:MODES], np.zeros(MODES), np.tile(start * whole[:MODES], b)])
    after = time[time > 0.0]
    found = solve_ivp(
        rate, (0.0, float(after[-1])), first, method="LSODA", t_eval=after, rtol=1e-8, atol=1e-12
    )
    quick = rest - shapes[:, :MODES] @ whole[:MODES]  # higher modes follow at once
    nodes = np.zeros((len(time), len(rest) + 1))
    below = 0.0 if hung else truth.held
    nodes[time > 0.0, 1:] = found.y[:MODES].T @ shapes[:, :MODES].T + quick - below * rest
    return nodes.reshape(len(time), -1, 2)


def moved(nodes: Array, at: tuple[float, float, float], *, on_clamp: bool) -> Array:
    """Displacement (t, 2) in x and z [m] of a marker on a stalk, to second order of the slopes."""
    x, _, z = (1e-3 * v for v in at)
    places = np.linspace(0.0, LENGTH, ELEMENTS + 1)
    if on_clamp:
        theta = nodes[:, 0, 1]
        return np.column_stack([-z * theta - 0.5 * x * theta**2, x * theta - 0.5 * z * theta**2])
    w = np.array([np.interp(x, places, row) for row in nodes[:, :, 0]])
    theta = np.array([np.interp(x, places, row) for row in nodes[:, :, 1]])
    slope = np.diff(nodes[:, :, 0], axis=1) / np.diff(places)
    inside = np.clip(x - places[:-1], 0.0, np.diff(places))
    short = -0.5 * (slope**2) @ inside
    return np.column_stack([short - z * np.sin(theta), w + z * (np.cos(theta) - 1.0)])


def write_bars(
    folder: Path,
    truth: Truth,
    *,
    hung: Sequence[float] = (0.0, 0.01),
    seconds: float = 1.6,
    rate: float = 200.0,
    sd_mm: float = 0.02,
    seed: int = 0,
    **changed: object,
) -> Path:
    """An experiment with one trial for each hung mass [kg]: bars let go 20 ms or so after the record begins,
    frames turned by up to a degree, markers half a millimetre off; changed: keys of all trials."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * rate)) / rate
    trials: list[Entry] = []
    tables = {}
    off = {name: 0.5 * rng.standard_normal(3) for name in MARKERS}
    for k, mass in enumerate(hung):
        since = time - (0.02 + rng.uniform(0.0, 1.0 / rate))
        nodes = swing(truth, mass, since, start=rng.uniform(0.0, 0.1))
        angle = np.radians(rng.uniform(-1.0, 1.0))
        columns: dict[str, list[object]] = {c: [] for c in ("marker", "time_s", "ux_mm", "uy_mm", "uz_mm")}
        for name, at in MARKERS.items():
            where = tuple(np.array(at) + off[name])
            u = 1e3 * moved(nodes, where, on_clamp=at[0] < 0.0)
            if truth.extra is not None and name != "base":
                u[:, 1] += 1e3 * truth.extra(np.maximum(since, 0.0)) * (since > 0.0)
            turned = u @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            seen = turned + sd_mm * rng.standard_normal(u.shape)
            columns["marker"] += [name] * len(time)
            columns["time_s"] += time.tolist()
            columns["ux_mm"] += seen[:, 0].tolist()
            columns["uy_mm"] += [0.0] * len(time)
            columns["uz_mm"] += seen[:, 1].tolist()
        entry = beam_entry(
            f"run-{k}",
            section={"rectangle": {"width_mm": 1e3 * WIDTH, "height_mm": 1e3 * HEIGHT}},
            free_length_mm=1e3 * LENGTH,
            grip_length_mm=10.0,
            supports="clamped-free",
            gravity_m_s2=[0.0, 0.0, -GRAVITY],
            tip_force_N=[0.0, 0.0, -mass * GRAVITY],
            markers=f"run-{k}.csv",
            marker_sd_mm=sd_mm,
            marker_positions_mm={name: list(at) for name, at in MARKERS.items()},
        )
        trials.append({**entry, **changed})
        tables[f"run-{k}.csv"] = columns
    material = {"density_kg_m3": DENSITY, "density_sd_kg_m3": 0.0}
    return write_experiment(folder, trials, tables=tables, materials={trials[0]["material"]: material})
