"""The indentation model: phases, derivatives, effects that a protocol cannot identify, searches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from poke_records import indentation_model, path, trial

from calibration.diagnosis.effects.indentation.specimen import _faded
from calibration.diagnosis.engine import explain
from calibration.diagnosis.engine.null import Null
from calibration.diagnosis.engine.screening import screen
from calibration.diagnosis.engine.search import fit_baseline, search
from calibration.errors import InputError
from calibration.measurements._effect import Candidate, reaches
from calibration.measurements._state import State
from calibration.measurements.indentation._curve import Curve
from calibration.measurements.indentation._curve_cache import CurveCache, CurveRequest
from calibration.measurements.indentation._phases import phases_of
from calibration.measurements.indentation.model import IndentationModel
from tisim import Block

SHEAR = 2e4
K = 1e-2  # of the synthetic curves: force over G and depth [m]


@pytest.fixture(autouse=True)
def made_curves(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Replace simulations by curves that are nearly straight and stiffer for wider indenters.

    The number in an effect's name scales its change. The list that is returned records the requests.
    """
    asked: list[str] = []

    def fetch(_: CurveCache, wanted: Sequence[CurveRequest]) -> list[Curve]:
        found = []
        for w in wanted:
            asked.append(w.name)
            change = 0.3 * float(w.name.split()[2]) if w.name else 0.0
            depth = np.linspace(0.1e-3, 4e-3, 40)
            force = K * (w.geometry.rod.radius / 2.5e-3) * depth * (1.0 + (100.0 + 400.0 * change) * depth)
            found.append(
                Curve(
                    depth=depth,
                    along=force,
                    across=np.zeros((40, 2)),
                    reached=4e-3,
                    finer=4e-3,
                    round_tip=False,
                    status="converged",
                    core_seconds=0.0,
                )
            )
        return found

    monkeypatch.setattr(CurveCache, "fetch", fetch)
    return asked


def curve(depth: np.ndarray, radius: float = 2.5e-3) -> np.ndarray:
    d = np.maximum(depth, 0.0)
    return np.asarray(SHEAR * K * (radius / 2.5e-3) * d * (1.0 + 100.0 * d))


def noisy(force: np.ndarray, seed: int = 0) -> np.ndarray:
    return np.asarray(force + 1e-3 * np.random.default_rng(seed).standard_normal(force.size))


def relaxed(time: np.ndarray, force: np.ndarray, tau: float) -> np.ndarray:
    """Force with a tenth in a Maxwell branch, integrated in time steps."""
    q = np.zeros_like(force)
    for k in range(1, force.size):
        fade = np.exp(-(time[k] - time[k - 1]) / tau)
        q[k] = fade * q[k - 1] + np.sqrt(fade) * (force[k] - force[k - 1])
    return np.asarray(0.9 * force + 0.1 * q)


def test_phases_are_cut_where_the_rod_turns_and_rests() -> None:
    time, depth = path(hold=4.0, cycles=2)
    noise = 1e-5 * np.random.default_rng(1).standard_normal(depth.size)
    found = phases_of(trial("p", time, depth + noise, curve(depth), depth_sd=1e-5))
    assert [p.label for p in found] == [
        *("loading 1", "hold 1", "unloading 1"),
        *("loading 2", "hold 2", "unloading 2"),
    ]
    assert found[0].points.start == 0
    assert found[-1].points.stop == depth.size
    assert all(a.points.stop == b.points.start for a, b in pairwise(found))


def test_columns_are_the_residuals_derivatives() -> None:
    time, depth = path(hold=5.0, cycles=2)
    model = indentation_model(trial("p", time, depth, noisy(curve(depth)), depth_sd=1e-5))
    base = fit_baseline(model).state
    wanted = [c for c in model.candidates if c.at == "all" and c.effect != "relaxation"]
    amounts = {c: 0.3 * model.effects[c.effect].prior_scale for c in wanted}
    linear = model.linearise(base, wanted)
    for k, c in enumerate(wanted):
        if model.effects[c.effect].scene is not None:
            continue  # at amplitude 0 their columns are secants to a simulated amplitude
        h = 1e-3 * amounts[c]
        z = model.residuals([State(u=base.u, amplitudes={c: h}), base])
        np.testing.assert_allclose((z[0] - z[1]) / h, linear.columns[:, k], rtol=2e-2, atol=1e-2 / h)
    z = model.residuals([State(u=base.u + 1e-3), base])
    np.testing.assert_allclose((z[0] - z[1]) / 1e-3, linear.by_u[:, 0], rtol=1e-2, atol=0.1)


