"""The compression model: stored simulations, gaps, remarks, repeatability, the command."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from diagnosis_press_cases import TABLE, Array, bonded, both, experiment, press_model, pressed, ramps, sliding
from typer.testing import CliRunner

from calibration.diagnose import app
from calibration.diagnosis import model_of
from calibration.diagnosis.catalogue import effects_of
from calibration.diagnosis.drawing import figures_of
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.run import diagnose
from calibration.diagnosis.engine.screening import screen
from calibration.errors import InputError
from calibration.experiment import CouponTrial, Experiment
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State
from calibration.measurements.compression._bonded import USUAL, BondedRatio
from calibration.measurements.compression._record import LAST
from calibration.measurements.compression._repeatability import TERMS, repeatability_of
from calibration.measurements.compression.curves import Cylinder
from calibration.measurements.compression.model import CompressionModel
from calibration.measurements.homogeneous._forward import Loading
from calibration.measurements.homogeneous.model import HomogeneousModel


@pytest.mark.parametrize(("law", "share"), [("neo-hookean", 0.0), ("mooney-rivlin 0.3", 0.3)])
def test_stored_simulations_against_another_solver(law: str, share: float) -> None:
    """Up to half of the height; FElupe's table includes the contact of the side."""
    strain = np.array(TABLE["strains"])
    used = strain <= 0.5
    s = 1.0 - strain
    other = np.log(
        np.array(TABLE["stress_over_shear_modulus"][law]) / (sliding(strain) * (1 - share + share / s))
    )
    ours = BondedRatio(cylinder=USUAL).log_ratio(s, {"second-invariant": share})
    assert np.abs(ours - other)[used].max() < 0.008
    assert np.abs(ours - other)[used].mean() < 0.003


@pytest.mark.parametrize("slender", [1.0, 2.0])
def test_stored_simulations_between_the_stored_heights(slender: float) -> None:
    """The ratio at diameter-to-height ratios that are not stored."""
    curve = np.array(TABLE["neo_hookean_by_diameter_over_height"][str(slender)])
    strain = np.array(TABLE["strains"])[: curve.size]
    ours = BondedRatio(cylinder=Cylinder(radius=0.5 * slender, height=1.0)).log_ratio(1.0 - strain, {})
    assert np.abs(ours - np.log(curve / sliding(strain))).max() < 0.012


def test_chains_near_their_ends_are_not_tabled() -> None:
    """At 1 / N = 0.3 the free cylinder's chains reach 0.65 of their length at 45 % strain, 0.8 at 65 %."""
    ours = BondedRatio(cylinder=USUAL).log_ratio(np.array([0.55, 0.35]), {"limited-extensibility": 0.3})
    assert 0.35 < ours[0] < 0.5
    assert np.isnan(ours[1])


def test_too_flat_a_cylinder_is_refused() -> None:
    with pytest.raises(InputError, match=r"up to 2\.3 heights"):
        press_model(both(sliding), cylinder=Cylinder(radius=0.03, height=0.01))


def test_only_a_stated_height_is_not_remarked() -> None:
    assert any("the format does not say" in r for r in press_model(both(sliding)).remarks())
    known = press_model(both(sliding), cylinder=Cylinder(radius=0.01, height=0.02))
    assert any("20 x 20 mm (diameter x height);" in r for r in known.remarks())


def test_a_fit_says_what_it_takes_the_platens_for() -> None:
    """Bonded to free at a strain of 0.5, by the other solver's table."""
    model = press_model(both(sliding, strain=ramps(1, top=0.5)))
    (said,) = (s for s in model.shortcomings() if "free of friction" in s)
    strain = np.array(TABLE["strains"])
    held = np.array(TABLE["stress_over_shear_modulus"]["neo-hookean"]) / sliding(strain)
    ratio = np.interp(0.5, strain, held)
    assert f"50 x 30 mm, its force is {ratio:.1f}" in said
    assert "at a strain of 0.5" in said


