"""The homogeneous model in the search: residuals, noise, specimens, folds, errors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_coupon_cases import G, coupon_model, experiment, neo_hookean, ramps, trial

from calibration.diagnosis.engine.fitting import fit
from calibration.errors import InputError
from calibration.experiment import Experiment
from calibration.measurements._state import State
from calibration.measurements.homogeneous.model import HomogeneousModel


def specimens() -> HomogeneousModel:
    trials = [
        trial("t1", "uniaxial", ramps(2.0, 1), specimen="one", seed=1),
        trial("t2", "planar", ramps(1.8, 1), lambda m, s: 1.2 * neo_hookean(m, s), specimen="two", seed=2),
        trial("t3", "uniaxial", ramps(2.0, 1), material="B", seed=3),
    ]
    return coupon_model(experiment(*trials))


def test_residuals_of_the_right_model_are_standard_normal() -> None:
    trials = [
        trial(f"t{k}", mode, ramps(1.6, 2, 60), stretch_sd=0.001, seed=k)
        for k, mode in enumerate(("uniaxial", "equibiaxial", "planar", "simple-shear"))
    ]
    model = coupon_model(experiment(*trials))
    z = model.residuals([State(u=np.array([np.log(G)]))])[0]
    assert z.size == model.points == 4 * 119
    assert z.std() == pytest.approx(1.0, abs=0.12)
    assert abs(z.mean()) < 0.2


def test_long_records_are_thinned_without_losing_what_they_say() -> None:
    long = coupon_model(experiment(trial("t", "uniaxial", np.linspace(1.0, 2.0, 5000), sd=2e3)))
    assert long.points == 100
    found = fit(long, State(u=long.start()))
    sd = float(np.sqrt(found.covariance()[0, 0]))
    raw = np.linspace(1.0, 2.0, 5000)
    stated = 2e3 / np.linalg.norm(neo_hookean("uniaxial", raw))  # Fisher information of ln G
    assert sd == pytest.approx(stated, rel=0.02)
    assert abs(found.state.u[0] - np.log(G)) < 4.0 * sd


def test_specimens_have_moduli_of_their_own_near_each_other() -> None:
    model = specimens()
    assert model.names == ("one", "two", "B")
    found = fit(model, State(u=model.start()))
    assert found.converged
    assert np.exp(found.state.u) == pytest.approx([G, 1.2 * G, G], rel=0.01)
    assert model.shear_moduli(found.state.u) == pytest.approx({"A": G * 1.2**0.5, "B": G}, rel=0.01)
    scatter = model.residuals([found.state])[0][model.points :]  # 15 % per specimen
    apart = (found.state.u[1] - found.state.u[0]) / 2.0 / 0.15
    assert float(scatter @ scatter) == pytest.approx(2.0 * apart**2)
    assert scatter.size == 1  # the mean of the two is free


def test_another_law_has_its_coordinates() -> None:
    model = coupon_model(
        experiment(trial("t1", "uniaxial", ramps(2.0, 1)), trial("t2", "planar", ramps(1.8, 1))),
        law="mooney-rivlin",
    )
    assert model.names == ("A", "A second_share")
    found = fit(model, State(u=model.start()))
    assert found.converged
    assert np.exp(found.state.u[0]) == pytest.approx(G, rel=0.02)
    assert found.state.u[1] == pytest.approx(0.0, abs=0.1)
    assert model.baseline.material("A", found.state.u).law == "mooney-rivlin"


def test_errors_that_the_lab_does_not_state_are_estimated_and_said_so() -> None:
    rough = np.random.default_rng(5).standard_normal(80)
    stretch = np.linspace(1.0, 2.0, 80)
    clean = neo_hookean("uniaxial", stretch)
    model = coupon_model(experiment(trial("t", "uniaxial", stretch, clean * (1.0 + 0.02 * rough), sd=None)))
    relative = model.records[0].sd[20:] / clean[20:]
    assert np.median(relative) == pytest.approx(0.02, rel=0.4)
    assert "states no error of the stress of t" in model.remarks()[0]
    stated = coupon_model(experiment(trial("t", "uniaxial", stretch)))
    assert stated.remarks() == []


def test_one_loop_is_said_to_tell_two_things() -> None:
    model = coupon_model(experiment(trial("t", "uniaxial", ramps(1.8, 2))))
    assert "one loop cannot tell hysteresis" in model.remarks()[0]


def test_derivatives_are_those_of_the_residuals() -> None:
    model = specimens()
    here = State(u=np.log([4e4, 6e4, 5e4]))
    candidates = [c for c in model.candidates if c.effect in ("strain-offset", "machine-compliance")]
    linear = model.linearise(here, candidates)
    step = np.array([1e-3, -2e-3, 1e-3])
    moved = model.residuals([State(u=here.u + step)])[0]
    assert moved - linear.z == pytest.approx(linear.by_u @ step, abs=2e-3 * np.abs(linear.z).max())
    small = {c: 1e-4 if c.effect == "strain-offset" else 1e-9 for c in candidates}
    moved = model.residuals([State(u=here.u, amplitudes=small)])[0]
    expected = linear.columns @ np.array([small[c] for c in candidates])
    assert moved - linear.z == pytest.approx(expected, abs=0.02 * np.abs(expected).max())


def test_folds_part_the_points_and_keep_the_coordinates() -> None:
    model = specimens()
    families = model.folds()
    assert list(families) == [
        "leave-one-mode-out",
        "leave-one-material-out",
        "leave-one-trial-out",
        "leave-one-fifth-out",
    ]
    for groups in families.values():
        rows = [model.rows(group) for _, group in groups]
        assert np.sum(rows, axis=0).tolist() == [1] * model.points + [0]
        for _, group in groups:
            mine, others = model.subset(group, others=False), model.subset(group, others=True)
            assert mine.points + others.points == model.points
            assert mine.names == model.names
    by_trial = dict(families["leave-one-trial-out"])
    assert model.unconstrained(by_trial["t2"]).tolist() == [False, True, False]
    assert model.unconstrained(by_trial["t3"]).tolist() == [False, False, True]
    state = State(u=np.log([G, G, G]))
    part = model.subset(by_trial["t2"], others=False)
    assert part.distance_rms(state) == pytest.approx(0.2 / 1.2 * 0.66 * 1.8 * G, rel=0.3)
    assert part.noise_rms() == pytest.approx(200.0)


def test_turns_are_found_through_noise() -> None:
    cycles = ramps(1.5, 4, 50)
    noisy = trial("t", "uniaxial", cycles, stretch_sd=0.003)
    record = coupon_model(experiment(noisy)).records[0]
    assert np.unique(record.branch).size == 4
    unloading = np.isfinite(record.turn)
    assert unloading.sum() == pytest.approx(98, abs=6)
    assert record.reloaded
    assert record.rate == pytest.approx(0.01, rel=0.05)
    sorted_curve = trial("s", "uniaxial", np.linspace(0.6, 2.0, 60), rate=None)  # through rest: no loop
    assert not coupon_model(experiment(sorted_curve)).records[0].unloads


def test_bad_input_is_said_in_one_sentence() -> None:
    nothing = Experiment(name="n", folder=Path("n"), notes="", materials={}, trials=(), digest="0" * 64)
    with pytest.raises(InputError, match="expected a coupon"):
        coupon_model(nothing)
    good = trial("t", "uniaxial", ramps(1.5, 1))
    with pytest.raises(ValueError, match="falls with its stretch"):
        coupon_model(experiment(replace(good, stress=-good.stress))).start()
    with pytest.raises(ValueError, match="expected one of"):
        coupon_model(experiment(good), law="jelly")
