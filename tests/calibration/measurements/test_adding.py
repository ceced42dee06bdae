"""An effect and a measurement, each added from outside the package by one file and one registration."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_experiment import experiment as made
from numpy.typing import NDArray

import calibration
from calibration.diagnosis import catalogue, diagnose, kinds, model_of
from calibration.errors import InputError
from calibration.experiment import CouponTrial, Experiment
from calibration.measurements import _kinds
from calibration.measurements._baseline import Baseline
from calibration.measurements._basis import Columns, legendre
from calibration.measurements._contribution import Contribution, FitContext
from calibration.measurements._effect import Effect, EffectModel
from calibration.measurements._kinds import Kind
from calibration.measurements._model import MeasurementModel
from calibration.measurements._noise import Noise
from calibration.measurements._state import State
from calibration.measurements.homogeneous._effect import HomogeneousEffect
from calibration.measurements.homogeneous._record import Record
from calibration.measurements.objective import ModelObjective
from calibration.parameters import parametrisation
from calibration.study import measurements

Array = NDArray[np.float64]
SHEAR = 3e4
NEO = parametrisation("neo-hookean")

# -- an effect --

THERMAL = Effect(
    name="warming",
    parameter="softening_percent",
    per_unit=100.0,
    belongs_to="specimen",
    sentence="the specimen warms up and gets softer as it is strained",
    remedy="strain it more slowly, or cool it",
)


def _softer(s: Array, amplitude: float, record: Record) -> Array:
    del s
    return 1.0 - amplitude * np.arange(record.points) / record.points


WARMING = HomogeneousEffect(
    effect=THERMAL, step=1e-3, bounds=(0.0, 0.9), prior_scale=0.3, factor=_softer, scopes=()
)


@pytest.fixture
def warming() -> Iterator[None]:
    catalogue.register("homogeneous", WARMING)
    yield
    catalogue.unregister("homogeneous", "warming")


def pulled(softening: float) -> Experiment:
    """Three cycles of simple tension, with a stress that softens from point to point."""
    ramp = np.linspace(1.0, 1.5, 40)
    stretch = np.concatenate([ramp, ramp[-2::-1]] * 3)
    clean = SHEAR * (stretch - stretch**-2) * (1.0 - softening * np.arange(stretch.size) / stretch.size)
    noise = 100.0 * np.random.default_rng(4).standard_normal(stretch.size)
    trial = CouponTrial(
        id="pull", material="A", mode="uniaxial", stretch=stretch, stress=clean + noise, stress_sd=100.0
    )
    return made(trial)


def test_an_effect_of_an_unknown_kind_is_refused() -> None:
    """It was kept, and never looked for."""
    with pytest.raises(ValueError, match="kind of measurement homogenous: expected one of outlines, homog"):
        catalogue.register("homogenous", WARMING)
    catalogue.register("coupons", WARMING)  # an earlier name
    assert "warming" in catalogue.effects_of("homogeneous")
    catalogue.unregister("homogeneous", "warming")


@pytest.mark.usefixtures("warming")
def test_an_effect_of_ones_own_is_found() -> None:
    found = diagnose(model_of(pulled(0.2)), gain=False)
    assert found.finding.equivalent[0] == ("warming",)
    (cause,) = found.causes()
    estimate = cause["parameters"]["softening_percent"]
    assert abs(estimate["value"] - 20.0) < 4.0 * estimate["sd"]
    assert "warms up" in found.sentence()
    with pytest.raises(ValueError, match="homogeneous has one of that name"):
        catalogue.register("homogeneous", WARMING)


def test_without_its_registration_it_has_no_name() -> None:
    assert "warming" not in catalogue.effects_of("homogeneous")
    found = diagnose(model_of(pulled(0.2)), gain=False)
    assert "warming" not in {name for names in found.finding.equivalent for name in names}


# -- a measurement: torsion of a thin rod, moment against angle --


@dataclass(frozen=True, eq=False, kw_only=True)
class Twist:
    """A trial that is its own record: moment = G * stiffness * angle, with the polar moment over length."""

    name: str
    material: str
    angle: Array
    moment: Array
    sd: float
    stiffness: float = 2e-9  # polar moment over length [m3]

    @property
    def id(self) -> str:
        return self.name

    @property
    def specimen(self) -> str:
        return self.material

    @property
    def groups(self) -> Mapping[str, str]:
        return {"material": self.material, "specimen": self.specimen, "trial": self.name}

    @property
    def ranges(self) -> Mapping[str, tuple[float, float]]:
        return {"angle_rad": (float(self.angle.min()), float(self.angle.max()))}


@dataclass(frozen=True, kw_only=True)
class TwistEffect(EffectModel):
    """`slack` is a lost angle [rad]."""

    slack: float = 0.0


class TorsionModel(MeasurementModel):
    kind = "torsion"
    unit = ("mNm", 1e3)

    def __init__(
        self, experiment: Experiment, *, effects: Mapping[str, EffectModel], baseline: Baseline | None = None
    ) -> None:
        self.records = [t for t in experiment.trials if isinstance(t, Twist)]
        self.effects = effects
        self.row_record = np.repeat(np.arange(len(self.records)), [r.angle.size for r in self.records])
        self.noise = Noise.independent(np.concatenate([np.full(r.angle.size, r.sd) for r in self.records]))
        self.baseline = baseline or Baseline.per_specimen(self.records, bulk_ratio=1000.0)
        self._set_candidates()

    def start(self) -> Array:
        found = {
            r.specimen: float(r.moment @ r.angle / (r.angle @ r.angle) / r.stiffness) for r in self.records
        }
        return self.baseline.start(found)

    def _misfit(self, states: Sequence[State]) -> Array:
        return np.array(
            [np.concatenate([self._moment(s, r) - r.moment for r in self.records]) for s in states]
        )

    def _moment(self, state: State, r: Twist) -> Array:
        shear = self.baseline.shear_modulus(r.specimen, state.u)
        slack = sum(self.effects[n].slack * a for (n, _, _), a in self.acting(state, r).items())  # type: ignore[attr-defined]
        return np.asarray(shear * r.stiffness * (r.angle - slack))

    def _discrepancies(self) -> Mapping[str, Array]:
        columns = Columns([r.angle.size for r in self.records])
        for k, r in enumerate(self.records):
            for degree in range(4):
                columns.add("trial bends", [(k, r.sd * legendre(r.angle, degree))])
        return columns.by_name()

    def _fold_labels(self) -> Mapping[str, Sequence[str]]:
        return {"leave-one-trial-out": [r.name for r in self.records for _ in r.angle]}


BACKLASH = TwistEffect(
    effect=Effect(
        name="backlash",
        parameter="slack_deg",
        per_unit=180.0 / np.pi,
        belongs_to="rig",
        sentence="the grips turn before they hold",
        remedy="measure the angle on the specimen",
    ),
    step=1e-4,
    bounds=(-0.5, 0.5),
    prior_scale=0.1,
    scopes=("trial",),
    slack=1.0,
)


def twists(experiment: Experiment) -> list[Any]:
    return [t for t in experiment.trials if isinstance(t, Twist)]


TORSION = Kind(name="torsion", holds=lambda e: bool(twists(e)), load=lambda: TorsionModel, compares=twists)


@contextmanager
def registered(kind: Kind) -> Iterator[None]:
    _kinds.register(kind)
    try:
        yield
    finally:
        _kinds.unregister(kind.name)


@pytest.fixture
def torsion() -> Iterator[None]:
    with registered(TORSION):
        catalogue.register("torsion", BACKLASH)
        yield
        catalogue.unregister("torsion", "backlash")


def twisted(slack: float) -> Experiment:
    trials = []
    for k in range(3):
        angle = np.linspace(0.05, 0.8, 60)
        noise = 1e-7 * np.random.default_rng(k).standard_normal(angle.size)
        moment = SHEAR * 2e-9 * (angle - slack) + noise
        trials.append(Twist(name=f"t{k}", material="A", angle=angle, moment=moment, sd=1e-7))
    return made(*trials)


@pytest.mark.usefixtures("torsion")
def test_a_kind_of_ones_own_is_diagnosed(tmp_path: Path) -> None:
    from calibration.diagnosis.card import write_cards
    from calibration.diagnosis.report import write_report

    assert "torsion" in kinds()
    experiment = twisted(0.02)
    model = model_of(experiment)
    assert isinstance(model, TorsionModel)
    found = diagnose(model)
    assert found.finding.equivalent == (("backlash",),)
    (cause,) = found.causes()
    assert cause["scope"] == "all"
    estimate = cause["parameters"]["slack_deg"]
    assert abs(estimate["value"] - np.degrees(0.02)) < 4.0 * estimate["sd"]
    told = found.to_json()
    assert told["gain"]["rms_mNm_after"] < told["gain"]["rms_mNm_before"]
    assert told["extended"]["shear_modulus_Pa"]["A"] == pytest.approx(SHEAR, rel=0.01)
    assert diagnose(model_of(twisted(0.0))).finding.verdict == "none"
    # page and cards need no further code
    assert write_report(found, model, tmp_path, title="torsion")[0].exists()
    assert {p.name for p in write_cards(tmp_path / "cards", found, experiment)} == {"A.yaml", "rig.yaml"}


@pytest.mark.usefixtures("torsion")
def test_a_kind_of_ones_own_is_fitted_and_predicted(tmp_path: Path) -> None:
    experiment = twisted(0.0)
    # in this process, the only one that knows the kind
    fits = calibration.fit(experiment, model=("neo-hookean", "mooney-rivlin"), workers=2)
    found = fits[0]
    assert found.status == "converged"
    assert found.points == 180
    assert found.shear_modulus_sd < 0.01 * SHEAR
    assert abs(found.shear_modulus - SHEAR) < 3.0 * found.shear_modulus_sd
    # page, cards and predictions need no further code
    assert fits.write_report(tmp_path).exists()
    fits.write_cards(tmp_path / "cards")
    predicted = calibration.predict(experiment, cards=tmp_path / "cards").prediction
    assert set(predicted.of_kind()) == {"torsion"}
    assert predicted.rms(predicted.records, "extended") == pytest.approx(1e-7, rel=0.2)
    with pytest.raises(
        InputError, match="trial t0: --time: expected no torsion, which is not fitted with it"
    ):
        calibration.fit(experiment, model="neo-hookean", time="prony:1")


@pytest.mark.usefixtures("torsion")
def test_a_kind_of_ones_own_is_fitted_beside_others() -> None:
    data = measurements(made(*twisted(0.0).trials, *pulled(0.0).trials), "A", NEO, workers=1)
    assert [o.name for o in data.objectives] == ["coupons pull", "torsion t0, t1, t2"]
    assert data.ignored == ()


def test_an_objective_of_ones_own_replaces_the_likelihood() -> None:
    """It states what it leaves out, and shortens the steps of a search over moduli."""

    def first_alone(own: Experiment, context: FitContext) -> Contribution:
        some = replace(own, trials=own.trials[:1])
        model = TorsionModel(some, effects={}, baseline=Baseline.of_law(some.trials, context.law))
        return Contribution(
            objectives=(ModelObjective(model, name="first twist"),), left_out=("t1: unwound",), steps=0.1
        )

    with registered(replace(TORSION, objectives={"likelihood": lambda: first_alone})):
        data = measurements(twisted(0.0), "A", NEO, workers=1)
        assert [o.points for o in data.objectives] == [60]
        assert data.ignored == ("t1: unwound",)
        assert data.law.spread[0] == pytest.approx(0.1 * NEO.spread[0])
        with pytest.raises(InputError, match="expected at least one beam with a traced outline"):
            measurements(twisted(0.0), "A", NEO, objective="dice")


def test_a_kind_that_compares_nothing_is_only_diagnosed() -> None:
    with registered(replace(TORSION, compares=lambda _: ())):
        data = measurements(made(*twisted(0.0).trials, *pulled(0.0).trials), "A", NEO, workers=1)
        assert [o.name for o in data.objectives] == ["coupons pull"]
        assert data.ignored[0] == "t0: no kind of measurement compares it in a fit"


@pytest.mark.usefixtures("torsion")
def test_its_derivatives_are_those_of_its_residuals() -> None:
    model = model_of(twisted(0.01))
    state = State(u=model.start())
    linear = model.linearise(state, model.candidates)
    assert [c.at for c in model.candidates] == ["all", "t0", "t1", "t2"]
    for k, c in enumerate(model.candidates):
        (moved,) = model.residuals([State(u=state.u, amplitudes={c: 1e-3})])
        assert moved - linear.z == pytest.approx(1e-3 * linear.columns[:, k], abs=1e-9)
    (moved,) = model.residuals([State(u=state.u + 1e-5)])
    assert moved - linear.z == pytest.approx(1e-5 * linear.by_u[:, 0], rel=1e-3, abs=1e-6)


def test_a_name_is_registered_once() -> None:
    with pytest.raises(ValueError, match="registered already"):
        _kinds.register(Kind(name="outlines", holds=lambda _: False, load=lambda: TorsionModel))