@pytest.mark.parametrize(
    ("protocol", "hidden"),
    [
        ({"back": False}, {"mullins", "adhesion", "relaxation", "force-gain"}),
        ({"back": True}, {"mullins", "force-gain"}),
        ({"back": True, "cycles": 2}, {"force-gain"}),
    ],
)
def test_what_a_protocol_does_not_show(protocol: dict[str, bool], hidden: set[str]) -> None:
    """Loading alone does not identify history; one indenter in one material never the load cell's gain."""
    time, depth = path(**protocol)
    model = indentation_model(trial("p", time, depth, noisy(curve(depth))))
    state = State(u=model.start())
    model.update_nuisances(state)
    sizes = screen(model.linearise(state, model.candidates), model.effects).sizes
    seen = {c.effect for c, size in zip(model.candidates, sizes, strict=True) if size > 0.0}
    of_interest = {"mullins", "adhesion", "relaxation", "force-gain", "force-offset", "depth-offset"}
    assert of_interest - seen == hidden


def test_a_gain_shows_where_a_second_rod_pokes_the_material() -> None:
    time, depth = path()
    a = trial("a", time, depth, 1.3 * noisy(curve(depth)))
    b = trial("b", time, depth, noisy(curve(depth, 4e-3), 1), radius=4e-3)
    model = indentation_model(a, b)
    state = State(u=model.start())
    model.update_nuisances(state)
    screened = screen(model.linearise(state, model.candidates), model.effects)
    size = {c.label: s for c, s in zip(model.candidates, screened.sizes, strict=True)}
    assert size["force-gain"] == 0.0
    assert size["force-gain of rod 2.5 mm flat"] > 5.0 / 0.3


def test_relaxation_is_the_solid_of_one_time() -> None:
    """Against the closed form of a Maxwell branch beside a spring, for a ramp and a hold."""
    tau, part = 3.0, 0.4
    time, depth = path(back=False, hold=20.0)
    model = indentation_model(trial("p", time, depth, curve(depth)))
    r = model.records[0]
    elastic = r.depth / r.depth.max()
    end = 2.0  # end of the ramp [s], at a rate of 0.5 per second
    ramp = part * 0.5 * (r.time - tau * -np.expm1(-r.time / tau))
    held = part * (1.0 - 0.5 * tau * (np.exp(-(r.time - end) / tau) - np.exp(-r.time / tau)))
    lost = part * (_faded(r, tau) @ np.diff(elastic, prepend=0.0))
    np.testing.assert_allclose(lost, np.where(r.time <= end, ramp, held), atol=0.01)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("force-offset", lambda _t, _d, f: f + 0.03),
        ("force-drift", lambda t, _d, f: f + 0.01 * t),
        ("relaxation", lambda t, _d, f: relaxed(t, f, 2.0)),
        ("mullins", lambda t, d, f: f * np.where(t > 6.0, 1.0 - 0.3 * (1.0 - d / d.max()), 1.0)),
    ],
)
def test_what_is_put_in_is_the_most_promising(name: str, change: object) -> None:
    time, depth = path(hold=4.0, cycles=2)
    force = change(time, depth, curve(depth))  # type: ignore[operator]
    model = indentation_model(trial("p", time, depth, noisy(force)))
    fit = fit_baseline(model)
    screened = screen(model.linearise(fit.state, model.candidates), model.effects)
    assert model.candidates[int(np.argmax(screened.improvements(fit.z)))].effect == name


def test_a_clean_record_has_no_cause_and_an_offset_is_measured() -> None:
    time, depth = path(cycles=2)
    clean = search(indentation_model(trial("p", time, depth, noisy(curve(depth)))))
    assert clean.verdict == "none"
    found = search(indentation_model(trial("p", time, depth, noisy(curve(depth)) + 0.03)))
    assert found.chosen is not None
    assert ("force-offset",) in found.equivalent
    value, sd = next(
        e.fit.amplitude(e.candidates[0]) for e in found.explanations if e.names == ("force-offset",)
    )
    assert abs(value - 0.03) < 3.0 * sd


