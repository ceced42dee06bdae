"""Causes of the second round, tested if the usual ones do not explain the data, on data of other code."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_coupon_cases import Array, G, coupon_model, experiment, neo_hookean, ramps, trial

from benchmarks.blind.coupons.cases import make_coupon, write
from benchmarks.blind.coupons.model import FURTHER
from calibration import api
from calibration.diagnosis.catalogue import effects_of
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.held_out import held_out_improvement
from calibration.diagnosis.engine.search import search
from calibration.diagnosis.laws import LawChoice, LawScore, choose_law, law_of
from calibration.errors import InputError
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State
from calibration.measurements.homogeneous._record import _alike
from calibration.measurements.homogeneous.model import HomogeneousModel
from calibration.measurements.homogeneous.stress import nominal_stress
from tisim import Material

SIGMAS = 60.0


# with three usual causes that imitate one, all sets of three are tried: 9 core-s
DEAR = "tension-compression-asymmetry"


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n == DEAR else n for n in FURTHER]
)
def test_each_is_named_where_no_usual_cause_explains_alone(tmp_path: Path, name: str) -> None:
    case = make_coupon(3, "one", name, target=SIGMAS)
    write(case, tmp_path / "made")
    found = api.diagnose(tmp_path / "made", law="neo-hookean", gain=False)
    assert found.verdict == "found"
    (cause,) = found.causes
    assert cause["effect"] == name
    (value,) = cause["parameters"].values()
    truth = found.diagnosis.effects[name].in_file(case.hidden[0].amplitude)
    assert value["value"] == pytest.approx(truth, abs=4.0 * value["sd"])


def test_the_usual_causes_are_asked_alone_first(tmp_path: Path) -> None:
    write(make_coupon(5, "one", "strain-stiffening", target=20.0), tmp_path / "made")
    found = api.diagnose(tmp_path / "made", gain=False)
    assert not any(e.further for e in found.model.effects.values())
    assert found.causes[0]["effect"] == "strain-stiffening"


# -- relaxation --


def relaxing(stretch: Array, time: Array, *, fraction: float, tau: float) -> Array:
    """Boltzmann's integral on a fine grid with linear interpolation between the points."""
    fine = np.linspace(time[0], time[-1], 40001)
    elastic = neo_hookean("uniaxial", np.interp(fine, time, stretch))
    step = fine[1] - fine[0]
    rate = np.gradient(elastic, step)
    remembered = np.zeros(fine.size)
    kept, half = np.exp(-step / tau), np.exp(-0.5 * step / tau)
    for k in range(1, fine.size):
        remembered[k] = kept * remembered[k - 1] + half * step * 0.5 * (rate[k] + rate[k - 1])
    found = (1.0 - fraction) * elastic + fraction * remembered
    return np.interp(time, fine, found)


def test_a_hold_shows_the_relaxation_time() -> None:
    time = np.concatenate([np.linspace(0.0, 2.0, 40), np.geomspace(2.2, 100.0, 40)])
    stretch = np.minimum(1.0 + 0.25 * time, 1.5)
    stress = relaxing(stretch, time, fraction=0.3, tau=10.0)
    made = trial("hold", "uniaxial", stretch, stress, rate=None)
    model = coupon_model(experiment(replace(made, time=time)), further=True)
    best = search(model).explanations[0]
    (cause,) = best.candidates
    assert (cause.effect, cause.variant) == ("relaxation", 10.0)
    value, sd = best.fit.amplitude(cause)
    assert value == pytest.approx(0.3, abs=max(3.0 * sd, 0.01))
    assert model.shear_moduli(best.fit.state.u)["A"] == pytest.approx(G, rel=0.01)


# -- from test to test --


def pressed_again(strain_of: Callable[[Array, int], Array], factor: float) -> list[Array]:
    """Stress of three tests of one specimen, by the index of the test."""
    strain = np.linspace(0.0, 0.4, 30)
    return [(1.0 + factor * k) * neo_hookean("uniaxial", 1.0 - strain_of(strain, k)) for k in range(3)]


@pytest.mark.parametrize(
    ("name", "amplitude", "strain_of", "factor"),
    [
        ("set-between-tests", 0.004, lambda strain, k: strain / (1.0 - 0.004 * k), 0.0),
        ("test-order", 0.01, lambda strain, _: strain, 0.01),
    ],
)
def test_what_goes_on_from_test_to_test(
    name: str, amplitude: float, strain_of: Callable[[Array, int], Array], factor: float
) -> None:
    wanted = pressed_again(strain_of, factor)
    stretch = 1.0 - np.linspace(0.0, 0.4, 30)
    trials = [trial(f"A{k}", "uniaxial", stretch, w, sd=20.0, seed=k) for k, w in enumerate(wanted)]
    model = coupon_model(experiment(*trials), further=True)
    assert [(r.earlier, r.alike) for r in model.records] == [(0, 3), (1, 3), (2, 3)]
    # a test of unknown rate is no repeat of one of known rate, whichever comes first
    untimed = replace(model.records[0], rate=np.full_like(model.records[0].rate, np.nan))
    assert not _alike(untimed, model.records[1])
    assert not _alike(model.records[1], untimed)
    found = model.stresses(State(u=np.full(1, np.log(G)), amplitudes={Candidate(effect=name): amplitude}))
    for stress, w in zip(found, wanted, strict=True):
        assert stress == pytest.approx(w, rel=2e-3, abs=1e-6 * G)
    best = search(model).explanations[0]
    assert best.names == (name,)
    # two equal tests do not identify it, nor do tests of different range
    assert not any(
        v for c, v in coupon_model(experiment(*trials[:2]), further=True).visible.items() if c.effect == name
    )


