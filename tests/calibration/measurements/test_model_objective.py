"""A measurement model as the objective of a fit: the model's chi-square, with each prior counted once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from _folders import coupon_entry, write_experiment
from numpy.typing import NDArray
from scipy.optimize import minimize

from calibration.experiment import read
from calibration.inference import Problem
from calibration.measurements._baseline import Baseline, Extra
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._state import State
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.homogeneous.stress import nominal_stress
from calibration.measurements.objective import ModelObjective
from calibration.parameters import parametrisation

Array = NDArray[np.float64]
LAW = parametrisation("neo-hookean")
READINGS = np.random.default_rng(4).standard_normal(6)


class Timed(MeasurementModel):
    """Six readings of ln(G / 1 kPa) exp(-t), t an extra coordinate; the last three are of another trial."""

    kind = "timed"

    def __init__(self, baseline: Baseline) -> None:
        self.records = [SimpleNamespace(material="S0", specimen="S0", name=n) for n in ("a", "b")]
        self.row_record = np.repeat([0, 1], 3)
        self.effects, self.candidates, self.visible = {}, (), {}
        self.baseline = baseline
        self.noise = Noise.independent(np.full(6, 0.1)).with_nuisances(np.ones((6, 1)), ["offset"])
        self.taken: list[float] = []

    def start(self) -> Array:
        return self.baseline.start({"S0": 1e4})

    def update_nuisances(self, state: State, *, rough: bool = False) -> None:
        if state.u[0] > 15.0:
            raise ValueError("no answer")
        assert not rough
        self.taken.append(float(state.u[0]))

    def _misfit(self, states: Sequence[State]) -> Array:
        shares = np.linspace(0.5, 1.5, 6)
        one = [shares * (s.u[0] - np.log(1e3)) * np.exp(-s.u[-1]) for s in states]
        return np.array(one) - (shares * 2.0 + 0.1 * READINGS)

    def _discrepancies(self) -> Mapping[str, Array]:
        return {}

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        return {"trial": ["a"] * 3 + ["b"] * 3}


def timed(model: type[Timed] = Timed) -> ModelObjective[Timed]:
    record = SimpleNamespace(material="S0", specimen="S0")
    baseline = Baseline.of_law([record], LAW).with_extras([Extra(name="t", sd=0.2, centre=0.1)])
    return ModelObjective(model(baseline), name="timed")


def test_extras_are_profiled_with_their_priors() -> None:
    """Chi-square at u is the model's minimum over the extra; the law's prior belongs to the problem."""
    objective = timed()
    u = np.log([9e3, 150.0])
    assert objective.linearise(u)

    def own(e: Array) -> float:
        z = objective.model.residuals([State(u=np.concatenate([u, e]))])[0]
        law = (u[1] - np.log(300.0)) / 1.1
        return float(z @ z - law**2)

    best = minimize(own, [0.0], tol=1e-10)
    (rows,) = objective.residuals(u[None])
    assert len(rows) == objective.size() == 7
    assert objective.points == 6
    assert objective.extras == pytest.approx(best.x, abs=0.02)
    assert rows @ rows == pytest.approx(best.fun, rel=1e-3)
    # and at another point, where the extra coordinate follows
    problem = Problem(parametrisation=LAW, objectives=(objective,))
    u = v = u + np.array([0.05, 0.0])
    assert problem.costs(v[None])[0] == pytest.approx(
        minimize(own, [0.0]).fun + ((v[1] - np.log(300.0)) / 1.1) ** 2, rel=0.01
    )


class Swinging(Timed):
    """Six readings of a swing whose measured amplitude is smaller than simulated, whatever G and t are."""

    def __init__(self, baseline: Baseline) -> None:
        super().__init__(baseline)
        self.noise = Noise.independent(np.full(6, 0.01))

    def _misfit(self, states: Sequence[State]) -> Array:
        time = np.linspace(0.5, 3.0, 6)
        one = [np.cos(time * (1.0 + 0.5 * (s.u[0] - np.log(1e4)) + s.u[-1])) for s in states]
        return np.array(one) - 0.7 * np.cos(time)


def test_extras_follow_a_modulus_that_moves() -> None:
    """A frequency is that of G and of an extra together: chi-square away from the point of `linearise` was
    below its minimum, since a swing out of phase, brought back to first order, is a smaller one."""
    objective = timed(Swinging)
    best = np.log([1e4, 300.0])
    assert objective.linearise(best)

    def profiled(u: Array) -> float:
        own = [objective.model.residuals([State(u=np.append(u, e))])[0] for e in np.linspace(-0.3, 0.3, 601)]
        return min(float(z @ z) for z in own)

    for step in (-0.2, 0.2):
        u = best + np.array([step, 0.0])
        (rows,) = objective.residuals(u[None])
        assert rows @ rows == pytest.approx(profiled(u), rel=0.01)  # 12 % too small where they stay behind
        assert objective.state(u).u[-1] - objective.extras[0] == pytest.approx(-0.5 * step, rel=0.02)


def test_no_answer_is_said_and_a_subset_keeps_what_was_taken() -> None:
    objective = timed()
    assert not objective.linearise(np.array([16.0, 5.7]))
    u = np.log([9e3, 300.0])
    assert objective.linearise(u)
    (_, first), _ = objective.model.folds()["trial"]
    part = objective.subset(first, others=True)
    assert (part.points, part.size()) == (3, 4)
    assert part.linearise(u + 1.0)
    assert part.model.taken == objective.model.taken
    assert part.extras == pytest.approx(objective.extras)
    assert np.isfinite(part.residuals(u[None])).all()
    assert set(objective.nuisances(u)) == {"offset"}


def test_a_model_of_specimens_is_refused() -> None:
    record = SimpleNamespace(material="S0", specimen="S0")
    model = Timed(Baseline.per_specimen([record], bulk_ratio=300.0))
    with pytest.raises(ValueError, match="timed: expected a model of one material"):
        ModelObjective(model, name="timed")


def test_coupons_are_whitened_stress(tmp_path: Path) -> None:
    """Stress residuals of all trials of a material, divided by the stated error."""
    s = np.linspace(1.05, 2.0, 20)
    pulls = {f"{k}.csv": {"stretch": s, "nominal_stress_kPa": k * (s - s**-2)} for k in (28.0, 31.0)}
    entries = [coupon_entry(f"pull-{n}", n, stress_sd_kPa=0.5, stretch_sd=0.0) for n in pulls]
    experiment = read(write_experiment(tmp_path, entries, tables=pulls))
    law = parametrisation("mooney-rivlin")
    model = HomogeneousModel(experiment, baseline=Baseline.of_law(experiment.trials, law))
    objective = ModelObjective(model, name="coupons")
    u = law.start(shear=3e4)
    assert objective.linearise(u)
    expected = [
        (nominal_stress(law.material(u), "uniaxial", s) - t["nominal_stress_kPa"] * 1e3) / 500.0
        for t in pulls.values()
    ]
    assert objective.residuals(u[None])[0] == pytest.approx(np.concatenate(expected), abs=1e-6)
    problem = Problem(parametrisation=law, objectives=(objective,))
    assert problem.residuals(u[None]).shape == (1, 41)