def test_beyond_half_of_the_height_nothing_is_compared() -> None:
    model = press_model(both(sliding, strain=ramps(1, top=0.66)))
    assert all(r.stretch.min() >= 0.5 for r in model.records)
    assert any("up to a strain of 0.5" in r for r in model.remarks())
    # cards state what they hold for: they said 0.34
    low, high = model.valid_range(Candidate(effect="platen-bonding"))["stretch"]
    assert (low, high) == pytest.approx((0.5, 1.0), abs=0.01)


def test_a_record_wholly_beyond_half_of_the_height_is_refused() -> None:
    """Strain in place of stretch: numpy's words on an empty array reached the user."""
    deep = pressed("deep", sliding, strain=np.linspace(0.55, 0.66, 20))
    with pytest.raises(InputError, match=r"trial deep: record: expected some points with a stretch of 0\.5"):
        press_model(experiment(deep, pressed("good", sliding)))


def test_amplitude_zero_is_the_baseline() -> None:
    model = press_model(both(sliding, strain=ramps(2)))
    u = model.start()
    plain = model.residuals([State(u=u)])[0]
    nothing = model.residuals([State(u=u, amplitudes={Candidate(effect=n): 0.0 for n in model.effects})])[0]
    assert np.array_equal(plain, nothing)


def test_platens_do_not_pull() -> None:
    """A cylinder that is touched late has no stress before."""
    model = press_model(both(sliding))
    late = State(u=model.start(), amplitudes={Candidate(effect="strain-offset"): 0.05})
    for r, p in zip(model.records, model.stresses(late), strict=True):
        assert np.all(p[r.stretch > 0.95] == 0.0)
        assert np.all(p[r.stretch < 0.94] < 0.0)


def six() -> CompressionModel:
    """Four repeats, and two cylinders of another material; each record has its own deviation."""
    trials = [
        pressed(f"{m}-{k}", sliding, material=m, strain=ramps(1, top=0.45 - 0.01 * k), seed=k)
        for m, count in (("soft", 4), ("hard", 2))
        for k in range(count)
    ]
    return press_model(experiment(*trials))


CAUSES = {
    Candidate(effect="platen-bonding"): 0.4,
    Candidate(effect="machine-compliance"): 2e-7,
    Candidate(effect="platen-tilt", at="soft-1"): 0.02,
}


def test_coordinates_of_different_records_move_together_and_derive_as_one_at_a_time() -> None:
    """Two moduli, deviations of six records, and the mesh error that all records share."""
    model = six()
    state = State(u=model.start() + 0.01, amplitudes=CAUSES)
    terms, mesh = len(model.coordinates.terms), len(model.coordinates.mesh(state.u))
    assert len(model.names) == 2 + 6 * terms + mesh
    assert len(model._beside(state)) == 1 + terms + mesh
    z, by_u = model.residuals([state])[0], model.linearise(state, ()).by_u
    for k in range(len(state.u)):
        moved = State(u=state.u + model.coordinate_step * np.eye(len(state.u))[k], amplitudes=CAUSES)
        alone = (model.residuals([moved])[0] - z) / model.coordinate_step
        assert by_u[:, k] == pytest.approx(alone, abs=1e-6 * max(1.0, float(np.abs(alone).max())))