# -- the law's form --


def of_ogden(mode: str, s: Array) -> Array:
    """Two Ogden terms by tisim's own law: the test is about the choice among laws."""
    made = Material(law="ogden", parameters={"mu": (3e4, 4e2), "alpha": (1.6, 6.0), "bulk": 2e8})
    return nominal_stress(made, mode, s)  # type: ignore[arg-type]


def score(label: str, constants: int, held_out: float) -> LawScore:
    return LawScore(
        law=label, terms=1, label=label, constants=constants, chi2=1.0, held_out=held_out, rms=1.0
    )


def test_a_richer_law_is_taken_only_where_it_predicts_better() -> None:
    plain, one, two = score("plain", 0, 100.0), score("one", 1, 40.0), score("two", 3, 30.0)
    assert LawChoice(scores=(plain, one, two), folds="fifths", points=50).best is one
    assert LawChoice(scores=(plain, score("one", 1, 95.0)), folds="fifths", points=50).best is plain
    said = LawChoice(scores=(plain, one), folds="fifths", points=50).sentence()
    assert "one was taken, which is worth 60% of what plain leaves" in said


def test_laws_are_named_on_the_command_line() -> None:
    assert law_of("ogden:2") == ("ogden", 2)
    assert law_of("neo-hookean") == ("neo-hookean", 1)
    for wrong in ("hooke", "ogden:x", "ogden:7"):
        with pytest.raises(InputError, match=f"--law {wrong}: expected auto"):
            law_of(wrong)


def test_the_law_that_the_data_bear_is_a_cause_of_its_own() -> None:
    made = experiment(
        *(
            trial(mode, mode, ramps(top, 1, 25), of_ogden, sd=400.0, seed=k)  # type: ignore[arg-type]
            for k, (mode, top) in enumerate((("uniaxial", 3.0), ("equibiaxial", 2.0), ("planar", 2.5)))
        )
    )
    model = HomogeneousModel(made, effects=effects_of("homogeneous"), richer=("ogden", 2))  # type: ignore[arg-type]
    (label,) = {c.label for c in model.candidates if c.effect == "law-form" and c.at == "all"}
    assert label == "law-form (ogden-2)"
    form = next(c for c in model.candidates if c.effect == "law-form" and c.at == "all")
    plain = fit(model, State(u=model.start()))
    found = fit(model, State(u=plain.state.u, amplitudes={form: 1.0}), (form,))
    assert plain.chi2 > 20.0 * found.chi2
    assert found.chi2 < 2.0 * model.points
    assert found.state.amplitudes[form] == 1.0  # present or absent, no value in between
    assert model.brings(form) == 3
    assert model.brings(Candidate(effect="second-invariant")) == 0


def test_a_constant_ends_at_its_bound_and_the_fit_with_it() -> None:
    """The lower bound of Ogden's exponent is -12; the material has -20."""
    material = Material(law="ogden", parameters={"mu": (-3e3,), "alpha": (-20.0,), "bulk": 1e8})
    made = experiment(
        *(
            trial(mode, mode, s, nominal_stress(material, mode, s), sd=200.0, seed=k)  # type: ignore[arg-type]
            for k, (mode, s) in enumerate(
                (("uniaxial", np.linspace(0.9, 1.3, 20)), ("simple-shear", np.linspace(1.0, 1.3, 20)))
            )
        )
    )
    model = HomogeneousModel(made, effects=effects_of("homogeneous"), richer=("ogden", 2))  # type: ignore[arg-type]
    form = next(c for c in model.candidates if c.effect == "law-form" and c.at == "all")
    found = fit(model, State(u=fit(model, State(u=model.start())).state.u, amplitudes={form: 1.0}), (form,))
    assert found.converged, found.message
    low, high = model.baseline.bounds.T
    assert (low <= found.state.u).all()
    assert (found.state.u <= high).all()


def test_a_cause_that_is_there_or_not_is_held_out_where_the_others_foretell_it() -> None:
    """Two modes constrain the constants for the third poorly; four fifths of the records predict the last."""
    made = experiment(
        *(
            trial(mode, mode, ramps(top, 1, 25), of_ogden(mode, ramps(top, 1, 25)), sd=1500.0, seed=k)  # type: ignore[arg-type]
            for k, (mode, top) in enumerate((("equibiaxial", 2.0), ("planar", 2.5)))
        )
    )
    model = HomogeneousModel(made, effects=effects_of("homogeneous"), richer=("ogden", 2))  # type: ignore[arg-type]
    form = next(c for c in model.candidates if c.effect == "law-form" and c.at == "all")
    plain = fit(model, State(u=model.start()))
    found = fit(model, State(u=plain.state.u, amplitudes={form: 1.0}), (form,))
    gain = held_out_improvement(model, plain, found)
    assert gain.held_out == "leave-one-fifth-out"
    assert gain.skill > 0.8


@pytest.mark.slow
def test_laws_are_compared_by_what_they_have_not_seen() -> None:
    made = experiment(
        *(
            trial(mode, mode, ramps(top, 1, 25), of_ogden, sd=400.0, seed=k)  # type: ignore[arg-type]
            for k, (mode, top) in enumerate((("uniaxial", 3.0), ("equibiaxial", 2.0), ("planar", 2.5)))
        )
    )
    choice = choose_law(coupon_model(made))
    assert choice.best.label in ("ogden-2", "ogden-3")
    assert choice.simplest.label == "neo-hookean"
