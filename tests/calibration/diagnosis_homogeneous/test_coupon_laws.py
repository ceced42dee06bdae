"""Laws compared as baselines: each material separately, and the start of the search for constants."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_coupon_cases import Array, coupon_model, experiment, ramps, trial

from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.laws import choose_law
from calibration.measurements._state import State
from calibration.measurements.homogeneous import nominal_stress
from calibration.measurements.homogeneous._richer import law_start
from calibration.measurements.homogeneous.model import BULK_RATIO, HomogeneousModel
from calibration.parameters import parametrisation
from tisim import Material

LAWS = (("neo-hookean", 1), ("ogden", 1))


def of_ogden(mode: str, s: Array) -> Array:
    made = Material(law="ogden", parameters={"mu": (3e4,), "alpha": (3.0,), "bulk": 4.5e4 * BULK_RATIO})
    return nominal_stress(made, mode, s)  # type: ignore[arg-type]


def two_materials() -> HomogeneousModel:
    return coupon_model(
        experiment(
            trial("stiff", "uniaxial", ramps(8.0, 1, 25), of_ogden, sd=2e3, material="A", seed=1),
            trial("plain", "uniaxial", ramps(2.0, 1, 25), material="B", seed=2),
            trial("again", "uniaxial", ramps(6.0, 1, 25), of_ogden, sd=2e3, material="A", seed=3),
        )
    )


def test_laws_are_compared_material_by_material(monkeypatch: pytest.MonkeyPatch) -> None:
    """Materials share no coordinate, so that scores are sums over materials."""
    monkeypatch.setattr(HomogeneousModel, "laws", LAWS)
    model = two_materials()
    parts = model.with_law("ogden", 1)
    assert [[r.name for r in p.records] for p in parts] == [["stiff", "again"], ["plain"]]
    whole = choose_law(model)
    assert whole.best.label == "ogden"
    assert whole.best.constants == 2
    assert whole.points == model.points
    each = [
        choose_law(coupon_model(replace(model.experiment, trials=tuple(p.trials))))
        for p in model.with_law("neo-hookean", 1)
    ]
    for k, _ in enumerate(LAWS):
        assert whole.scores[k].chi2 == pytest.approx(sum(c.scores[k].chi2 for c in each))
        assert whole.scores[k].held_out == pytest.approx(sum(c.scores[k].held_out for c in each))


def test_constants_begin_at_the_volume_that_is_held() -> None:
    """At eight times its length a rubber's volume is 1 % larger; constant volume gives a wrong exponent."""
    stretch = ramps(8.0, 1, 25)
    model = coupon_model(experiment(trial("A", "uniaxial", stretch, of_ogden, sd=None)))
    law = parametrisation("ogden", terms=1)
    starts = [law_start(law, model.records, bulk_ratio=k) for k in (BULK_RATIO, 1e6)]
    exponents = [found[1][-1] for found in starts if found is not None]
    assert exponents[0] == pytest.approx(3.0, abs=1e-4)
    assert abs(exponents[1] - 3.0) > 20.0 * abs(exponents[0] - 3.0)
    assert np.isfinite(exponents).all()


def test_a_richer_law_begins_at_its_own_moduli() -> None:
    """The neo-Hookean modulus of a stiffening rubber is much too large for the stiffening law."""
    trials = [
        trial(m, "uniaxial", ramps(8.0, 1, 25), of_ogden, sd=2e3, material=m, seed=k)
        for k, m in enumerate("AB")
    ]
    model = coupon_model(experiment(*trials), further=True, richer=("ogden", 1))
    forms = {c.at: c for c in model.candidates if c.effect == "law-form"}
    baseline = fit(model, State(u=model.start()))
    assert (baseline.state.u[:2] > np.log(3.0 * 4.5e4)).all()
    begun = model.begun(baseline.state, [forms["B"]])
    assert begun.u[0] == baseline.state.u[0]
    assert begun.u[1] == pytest.approx(np.log(4.5e4), abs=0.05)
    null = Null(len(baseline.z), model.discrepancy_basis())
    found = explain(model, baseline, (forms["all"],), [1.0], null)
    assert found is not None
    assert found.fit.converged
    assert found.fit.chi2 < 2.0 * model.points
    assert model.shear_moduli(found.fit.state.u)["A"] == pytest.approx(4.5e4, rel=0.05)
