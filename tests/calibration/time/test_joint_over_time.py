"""A homogeneous test and an indentation in one fit over time.

The indentation is that of a ball on a half-space by the hereditary integral, with Hertz's elastic curve in
place of simulations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from test_kinds_over_time import experiment, poke
from timed_coupons import REST, trial

from benchmarks.blind.timed.cases import draw_indentation, write
from benchmarks.blind.timed.indentation import load
from benchmarks.blind.timed.material import Prony, Solid
from calibration.experiment import read
from calibration.experiment.model import PokeTrial
from calibration.inference import Problem, guess, identify, polish
from calibration.measurements.indentation._curve import FLAT, Curve
from calibration.measurements.indentation._curve_cache import CurveCache, CurveRequest
from calibration.parameters import parametrisation
from calibration.study import parts
from calibration.study.measurements import measurements

Array = NDArray[np.float64]
SHEAR = 2e4
PRONY = Prony(fractions=(0.4, 0.25), times=(1.5, 40.0))
RADIUS = 4e-3
TRUTH = {
    "shear_modulus": SHEAR,
    "prony_fraction_1": 0.4,
    "prony_time_1": 1.5,
    "prony_fraction_2": 0.25,
    "prony_time_2": 40.0,
}


def hertz(depth: Array) -> Array:
    """Force over the shear modulus of an incompressible half-space [m2]."""
    return np.asarray(16.0 / 3.0 * np.sqrt(RADIUS) * np.maximum(depth, 0.0) ** 1.5)


def straight(depth: NDArray[np.float64], along: NDArray[np.float64], *, round_tip: bool) -> Curve:
    """Elastic curve without a force across, beyond all depths of the records."""
    return Curve(
        depth=depth,
        along=along,
        across=np.zeros((len(depth), 2)),
        reached=2e-3,
        finer=2e-3,
        round_tip=round_tip,
        status="converged",
        core_seconds=0.0,
    )


def simulated(self: CurveCache, requests: Sequence[CurveRequest]) -> list[Curve]:
    del self
    depth = np.linspace(2e-5, 1.5e-3, 60)
    return [straight(depth, hertz(depth), round_tip=True) for _ in requests]


def pushed() -> PokeTrial:
    """Indentation to 0.5 mm, a hold, to 1 mm, a longer hold."""
    made = poke(ramp=1.0, hold=1.0)
    time = np.concatenate([np.arange(0.0, 8.0, 0.1), np.arange(8.0, 130.0, 0.5)])
    corners = ([0.0, 1.0, 6.0, 7.0, 130.0], [0.0, 0.5e-3, 0.5e-3, 1e-3, 1e-3])
    fine = np.linspace(0.0, 7.0, 14001)
    elastic = hertz(np.interp(fine, *corners))
    middle, change = 0.5 * (fine[1:] + fine[:-1]), np.diff(elastic)
    force = hertz(np.interp(time, *corners))
    for fraction, tau in zip(PRONY.fractions, PRONY.times, strict=True):
        since = time[:, None] - middle
        force = force + fraction * np.where(since > 0.0, np.exp(-np.maximum(since, 0.0) / tau), 0.0) @ change
    force = SHEAR * force
    sd = 0.004 * float(force.max())
    noise = sd * np.random.default_rng(4).standard_normal(time.size)
    record = replace(made.record, time=time, depth=np.interp(time, *corners), force=force + noise)
    return replace(made, record=record, force_sd=sd)


def flat(self: CurveCache, requests: Sequence[CurveRequest]) -> list[Curve]:
    """Elastic curve of a flat indenter from the loading in the laboratory's own finite elements."""
    del self
    step = load()["thick, hold"]
    time, force = np.array(step["time"]), np.array(step["force"])
    piece, prony = step["push"]["course"]["pieces"][0], step["push"]["prony"]
    loading = time <= piece["duration"] * (1.0 + 1e-9)
    depth = np.linspace(2e-5, piece["to"], 60)
    at_once = 1.0 + sum(prony["fractions"])
    along = PchipInterpolator(
        piece["to"] * time[loading] / piece["duration"], (force[loading] / at_once) ** (1.0 / FLAT)
    )(depth)
    return [straight(depth, along**FLAT, round_tip=False) for _ in requests]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_retraction_does_not_spoil_the_relaxation(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, seed: int
) -> None:
    """A flat indenter of other code is pushed, held and retracted, at finite strain and with friction."""
    monkeypatch.setattr(CurveCache, "fetch", flat)
    case = draw_indentation(seed)
    write(replace(case, pokes=tuple(p for p in case.pokes if p.base == "thick")), tmp_path / "e")
    own = read(tmp_path / "e")
    law = parts.with_parts(parametrisation("neo-hookean"), ("prony:2",), own, "M")
    data = measurements(own, "M", law, workers=1)
    problem = Problem(parametrisation=data.law.holding("bulk_ratio"), objectives=data.objectives)
    start = guess(problem)
    assert start is not None
    end = polish(problem, start, max_steps=40)
    chi2 = float(end.residuals @ end.residuals) / problem.points
    known = identify(problem.parametrisation, end.u, end.jacobian, reduced_chi2=chi2)
    assert case.solid.prony is not None
    (f1, f2), (t1, t2) = case.solid.prony.fractions, case.solid.prony.times
    truth = {
        "shear_modulus": case.solid.shear_modulus,
        "prony_fraction_1": f1,
        "prony_time_1": t1,
        "prony_fraction_2": f2,
        "prony_time_2": t2,
    }
    found = {e.name: e for e in known.estimates}
    assert all(found[name].low <= value <= found[name].high for name, value in truth.items())
    assert chi2 < 1.2


def test_both_together_find_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(CurveCache, "fetch", simulated)
    solid = Solid(mu=(SHEAR,), alpha=(2.0,), prony=PRONY)
    pulled = trial("c", "uniaxial", REST.ramp(1.3, 0.1).hold(20.0), solid=solid, noise=0.005, seed=3)
    found = {}
    for name, trials in {"poke": (pushed(),), "both": (pushed(), pulled)}.items():
        own = experiment(*trials)
        parts.check(own, ["M"], ("prony:2",))
        law = parts.with_parts(parametrisation("neo-hookean"), ("prony:2",), own, "M")
        data = measurements(own, "M", law, workers=1)
        assert len(data.objectives) == len(trials)
        problem = Problem(parametrisation=data.law, objectives=data.objectives)
        start = guess(problem)
        assert start is not None
        end = polish(problem, start, max_steps=40)
        chi2 = float(end.residuals @ end.residuals) / problem.points
        assert 0.7 < chi2 < 1.3
        known = identify(data.law, end.u, end.jacobian, reduced_chi2=chi2)
        found[name] = {e.name: e for e in known.estimates}
        inside = [found[name][p].low <= truth <= found[name][p].high for p, truth in TRUTH.items()]
        assert sum(inside) >= len(inside) - 1
        for p, truth in TRUTH.items():
            assert found[name][p].value == pytest.approx(truth, rel=0.15), (name, p)
    width = {n: np.log(e["shear_modulus"].high / e["shear_modulus"].low) for n, e in found.items()}
    assert width["both"] < 0.6 * width["poke"]  # all forces of an indenter share the mesh error