def test_a_record_is_not_simulated_again_for_what_does_not_reach_it(monkeypatch: pytest.MonkeyPatch) -> None:
    model = six()
    state = State(u=model.start(), amplitudes={Candidate(effect="machine-compliance"): 2e-7})
    solved: list[str] = []
    whole = CompressionModel._solved

    def counted(self: CompressionModel, loadings: Sequence[Loading]) -> list[Array]:
        solved.extend(x.record.name for x in loadings)
        return whole(self, loadings)

    monkeypatch.setattr(CompressionModel, "_solved", counted)
    before = model.stresses(state)
    everything = [r.name for r in model.records]
    assert solved == everything
    solved.clear()
    # a deviation, a mesh error of frictionless platens, a load cell's gain: none changes the specimen
    u = state.u.copy()
    u[2:] += 0.01
    model.stresses(State(u=u, amplitudes={**state.amplitudes, Candidate(effect="force-gain"): 0.1}))
    assert solved == []
    one = {**state.amplitudes, Candidate(effect="strain-offset", at="hard-1"): 0.01}
    after = model.stresses(State(u=state.u, amplitudes=one))
    assert solved == ["hard-1"]
    for name, a, b in zip(everything, before, after, strict=True):
        assert np.array_equal(a, b) == (name != "hard-1")
    # a fold simulates its own record only
    solved.clear()
    u[:2] += 0.02
    fold = dict(model.folds()["leave-one-trial-out"])["soft-2"]
    model.subset(fold, others=False).residuals([State(u=u, amplitudes=state.amplitudes)])
    assert solved == ["soft-2"]


def test_which_coupons_are_presses() -> None:
    pull = CouponTrial(
        id="pull",
        material="soft",
        mode="uniaxial",
        stretch=np.linspace(1.0, 1.5, 40),
        stress=1e4 * np.linspace(0.0, 1.0, 40),
    )
    press = pressed("press", sliding)
    assert isinstance(model_of(experiment(press)), CompressionModel)
    for data in (experiment(pull), experiment(pull, press)):
        assert not isinstance(model_of(data), CompressionModel)
        assert isinstance(model_of(data), HomogeneousModel)
    assert isinstance(model_of(experiment(pull, press), kind="presses"), CompressionModel)
    assert not isinstance(model_of(experiment(press), kind="coupons"), CompressionModel)
    with pytest.raises(InputError, match="has none"):
        model_of(experiment(pull), kind="presses")


def test_pictures_and_words() -> None:
    model = press_model(both(sliding, seed=1))
    found = diagnose(model, gain=False)
    names = [p.name for p in figures_of(model, found)]
    assert names == ["residuals", "curves", "rms"]  # the curves coincide
    for p in figures_of(model, found):
        p.figure.savefig(io.BytesIO(), format="png")
    assert "too few repeats" in model.noise_sentence()


def test_the_command(tmp_path: Path) -> None:
    folder = tmp_path / "pressed"
    folder.mkdir()
    strain = ramps(1)
    rng = np.random.default_rng(1)
    stress = 13.0 * sliding(strain + 0.01) + 0.05 * rng.standard_normal(strain.size)
    rows = "\n".join(f"{1 - e:.6f},{p:.6f}" for e, p in zip(strain, stress, strict=True))
    (folder / "a.csv").write_text("stretch,nominal_stress_kPa\n" + rows + "\n", encoding="utf-8")
    (folder / "experiment.yaml").write_text(
        "format: 1\nname: pressed\nmaterials: {M: {}}\ntrials:\n"
        "  - {id: a, kind: coupon, material: M, mode: uniaxial, record: a.csv, stress_sd_kPa: 0.05}\n",
        encoding="utf-8",
    )
    result = CliRunner().invoke(app, [str(folder), "--out", str(tmp_path / "out"), "--no-gain"])
    assert result.exit_code == 0, result.output
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert ["strain-offset"] in found["alternatives"]
    assert any("50 x 30 mm" in note for note in found["notes"])
    assert (tmp_path / "out" / "report.html").exists()
    assert (tmp_path / "out" / "cards" / "M.yaml").exists()


def test_a_fit_that_wants_beyond_a_bound_ends_there() -> None:
    """More force than bonded platens give, and a toe: the other parameters are fitted along the bound."""
    strain = ramps(1)
    more = np.exp(0.4 * BondedRatio(cylinder=USUAL).log_ratio(1.0 - strain, {})) * bonded()(
        np.maximum(strain - 0.004, 0.0)
    )
    model = press_model(both(lambda _: more, seed=1))
    friction, tilt = Candidate(effect="platen-bonding"), Candidate(effect="platen-tilt")
    ends = [
        fit(model, State(u=model.start(), amplitudes={friction: 1.0, tilt: at}), (friction, tilt))
        for at in (0.0, 0.01, 0.03)
    ]
    assert all(e.converged for e in ends)
    assert all(e.state.amplitudes[friction] == 1.1 for e in ends)
    assert np.ptp([e.chi2 for e in ends]) < 0.1


