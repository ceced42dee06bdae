"""What a model of presses is made of: stored simulations, gaps, remarks, the command."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pytest
from diagnosis_press_cases import TABLE, bonded, both, experiment, pressed, ramps, sliding
from typer.testing import CliRunner

from calibration.diagnose import app
from calibration.diagnosis import model_of
from calibration.diagnosis.coupons import CouponModel
from calibration.diagnosis.effect import Candidate
from calibration.diagnosis.fitting import fit
from calibration.diagnosis.nested import State
from calibration.diagnosis.presses import PressModel
from calibration.diagnosis.presses._held import USUAL, Held
from calibration.diagnosis.report import noise_of, pictures_of
from calibration.diagnosis.run import diagnose
from calibration.errors import InputError
from calibration.experiment import CouponTrial
from calibration.press import Cylinder


@pytest.mark.parametrize(("law", "share"), [("neo-hookean", 0.0), ("mooney-rivlin 0.3", 0.3)])
def test_stored_simulations_against_another_solver(law: str, share: float) -> None:
    """To half of the height; FElupe's table has the side's contact too."""
    strain = np.array(TABLE["strains"])
    used = strain <= 0.5
    s = 1.0 - strain
    other = np.log(
        np.array(TABLE["stress_over_shear_modulus"][law]) / (sliding(strain) * (1 - share + share / s))
    )
    ours = Held(cylinder=USUAL).log_ratio(s, {"second-invariant": share})
    assert np.abs(ours - other)[used].max() < 0.008
    assert np.abs(ours - other)[used].mean() < 0.003


@pytest.mark.parametrize("slender", [1.0, 2.0])
def test_stored_simulations_between_the_stored_heights(slender: float) -> None:
    """The same at heights that are not stored, to 20 %."""
    curve = np.array(TABLE["neo_hookean_by_diameter_over_height"][str(slender)])
    strain = np.array(TABLE["strains"])[: curve.size]
    ours = Held(cylinder=Cylinder(radius=0.5 * slender, height=1.0)).log_ratio(1.0 - strain, {})
    assert np.abs(ours - np.log(curve / sliding(strain))).max() < 0.012


def test_chains_near_their_ends_are_not_tabled() -> None:
    """1 / N of 0.3: at 45 % strain the free cylinder's chains are at 0.65 of their length, at 65 % at 0.8."""
    ours = Held(cylinder=USUAL).log_ratio(np.array([0.55, 0.35]), {"limited-extensibility": 0.3})
    assert 0.35 < ours[0] < 0.5
    assert np.isnan(ours[1])


def test_too_flat_a_cylinder_is_refused() -> None:
    with pytest.raises(InputError, match=r"up to 2\.3 heights"):
        PressModel(both(sliding), cylinder=Cylinder(radius=0.03, height=0.01))


def test_only_a_stated_height_is_not_remarked() -> None:
    assert any("the format does not say" in r for r in PressModel(both(sliding)).remarks())
    known = PressModel(both(sliding), cylinder=Cylinder(radius=0.01, height=0.02))
    assert any("20 x 20 mm (diameter x height);" in r for r in known.remarks())


def test_beyond_half_of_the_height_nothing_is_compared() -> None:
    model = PressModel(both(sliding, strain=ramps(1, top=0.66)))
    assert all(r.stretch.min() >= 0.5 for r in model.records)
    assert any("up to a strain of 0.5" in r for r in model.remarks())


def test_amplitude_zero_is_the_baseline() -> None:
    model = PressModel(both(sliding, strain=ramps(2)))
    u = model.start()
    plain = model.residuals([State(u=u)])[0]
    nothing = model.residuals([State(u=u, amplitudes={Candidate(effect=n): 0.0 for n in model.effects})])[0]
    assert np.array_equal(plain, nothing)


def test_platens_do_not_pull() -> None:
    """A cylinder that is met late carries nothing before."""
    model = PressModel(both(sliding))
    late = State(u=model.start(), amplitudes={Candidate(effect="strain-offset"): 0.05})
    for r, p in zip(model.records, model.stresses(late), strict=True):
        assert np.all(p[r.stretch > 0.95] == 0.0)
        assert np.all(p[r.stretch < 0.94] < 0.0)


def test_which_coupons_are_presses() -> None:
    pull = CouponTrial(
        id="pull",
        material="soft",
        mode="uniaxial",
        stretch=np.linspace(1.0, 1.5, 40),
        stress=1e4 * np.linspace(0.0, 1.0, 40),
    )
    press = pressed("press", sliding)
    assert isinstance(model_of(experiment(press)), PressModel)
    for data in (experiment(pull), experiment(pull, press)):
        assert not isinstance(model_of(data), PressModel)
        assert isinstance(model_of(data), CouponModel)
    assert isinstance(model_of(experiment(pull, press), kind="presses"), PressModel)
    assert not isinstance(model_of(experiment(press), kind="coupons"), PressModel)
    with pytest.raises(InputError, match="has none"):
        model_of(experiment(pull), kind="presses")


def test_pictures_and_words() -> None:
    model = PressModel(both(sliding, seed=1))
    found = diagnose(model, gain=False)
    assert [p.name for p in pictures_of(model, found)] == ["curves", "residuals", "rms"]
    for p in pictures_of(model, found):
        p.figure.savefig(io.BytesIO(), format="png")
    assert "too few repeats" in noise_of(model)


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
    """More force than bonded platens hold, and a toe: the rest of the fit goes on along the bound."""
    strain = ramps(1)
    more = np.exp(0.4 * Held(cylinder=USUAL).log_ratio(1.0 - strain, {})) * bonded()(
        np.maximum(strain - 0.004, 0.0)
    )
    model = PressModel(both(lambda _: more, seed=1))
    friction, tilt = Candidate(effect="platen-friction"), Candidate(effect="platen-tilt")
    ends = [
        fit(model, State(u=model.start(), amplitudes={friction: 1.0, tilt: at}), (friction, tilt))
        for at in (0.0, 0.01, 0.03)
    ]
    assert all(e.converged for e in ends)
    assert all(e.state.amplitudes[friction] == 1.1 for e in ends)
    assert np.ptp([e.chi2 for e in ends]) < 0.1
