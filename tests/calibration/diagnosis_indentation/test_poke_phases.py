"""Strokes and holds of records with noisy depths are separated at the right samples."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from poke_records import trial

from calibration.measurements.indentation import _phases
from calibration.measurements.indentation._phases import phases_of

SAMPLES, TOP = 45, 0.4e-3  # samples per stroke; maximum depth [m]
NOISE = 2e-5  # a twentieth of the stroke, so that ends of strokes and holds are its extremes

PROTOCOLS = {
    "up and down": [("loading 1", TOP), ("unloading 1", 0.0)],
    "held": [("loading 1", TOP), ("hold 1", TOP), ("unloading 1", 0.0)],
    "held at the end": [("loading 1", TOP), ("hold 1", TOP)],
    "twice": [("loading 1", TOP), ("unloading 1", 0.0), ("loading 2", TOP), ("unloading 2", 0.0)],
}


def record(protocol: str) -> tuple[np.ndarray, np.ndarray, list[int]]:
    """Time, noise-free depth, and the ends of the phases; the sampling of a hold becomes sparser."""
    time, depth, ends = [np.zeros(1)], [np.zeros(1)], []
    for name, to in PROTOCOLS[protocol]:
        hold = name.startswith("hold")
        part = np.arange(1, (SAMPLES // 2 if hold else SAMPLES) + 1)
        part = part / part.size
        at, now = depth[-1][-1], time[-1][-1]
        time.append(now + (15.0 * part**2 if hold else part))
        depth.append(at + (to - at) * part)
        ends.append(sum(d.size for d in depth))
    return np.concatenate(time), np.concatenate(depth), ends


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_noisy_shallow_record_is_cut_where_it_is(protocol: str) -> None:
    """At most one record in a hundred is separated differently.

    No hold is invented at a reversal, none is lost, and the points of a phase lie on its line within the
    noise.
    """
    time, depth, ends = record(protocol)
    wrong = []
    for seed in range(100):
        noise = NOISE * np.random.default_rng(seed).standard_normal(depth.size)
        found = phases_of(trial("p", time, depth + noise, 1e3 * depth, depth_sd=NOISE))
        assert [p.points.start for p in found[1:]] == [p.points.stop for p in found[:-1]]
        names = [p.label for p in found]
        if names != [name for name, _ in PROTOCOLS[protocol]]:
            wrong.append((seed, names))
            continue
        first = 0
        for p, end in zip(found, ends, strict=True):
            mine = slice(first, end)
            line = np.polynomial.Polynomial.fit(time[mine], depth[mine], 1)(time)
            off = np.abs(line - depth)[p.points].max()
            if off > 3.5 * NOISE:
                wrong.append((seed, [f"{p.label} off by {off / NOISE:.1f}"]))
                break
            first = end - 1
    assert len(wrong) <= 1, wrong


def test_a_record_of_few_samples_is_cut_too() -> None:
    """Around a hold of so few samples no turning point can be fitted: the hold stays."""
    time = np.array([0.0, 1.0, 6.0, 11.0, 12.0, 32.0, 33.0, 33.1, 53.1])
    depth = np.array([0.0, 0.013, 0.284, 0.21, 0.011, 0.028, 0.164, 0.099, 0.082]) * 1e-3
    found = phases_of(trial("p", time, depth, 1e3 * depth, depth_sd=NOISE))
    assert found[0].points.start == 0
    assert found[-1].points.stop == time.size
    assert [p.points.start for p in found[1:]] == [p.points.stop for p in found[:-1]]


@pytest.mark.parametrize("samples", [3001, 20_000])
def test_many_noisy_samples_are_cut_as_few_are(samples: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Noise turns a long record around more often, and hides a corner among its few nearest samples; each of
    the possible corners costs all samples."""
    work: list[int] = []
    whole = _phases._bent_misfit

    def counted(time: np.ndarray, *rest: Any) -> float:
        work.append(time.size)
        return whole(time, *rest)

    monkeypatch.setattr(_phases, "_bent_misfit", counted)
    time = np.linspace(0.0, 30.0, samples)
    depth = np.interp(time, [0.0, 5.0, 25.0, 30.0], [0.0, TOP, TOP, 0.0])
    noisy = depth + NOISE * np.random.default_rng(samples).standard_normal(samples)
    found = phases_of(trial("p", time, noisy, 1e3 * depth, depth_sd=NOISE))
    assert [p.label for p in found] == ["loading 1", "hold 1", "unloading 1"]
    assert (found[0].points.start, found[-1].points.stop) == (0, samples)
    assert [p.points.start for p in found[1:]] == [p.points.stop for p in found[:-1]]
    assert [time[p.points.start] for p in found[1:]] == pytest.approx([5.0, 25.0], abs=0.3)
    assert sum(work) < 1e6