def test_noise_of_the_depth_is_not_found_again() -> None:
    """A simulation at the noisy depths would be noisy, and show a lack of fit."""
    time, depth = path(cycles=2)
    smallest = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        shown = depth + 2e-5 * rng.standard_normal(depth.size)
        model = indentation_model(trial("p", time, shown, noisy(curve(depth), seed + 9), depth_sd=2e-5))
        smallest.append(search(model).lack_of_fit.p_value)
    assert min(smallest) > 0.005


def test_held_out_parts_add_up() -> None:
    time, depth = path(cycles=2)
    model = indentation_model(trial("p", time, depth, noisy(curve(depth))))
    model.update_nuisances(State(u=model.start()))
    for groups in model.folds().values():
        rows = sum(model.rows(group).astype(int) for _, group in groups)
        assert (np.asarray(rows) == 1).all()
        _, group = groups[0]
        assert (
            model.subset(group, others=False).points + model.subset(group, others=True).points == model.points
        )


def test_specimens_of_one_material_have_moduli_of_their_own() -> None:
    time, depth = path()
    a = trial("a", time, depth, noisy(curve(depth)), specimen="one")
    b = trial("b", time, depth, noisy(1.2 * curve(depth), 1), specimen="two")
    model = indentation_model(a, b)
    assert model.names == ("one", "two")
    fit = fit_baseline(model)
    assert np.exp(fit.state.u[1] - fit.state.u[0]) == pytest.approx(1.2, rel=0.02)


def test_without_pokes_is_refused() -> None:
    with pytest.raises(InputError, match="expected a poke"):
        indentation_model()


def test_a_wrong_thickness_may_be_in_blocks_of_one_size() -> None:
    """Two materials with a thin and a thick block each: the thin mould may be wrong, or one material's."""
    time, depth = path()
    trials = []
    for m, height in product(("S", "T"), (0.012, 0.032)):
        t = trial(f"{m}-{height:g}", time, depth, noisy(curve(depth)), material=m)
        trials.append(replace(t, block=Block(size=(0.1, 0.1, height)), start=(0.0, 0.0, height)))
    model = indentation_model(*trials)
    effect = model.effects["thickness"]
    found = {
        c.at: [r.name for r in model.records if reaches(c, r, effect)]
        for c in model.candidates
        if c.effect == "thickness"
    }
    assert found["block 100 x 100 x 12 mm"] == ["S-0.012", "T-0.012"]
    assert found["T block 100 x 100 x 32 mm"] == ["T-0.032"]
    assert found["S"] == ["S-0.012", "S-0.032"]
    assert found["all"] == [t.id for t in trials]
    assert len(found) == 1 + 2 + 2 + 4
    assert {c.at for c in model.candidates if c.effect == "mullins"} <= {"all", "S", "T"}


def test_a_fit_of_friction_begins_where_its_column_leads() -> None:
    """A fit starts at the secant in its direction, the outermost at its bound.

    Free sliding loses no force in retraction, but a little friction does; a fit between the two could
    converge to the other secant.
    """
    time, depth = path()
    model = indentation_model(trial("p", time, depth, noisy(curve(depth))))
    base = fit_baseline(model)
    both = [c for c in model.candidates if c.effect == "friction" and c.at == "all"]
    assert [model._step(c, base.state) for c in both] == [-0.5, -0.6]
    linear = model.linearise(base.state, both)
    assert np.abs(linear.columns[:, 0] - linear.columns[:, 1]).max() < 0.1  # curves are linear in it
    null = Null(len(base.z), model.discrepancy_basis())
    started = []

    def at(_: IndentationModel, state: State, __: object) -> None:
        started.append(state.amplitudes[both[1]])
        raise ValueError

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explain, "fit", at)
        explain.explain(model, base, (both[1],), [-0.7], null)
    assert started[0] == pytest.approx(-0.6)


