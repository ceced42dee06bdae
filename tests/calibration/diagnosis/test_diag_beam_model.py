"""The outline model: noise, derivatives, folds, scopes of effects, and advised experiments."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from _folders import beam_entry, capture_entry, outline_columns, write_experiment
from diag_beams import SHEAR, beam_model, tiny

import tisim
from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.diagnosis.engine.advice import advice, advise
from calibration.diagnosis.engine.explain import explain
from calibration.diagnosis.engine.explanation import Explanation
from calibration.diagnosis.engine.fitting import fit
from calibration.diagnosis.engine.null import Null
from calibration.errors import InputError
from calibration.experiment import read
from calibration.experiment.model import BeamTrial, Experiment
from calibration.measurements._effect import Candidate, candidates_of, reaches
from calibration.measurements._state import State
from calibration.measurements.outlines._photographs import photographs_of
from calibration.measurements.outlines.experiments import EXPERIMENTS, Gauge
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.simulators import TISIM

BARE = replace(TISIM, reference=None)  # made the data: there is no mesh error to correct
FIRM = tisim.material_from_moduli("neo-hookean", shear_modulus=SHEAR, bulk_modulus=300.0 * SHEAR)
STATE = State(u=np.array([np.log(SHEAR)]))
TWO = State(u=np.log([SHEAR, 0.6 * SHEAR]))


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> OutlineModel:
    """Two materials, two lengths, two photographs of each beam; noise-free."""
    experiment = tiny(
        tmp_path_factory.mktemp("two"),
        lengths_mm=(50.0, 100.0),
        times=(10.0, 1000.0),
        shears=(SHEAR, 0.6 * SHEAR),
    )
    model = beam_model(experiment, simulator=BARE, workers=1)
    model.update_nuisances(TWO)
    return model


def test_z_of_its_own_noise_is_standard_normal(tmp_path: Path) -> None:
    z = []
    for seed in range(5):
        experiment = tiny(tmp_path / f"{seed}", noise=1.0, seed=seed)
        model = beam_model(experiment, simulator=BARE, workers=1)
        model.update_nuisances(STATE)
        z.append(model.residuals([STATE])[0])
    squares, count = np.sum(np.square(z)), np.size(z)
    assert abs(squares - count) < 4.0 * np.sqrt(2.0 * count)
    assert abs(np.sum(z)) < 4.0 * np.sqrt(count)


def test_noise_that_the_lab_does_not_admit_is_seen(tmp_path: Path) -> None:
    experiment = tiny(tmp_path, noise=1.5, seed=1)
    model = beam_model(experiment, simulator=BARE, workers=1)
    model.update_nuisances(STATE)
    z = model.residuals([STATE])[0]
    assert z @ z > len(z) + 4.0 * np.sqrt(2.0 * len(z))


def test_what_is_stated_with_an_sd_is_a_nuisance(tmp_path: Path) -> None:
    sure = beam_model(tiny(tmp_path / "a"), simulator=BARE, workers=1)
    unsure = beam_model(tiny(tmp_path / "b", sure=False), simulator=BARE, workers=1)
    for model in (sure, unsure):
        model.update_nuisances(STATE)
    sizes = [
        np.linalg.norm(m.linearise(STATE, (Candidate(effect="radius"),)).columns) for m in (sure, unsure)
    ]
    assert sizes[1] < 0.7 * sizes[0]  # an uncertain radius reduces the information


def test_without_noise_the_truth_leaves_nothing(two: OutlineModel) -> None:
    assert np.abs(two.residuals([TWO])[0]).max() < 0.05
    assert two.distance_rms(TWO) < 3e-6
    assert len(two.registered(TWO)) == len(two.records) == 8
    assert two.shear_moduli(TWO.u) == pytest.approx({"S0": SHEAR, "S1": 0.6 * SHEAR})
    assert two.unit == ("mm", 1e3)
    assert two.names == ("S0", "S1")


def test_moduli_are_found_from_where_it_begins(two: OutlineModel) -> None:
    begun = two.start()
    assert np.abs(begun - TWO.u).max() < 0.6
    found = fit(two, State(u=begun))
    assert found.converged
    assert found.state.u == pytest.approx(TWO.u, abs=0.01)


@pytest.mark.parametrize(
    "name",
    ["residual-curvature", "clamp-tilt", "camera-roll", "grip-length", "creep"],
)
def test_derivatives_are_those_of_the_residuals(two: OutlineModel, name: str) -> None:
    effect = EFFECTS[name]
    there = {Candidate(effect="clamp-tilt", at="S0"): 0.01}  # a state other than the baseline
    state = State(u=TWO.u, amplitudes=there)
    wanted = [c for c in two.candidates if c.effect == name]
    assert {c.at for c in wanted} >= ({"all"} if effect.belongs_to == "camera" else {"all", "S0", "S1"})
    linear = two.linearise(state, wanted)
    assert linear.z == pytest.approx(two.residuals([state])[0], abs=1e-6)
    for k, c in enumerate(wanted):
        a = 0.25 * effect.step
        pair = [State(u=TWO.u, amplitudes={**there, c: there.get(c, 0.0) + side * a}) for side in (1.0, -1.0)]
        up, down = two.residuals(pair)
        slope = (up - down) / (2.0 * a)
        assert np.linalg.norm(linear.columns[:, k] - slope) < 0.1 * np.linalg.norm(slope), c.label
    for k in range(2):
        step = np.zeros(2)
        step[k] = 2e-3
        up, down = two.residuals([State(u=TWO.u + s * step, amplitudes=there) for s in (1.0, -1.0)])
        slope = (up - down) / 4e-3
        assert np.linalg.norm(linear.by_u[:, k] - slope) < 0.05 * np.linalg.norm(slope)


def test_a_state_without_an_equilibrium_has_no_residuals(tmp_path: Path) -> None:
    """Materials softer than 10 kPa are marked as not converged: true failures take long."""

    def run(scenes, *, workers):  # type: ignore[no-untyped-def]
        found = tisim.simulate([replace(b, material=FIRM) for b in scenes], workers=workers)
        lost = [b.material.parameters["mu"] < 10e3 for b in scenes]
        return [
            replace(r, status=tisim.Status.NOT_CONVERGED) if gone else r
            for r, gone in zip(found, lost, strict=True)
        ]

    experiment = tiny(tmp_path, lengths_mm=(50.0,))
    model = beam_model(experiment, simulator=replace(BARE, run=run), workers=1)
    model.update_nuisances(STATE)
    soft = State(u=np.log([9e3]))
    z = model.residuals([soft, STATE])
    assert np.isnan(z[0]).all()
    assert np.isfinite(z[1]).all()
    with pytest.raises(ValueError, match="no equilibrium"):
        model.linearise(soft, ())
    with pytest.raises(ValueError, match="no equilibrium"):
        model.registered(soft)
    with pytest.raises(ValueError, match="no equilibrium"):
        model.update_nuisances(soft)
    with pytest.raises(ValueError, match="no equilibrium"):
        model.distance_rms(soft)


def test_before_it_is_taken_nothing_is_said(tmp_path: Path) -> None:
    model = beam_model(tiny(tmp_path, lengths_mm=(50.0,)), simulator=BARE, workers=1)
    with pytest.raises(RuntimeError, match="update_nuisances"):
        model.residuals([STATE])


def test_groups_and_their_parts(two: OutlineModel) -> None:
    families = two.folds()
    assert list(families) == ["leave-one-length-out", "leave-one-material-out", "leave-one-photograph-out"]
    whole = two.residuals([TWO])[0]
    off = State(u=TWO.u + 0.05)
    every = two.linearise(off, two.candidates[:2])
    for family, groups in families.items():
        assert len(groups) == 2
        rows = np.array([two.rows(g) for _, g in groups])
        assert (rows.sum(axis=0) == 1).all()  # every row is in one group
        for (_, g), mine in zip(groups, rows, strict=True):
            assert two.subset(g, others=False).points == mine.sum()
            for others, kept in ((False, mine), (True, ~mine)):
                part = two.subset(g, others=others)
                some = part.linearise(off, two.candidates[:2])
                if family == "leave-one-photograph-out":
                    continue  # photographs of one beam share the nuisances of its corners
                # trials share no nuisance here: a part is whitened as in the whole
                assert some.z == pytest.approx(every.z[kept], abs=1e-5)
                assert some.columns == pytest.approx(every.columns[kept], abs=1e-3)
                assert some.by_u == pytest.approx(every.by_u[kept], abs=1e-3)
    assert two.residuals([TWO])[0] == pytest.approx(whole)  # splitting changes nothing
    (_, first), _ = families["leave-one-material-out"]
    assert two.unconstrained(first).tolist() == [True, False]
    (_, first), _ = families["leave-one-length-out"]
    assert two.unconstrained(first).tolist() == [False, False]


def test_patterns_are_as_long_as_residuals(two: OutlineModel) -> None:
    patterns = two.discrepancy_basis()
    rows = len(two.residuals([TWO])[0])
    degrees = 5
    assert {n: p.shape for n, p in patterns.items()} == {
        "trial edges": (rows, 2 * degrees * 4),
        "trial bends": (rows, degrees * 4),
        "support bends": (rows, degrees * 2),
        "drifts": (rows, degrees * 4),
    }
    assert all(np.linalg.matrix_rank(p) == p.shape[1] for p in patterns.values())
    for k in range(4 * degrees):  # a trial's basis is zero outside that trial
        mine = np.concatenate([np.full(p.basis.shape[1], p.beam == k // degrees) for p in two.records])
        assert np.abs(patterns["trial bends"][: two.points][~mine, k]).max() < 1e-9
        assert np.linalg.norm(patterns["trial bends"][:, k]) > 0.0


def test_one_photograph_of_each_beam_has_no_drift(tmp_path: Path) -> None:
    model = beam_model(tiny(tmp_path, lengths_mm=(50.0,)), simulator=BARE, workers=1)
    model.update_nuisances(STATE)
    assert "drifts" not in model.discrepancy_basis()


def trials_of(experiment: Experiment, specimens: dict[str, str] | None = None) -> list[BeamTrial]:
    found = [t for t in experiment.trials if isinstance(t, BeamTrial)]
    return [replace(t, specimen=(specimens or {}).get(t.id, t.specimen)) for t in found]


def test_where_effects_may_sit(two: OutlineModel) -> None:
    trials = trials_of(two.experiment)
    found = candidates_of(photographs_of(trials), EFFECTS)
    assert len(set(found)) == len(found)
    bent = {c.at: c.alternatives for c in found if c.effect == "residual-curvature"}
    assert bent == {"all": 1, "S0": 2, "S1": 2}
    voids = [c for c in found if c.effect == "void"]
    places = EFFECTS["void"].positions
    assert {(c.at, c.position) for c in voids} == {
        (at, place) for at in (*(t.id for t in trials), "S0", "S1") for place in places
    }
    of_a_batch = {c.alternatives for c in voids if c.at in ("S0", "S1")}
    assert of_a_batch == {2 * len(places)}
    assert {c.alternatives for c in voids if c.at not in ("S0", "S1")} == {4 * len(places)}
    assert {c.at for c in found if c.effect == "added-mass"} == {t.id for t in trials}
    assert not any(c.effect == "clamp-gap" for c in found)  # there is no bridge


def test_where_effects_of_single_specimens_may_sit(two: OutlineModel) -> None:
    trials = trials_of(two.experiment, {"S0-cantilever-50": "short", "S0-cantilever-100": "long"})
    found = {
        c.at: c.alternatives
        for c in candidates_of(photographs_of(trials), EFFECTS)
        if c.effect == "residual-curvature"
    }
    # S1 is one specimen, and scoped as its material
    assert found == {"all": 1, "S0": 2, "S1": 2, "short": 3, "long": 3}
    hit = [
        [
            reaches(Candidate(effect="residual-curvature", at=at), t, EFFECTS["residual-curvature"])
            for t in trials
        ]
        for at in ("all", "S0", "long")
    ]
    assert hit == [[True] * 4, [True, True, False, False], [False, True, False, False]]


def test_faults_of_rig_and_camera_are_in_all_beams(two: OutlineModel) -> None:
    for c in candidates_of(photographs_of(trials_of(two.experiment)), EFFECTS):
        if EFFECTS[c.effect].belongs_to == "camera":
            assert c.at == "all", c.label


def test_specimens_of_one_material_are_held_together(two: OutlineModel) -> None:
    trials = trials_of(two.experiment, {"S0-cantilever-50": "short", "S0-cantilever-100": "long"})
    model = beam_model(replace(two.experiment, trials=tuple(trials)), simulator=BARE, workers=1)
    assert model.names == ("short", "long", "S1")
    assert model.baseline.owners == ("S0", "S0", "S1")
    apart = State(u=np.log([SHEAR, 1.2 * SHEAR, 0.6 * SHEAR]))
    model.update_nuisances(apart)
    held = model.residuals([apart])[0][model.points :]
    assert held @ held == pytest.approx((np.log(1.2) / 0.15) ** 2 / 2.0)
    assert model.shear_moduli(apart.u)["S0"] == pytest.approx(SHEAR * np.sqrt(1.2))


def test_effects_may_be_left_out(two: OutlineModel) -> None:
    model = beam_model(two.experiment, simulator=BARE, without=("void", "creep"))
    assert "void" not in model.effects
    assert not any(c.effect in ("void", "creep") for c in model.candidates)
    assert any("not corrected" in r for r in model.remarks())


def test_a_density_is_needed(tmp_path: Path) -> None:
    x = np.linspace(1.0, 49.0, 30)
    edges = [np.column_stack([x, np.full_like(x, side)]) for side in (10.0, -10.0)]
    folder = write_experiment(
        tmp_path,
        [beam_entry("a", free_length_mm=50.0, captures=[capture_entry(10.0, "a.csv")])],
        tables={"a.csv": outline_columns(*edges)},
        materials={"S0": {}},
    )
    with pytest.raises(InputError, match=r"materials\.S0\.density_kg_m3"):
        beam_model(read(folder))


@pytest.fixture(scope="module")
def bent(tmp_path_factory: pytest.TempPathFactory) -> tuple[OutlineModel, list[Explanation]]:
    """Beams with residual curvature, with two explanations: a curvature and a tilted rig."""

    def arc(beam, _):  # type: ignore[no-untyped-def]
        return replace(beam, imperfections=replace(beam.imperfections, curvature=0.5))

    experiment = tiny(tmp_path_factory.mktemp("bent"), change=arc)
    model = beam_model(experiment, simulator=BARE, workers=1)
    model.update_nuisances(STATE)
    null = Null(len(model.residuals([STATE])[0]), {})
    baseline = fit(model, STATE)
    found = []
    for name, guess in (("residual-curvature", 0.3), ("gravity-tilt", 0.02)):
        e = explain(model, baseline, (Candidate(effect=name),), [guess], null)
        assert e is not None
        found.append(e)
    return model, found


def test_the_amplitude_that_was_put_in_is_found(bent: tuple[OutlineModel, list[Explanation]]) -> None:
    _, (curved, leaning) = bent
    value, sd = curved.fit.amplitude(curved.candidates[0])
    assert value == pytest.approx(0.5, abs=0.02)
    assert sd > 0.02
    assert curved.fit.chi2 < 0.1
    assert curved.fit.state.u == pytest.approx(STATE.u, abs=0.005)
    assert leaning.fit.chi2 > curved.fit.chi2


def test_turning_the_beams_over_parts_a_bend_from_a_lean(
    bent: tuple[OutlineModel, list[Explanation]],
) -> None:
    model, explanations = bent
    found = {a.name: a.separation for a in advise(model, explanations)}
    assert set(found) == {e.name for e in EXPERIMENTS}
    assert found["turn-over"] > model.enough
    assert found["turn-over"] > 3.0 * max(found["swap-ends"], found["later"])
    assert found["weigh"] == found["cut"] == found["lens"] == 0.0  # measurements of other effects
    _, leaning = explanations
    tilt, sd = leaning.fit.amplitude(leaning.candidates[0])
    assert found["level"] == pytest.approx(tilt**2 / (2e-3**2 + sd**2))
    assert all(s >= 0.0 for s in found.values())


def test_the_cheapest_that_settles_it_comes_first(bent: tuple[OutlineModel, list[Explanation]]) -> None:
    model, explanations = bent
    found = advise(model, explanations)
    enough = [a.name for a in found if a.separation >= model.enough]
    order = [e.name for e in EXPERIMENTS]
    assert enough
    assert [a.name for a in found[: len(enough)]] == enough == sorted(enough, key=order.index)
    rest = [a.separation for a in found[len(enough) :]]
    assert rest == sorted(rest, reverse=True)
    said = advice(model, explanations)
    assert said.startswith(found[0].sentence)
    assert "residual-curvature, gravity-tilt part there by" in said


def test_gauges_measure_effects_that_there_are() -> None:
    for e in EXPERIMENTS:
        if isinstance(e, Gauge):
            assert set(e.sds) <= set(EFFECTS)
            assert all(sd > 0.0 for sd in e.sds.values())
    assert len({e.name for e in EXPERIMENTS}) == len(EXPERIMENTS)