def test_rubbing_platens_are_between_the_slab_and_bonded_ones() -> None:
    """Little friction: closed form of the slab method (D/h = 5/3); much friction: bonded."""
    effects = effects_of("compression")
    model = CompressionModel(both(sliding), effects=effects)  # type: ignore[arg-type]
    u = model.start()

    def stress(name: str, amplitude: float) -> Array:
        return model.stresses(State(u=u, amplitudes={Candidate(effect=name): amplitude}))[0]

    record = model.records[0]
    pressed_in = record.stretch < 0.99
    free = stress("platen-slip", 0.0)[pressed_in]
    x = 0.01 * (5.0 / 3.0) * record.stretch[pressed_in] ** -1.5
    slab = 2.0 * (np.expm1(x) - x) / x**2
    assert stress("platen-slip", 0.01)[pressed_in] / free == pytest.approx(slab, rel=5e-4)
    bonded_ones = stress("platen-bonding", 1.0)[pressed_in]
    assert stress("platen-slip", 2.0)[pressed_in] / bonded_ones == pytest.approx(1.0, abs=0.02)
    assert (stress("platen-slip", 0.3)[pressed_in] / free < bonded_ones / free).all()


# -- from test to test --


def again(strain_of: Callable[[Array, int], Array], grown: float, *, scatter: float = 0.0) -> Experiment:
    """Six tests of one bonded cylinder at the strain `strain_of`; the stress grows by `grown` per test."""
    rng = np.random.default_rng(5)
    x = ramps(1)
    factors = [(1.0 + grown * k) * np.exp(scatter * rng.standard_normal()) for k in range(6)]
    return experiment(
        *(
            pressed(f"A{k}", f * bonded()(strain_of(x, k)), strain=x, seed=k, noise=0.002)
            for k, f in enumerate(factors)
        )
    )


def test_what_goes_on_from_test_to_test_is_no_scatter() -> None:
    """Nor is noise of single points, which is largest at small strains in a logarithm."""
    found = repeatability_of(press_model(again(lambda x, _: x, 0.01)).records, LAST)
    assert found.sds.max() < 0.003
    (drift,) = found.drifts
    assert drift.per_test == pytest.approx(0.01, abs=0.002)
    assert drift.correlation > 0.95
    wide = repeatability_of(press_model(again(lambda x, _: x, 0.0, scatter=0.02)).records, LAST)
    assert 0.01 < wide.sds[TERMS.index("scale")] < 0.08
    assert wide.sds[TERMS.index("scale") + 1 :].max() < 0.005


@pytest.mark.parametrize(
    ("name", "amplitude", "strain_of", "grown"),
    [
        ("set-between-tests", 0.005, lambda x, k: x / (1.0 - 0.005 * k), 0.0),
        ("test-order", 0.01, lambda x, _: x, 0.01),
    ],
)
def test_set_and_order_of_tests_show_beside_platens_that_hold(
    name: str, amplitude: float, strain_of: Callable[[Array, int], Array], grown: float
) -> None:
    made = again(strain_of, grown)
    model = CompressionModel(made, effects=effects_of("compression"))  # type: ignore[arg-type]
    platens = next(c for c in model.candidates if c.effect == "platen-bonding" and c.at == "all")
    start = fit(model, State(u=model.start()))
    held = fit(model, State(u=start.state.u, amplitudes={platens: 0.6}), (platens,))
    linear = model.linearise(held.state, model.candidates)
    beside = screen(linear, model.effects, held=held)
    best = int(np.argmax(beside.penalised(linear.z)))
    assert beside.candidates[best].label == name
    assert beside.amplitudes(linear.z)[best] == pytest.approx(amplitude, rel=0.3)