def test_friction_takes_force_on_the_way_back_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is a tenth at half of the depth; the simulation retracts if the record does."""
    time, depth = path()
    made, retractions = CurveCache.fetch, []

    def fetch(self: CurveCache, wanted: Sequence[CurveRequest]) -> list[Curve]:
        retractions.extend(w.retracts for w in wanted if w.name)
        lost = np.array([[0.0, 0.0], [0.5, 0.1], [1.0, 0.0]])
        return [
            replace(c, retraction_loss=lost) if w.retracts else c
            for c, w in zip(made(self, wanted), wanted, strict=True)
        ]

    monkeypatch.setattr(CurveCache, "fetch", fetch)
    model = indentation_model(trial("p", time, depth, noisy(curve(depth))))
    (record,) = model.records
    friction = next(c for c in model.candidates if c.effect == "friction")
    (force,) = model.forces(State(u=model.start(), amplitudes={friction: -0.5}))
    there, back = record.direction > 0, record.direction < 0
    into = np.interp(record.depth[back], record.depth[there], force[there])
    part = record.depth[back] / record.depth.max()
    inside = (part > 0.2) & (part < 0.95)
    expected = np.interp(part, [0.0, 0.5, 1.0], [0.0, 0.1, 0.0])
    assert 1.0 - force[back][inside] / into[inside] == pytest.approx(expected[inside], abs=5e-3)
    assert retractions
    assert all(retractions)


@pytest.mark.parametrize(
    ("at", "there"),
    [
        *(("all", True), ("S", True), ("p", False), ("T", False)),  # no thickness of a single trial
        *(("block 100 x 100 x 30 mm", True), ("S block 100 x 100 x 30 mm", True)),
        *(("block 100 x 100 x 12 mm", False), ("T block 100 x 100 x 30 mm", False)),
    ],
)
def test_an_effect_reaches_what_is_in_its_materials_blocks(at: str, there: bool) -> None:
    time, depth = path()
    model = indentation_model(trial("p", time, depth, curve(depth)))
    candidate = Candidate(effect="thickness", at=at)
    assert reaches(candidate, model.records[0], model.effects["thickness"]) == there


def test_a_card_names_the_depths_of_the_records_that_an_effect_is_in() -> None:
    """The recorded depths, from above the surface to the deepest point."""
    time, depth = path()
    a = trial("a", time, depth - 0.1e-3, noisy(curve(depth - 0.1e-3)))
    b = trial("b", time, 0.5 * depth, noisy(curve(0.5 * depth, 4e-3), 1), radius=4e-3)
    model = indentation_model(a, b)
    ranges = {c.at: model.valid_range(c)["depth_mm"] for c in model.candidates if c.effect == "depth-offset"}
    assert ranges["all"] == pytest.approx((-0.1, 1.9))
    assert ranges["rod 4 mm flat"] == pytest.approx((0.0, 1.0))


def test_forces_across_are_rows_of_their_record() -> None:
    """Lateral forces are left out with their record, and add no residual along the indenter."""
    time, depth = path()
    plain = trial("plain", time, depth, noisy(curve(depth)))
    push = noisy(curve(depth), 1)
    vector = np.column_stack([np.full(push.size, 0.02), np.full(push.size, -0.01), push])
    sided = trial("sided", time, depth, push, radius=2.5e-3)
    sided = replace(sided, record=replace(sided.record, force_vector=vector))
    model = indentation_model(plain, sided)
    n = [r.points for r in model.records]
    assert np.bincount(model.row_record).tolist() == [n[0], 3 * n[1]]
    state = State(u=model.start())
    model.update_nuisances(state)
    z = model._misfit([state])[0]
    assert np.abs(z[sum(n) :].reshape(-1, 2)).mean(axis=0) == pytest.approx([0.02, 0.01])
    assert [left.size for left in model.registered(state)] == n
    assert [sd.size for sd in model.point_sds()] == n
    fold = dict(model.folds()["leave-one-trial-out"])["sided"]
    assert model.subset(fold, others=False).points == 3 * n[1]
    assert model.subset(fold, others=True).points == n[0]
    for rows in model.folds().values():
        assert (np.sum([model.rows(own).astype(int) for _, own in rows], axis=0) == 1).all()
