"""The effects on beams, one by one: changes of the scene and of the observed outline with the amplitude."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diag_beams import SHEAR, beam_model, tiny

from calibration.diagnosis.effects.outlines import EFFECTS
from calibration.measurements._effect import Candidate
from calibration.measurements._state import Linearisation, State
from calibration.measurements.outlines import COARSE
from calibration.measurements.outlines._effect import Situation
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.simulators import TISIM

# the names of the catalogue
CATALOGUE = [
    "density",
    "grip-length",
    "clamp-compliance",
    "clamp-tilt",
    "gravity-tilt",
    "camera-roll",
    "free-length",
    "grip-squeeze",
    "radius",
    "taper",
    "stiffness-gradient-axial",
    "stiffness-gradient-transverse",
    "residual-curvature",
    "void",
    "strain-stiffening",
    "compressibility",
    "creep",
    "clamp-gap",
    "image-scale",
    "lens-distortion",
    "skin",
    "added-mass",
]
SIMULATOR = ["locking", "coarse-mesh", "not-at-equilibrium"]
CAMERA = {"camera-roll", "image-scale", "lens-distortion"}
RIG = {
    "grip-length",
    "clamp-compliance",
    "clamp-tilt",
    "gravity-tilt",
    "free-length",
    "grip-squeeze",
    "clamp-gap",
}
BARE = replace(TISIM, reference=None)  # made the data: there is no mesh error to correct
STATE = State(u=np.array([np.log(SHEAR)]))


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> OutlineModel:
    experiment = tiny(tmp_path_factory.mktemp("beams"), lengths_mm=(50.0, 100.0), bridges_mm=(150.0,))
    found = beam_model(experiment, simulator=BARE, workers=1)
    found.update_nuisances(STATE)
    return found


@pytest.fixture(scope="module")
def linear(model: OutlineModel) -> Linearisation:
    return model.linearise(STATE, model.candidates)


def stepped(name: str, part: float = 1.0, on: State = STATE) -> State:
    """State with an additional step of an effect, in all beams."""
    more = Candidate(effect=name, position=EFFECTS[name].positions[0], alternatives=0)
    return State(u=on.u, amplitudes={**on.amplitudes, more: part * EFFECTS[name].step})


def test_the_effects_are_those_of_the_catalogue() -> None:
    assert set(EFFECTS) == {*CATALOGUE, *SIMULATOR}
    assert {n for n, e in EFFECTS.items() if e.belongs_to == "simulator"} == set(SIMULATOR)
    assert {n for n, e in EFFECTS.items() if e.belongs_to == "camera"} == CAMERA
    assert {n for n, e in EFFECTS.items() if e.belongs_to == "rig"} == RIG


@pytest.mark.parametrize("name", CATALOGUE)
def test_an_effect_is_described(name: str) -> None:
    effect = EFFECTS[name]
    assert effect.name == name
    low, high = effect.bounds
    assert low <= 0.0 < high
    assert 0.0 < abs(effect.step) < effect.prior_scale <= high
    assert low <= effect.step <= high
    assert effect.sentence
    assert effect.remedy
    assert not effect.sentence.endswith(".")
    assert not effect.remedy.endswith(".")
    assert (effect.image is not None) or effect.bends
    assert effect.in_file(1.0) == effect.per_unit
    units = {"_mm": 1e3, "_deg": 180.0 / np.pi, "_g": 1e3, "per_100mm": 0.1, "per_radius": 0.01}
    for ending, per_unit in units.items():
        if effect.parameter.endswith(ending):
            assert effect.per_unit == pytest.approx(per_unit)


@pytest.mark.parametrize("name", CATALOGUE)
def test_none_of_an_effect_leaves_the_scene_as_it_is(model: OutlineModel, name: str) -> None:
    effect = EFFECTS[name]
    none = State(u=STATE.u, amplitudes={Candidate(effect=name, position=effect.positions[0]): 0.0})
    for i, t in enumerate(model.trials):
        ideal = model.scenes.beam(i, STATE, time=10.0, fidelity=COARSE)
        assert model.scenes.beam(i, none, time=10.0, fidelity=COARSE) == ideal
        assert model.scenes.key(i, none, time=10.0) == model.scenes.key(i, STATE, time=10.0)
        assert model.scenes.images(i, none, time=10.0) == []
        situation = Situation(trial=t, time=10.0, position=effect.positions[0])
        if effect.applies_to(t) and name not in ("strain-stiffening", "void", "compressibility", "creep"):
            assert effect.bend(ideal, 0.0, situation) == ideal
        points = np.array([[0.01, 0.02], [0.05, -0.01]])
        if effect.image is not None:
            assert effect.image(points, 0.0, situation) == pytest.approx(points)


@pytest.mark.parametrize("name", ["strain-stiffening", "void", "compressibility", "creep"])
def test_very_little_of_an_effect_is_very_little(model: OutlineModel, name: str) -> None:
    before, after = model.solutions.solve([STATE, stepped(name, 1e-5)])
    for p, q in zip(before, after, strict=True):
        assert p is not None
        assert q is not None
        assert np.abs(p.positions[-1] - q.positions[-1]).max() < 2e-6


@pytest.mark.parametrize("name", sorted(CAMERA))
def test_what_the_camera_does_needs_no_other_scene(model: OutlineModel, name: str) -> None:
    for i in range(len(model.trials)):
        key = model.scenes.key(i, STATE, time=10.0)
        assert model.scenes.key(i, stepped(name), time=10.0) == key
        assert len(model.scenes.images(i, stepped(name), time=10.0)) == 1


@pytest.mark.parametrize("name", [n for n in CATALOGUE if n not in CAMERA])
def test_what_bends_the_beam_is_another_scene(model: OutlineModel, name: str) -> None:
    effect = EFFECTS[name]
    for i, t in enumerate(model.trials):
        other = model.scenes.key(i, stepped(name), time=10.0)
        assert (other != model.scenes.key(i, STATE, time=10.0)) == effect.applies_to(t)


def test_only_creep_differs_by_time(model: OutlineModel) -> None:
    for name in CATALOGUE:
        effect = EFFECTS[name]
        early = model.scenes.key(0, stepped(name), time=10.0)
        late = model.scenes.key(0, stepped(name), time=1000.0)
        assert (early != late) == effect.timed == (name == "creep")
    beams = [model.scenes.beam(0, stepped("creep"), time=t, fidelity=COARSE) for t in (1, 10, 1000)]
    shear = [b.material.parameters["mu"] for b in beams]
    assert shear == pytest.approx([SHEAR, SHEAR * (1.0 - 0.01), SHEAR * (1.0 - 0.03)])


@pytest.mark.parametrize("name", CATALOGUE)
def test_a_step_moves_the_outlines_that_it_may_and_no_others(
    model: OutlineModel, linear: Linearisation, name: str
) -> None:
    effect = EFFECTS[name]
    for k, c in enumerate(linear.candidates):
        if c.effect != name:
            continue
        for i, t in enumerate(model.trials):
            rows = np.concatenate([np.full(p.basis.shape[1], p.beam == i) for p in model.records])
            may = effect.applies_to(t) and c.at in ("all", t.material, t.id)
            size = np.linalg.norm(linear.columns[rows, k]) if rows.any() else 0.0
            # whitening mixes photographs only through shared nuisances: there are none, all is known exactly
            assert (size > 1e-6) == may, (c.label, t.id, size)


@pytest.mark.parametrize("name", CATALOGUE)
def test_half_a_step_does_half(model: OutlineModel, name: str) -> None:
    step, whole, half = EFFECTS[name].step, stepped(name), stepped(name, 0.5)
    base, one, less = model.solutions.solve([STATE, whole, half])
    at = model.solutions.values_of(base, STATE)
    full = (model.solutions.values_of(one, whole) - at) / step
    part = (model.solutions.values_of(less, half) - at) / (0.5 * step)
    assert np.linalg.norm(full - part) < 0.1 * np.linalg.norm(part)


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_is_there_and_a_step_add_up(model: OutlineModel, name: str) -> None:
    """An amplitude and a step on it give the scene and the image of their sum."""
    effect = EFFECTS[name]
    place = effect.positions[0]
    for i, t in enumerate(model.trials):
        if not effect.applies_to(t):
            continue
        at = "all" if effect.in_all else t.id
        c = Candidate(effect=name, at=at, position=place)
        there = State(u=STATE.u, amplitudes={c: 2.0 * effect.step})
        summed = State(u=STATE.u, amplitudes={c: 3.0 * effect.step})
        assert model.scenes.inside(i, stepped(name, on=there)) == pytest.approx(
            model.scenes.inside(i, summed)
        )
        points = np.array([[0.01, 0.02], [0.05, -0.01]])
        both, whole = points, points
        for image in model.scenes.images(i, stepped(name, on=there), time=10.0):
            both = image(both)
        for image in model.scenes.images(i, summed, time=10.0):
            whole = image(whole)
        assert both == pytest.approx(whole)


def test_effects_compose(model: OutlineModel) -> None:
    amplitudes = {
        Candidate(effect="residual-curvature"): 0.5,
        Candidate(effect="residual-curvature", at="S0"): 0.25,
        Candidate(effect="clamp-tilt"): 0.01,
        Candidate(effect="creep"): 0.05,
        Candidate(effect="strain-stiffening"): 0.3,
        Candidate(effect="density"): 0.02,
    }
    beam = model.scenes.beam(0, State(u=STATE.u, amplitudes=amplitudes), time=100.0, fidelity=COARSE)
    assert beam.imperfections.curvature == pytest.approx(0.75)
    assert beam.clamp_imperfections.tilt == pytest.approx(0.01)
    assert beam.material.law == "stiffening-neo-hookean"
    assert beam.material.parameters["stiffening"] == pytest.approx(0.3)
    assert beam.material.density == pytest.approx(1020.0)
    from tisim import laws

    assert laws.get(beam.material.law).moduli(beam.material.parameters).shear_modulus == pytest.approx(
        0.9 * SHEAR
    )


def test_signs_are_those_that_are_written(model: OutlineModel) -> None:
    """Sign of the free end's vertical motion for a positive amplitude of each effect."""
    up = ["clamp-tilt", "residual-curvature", "camera-roll"]
    down = ["added-mass", "creep", "density", "grip-length", "free-length", "clamp-compliance", "taper"]
    up += ["skin", "strain-stiffening", "radius"]
    down += ["void", "stiffness-gradient-axial", "compressibility"]
    for name in up + down:
        i = next(
            k for k, t in enumerate(model.trials) if t.free_length == 0.1 and t.supports == "clamped-free"
        )
        photo = next(p for p, q in enumerate(model.records) if q.beam == i)
        ends = []
        for state in (STATE, stepped(name, float(np.sign(EFFECTS[name].step)))):
            (results,) = model.solutions.solve([state])
            result = results[photo]
            assert result is not None
            tip = result.positions[-1]
            rest = result.mesh.nodes
            end = tip[rest[:, 0] > rest[:, 0].max() - 1e-9].mean(axis=0)[[0, 2]][None]
            for image in model.scenes.images(i, state, time=10.0):
                end = image(end)
            ends.append(end[0, 1])
        assert (ends[1] > ends[0]) == (name in up), name


def test_density_is_a_modulus(linear: Linearisation) -> None:
    k = linear.candidates.index(Candidate(effect="density"))
    density, modulus = linear.columns[:, k], linear.by_u[:, 0]
    cosine = abs(density @ modulus) / np.linalg.norm(density) / np.linalg.norm(modulus)
    assert cosine > 0.9999


def test_a_bridge_is_slack_where_its_clamps_are_nearer_than_its_length(model: OutlineModel) -> None:
    i = next(k for k, t in enumerate(model.trials) if t.supports == "clamped-clamped")
    beam = model.scenes.beam(i, stepped("clamp-gap"), time=10.0, fidelity=COARSE)
    assert beam.length == pytest.approx(0.1502)
    seen = beam.length + beam.clamp_imperfections.far_shift[0]
    assert seen == pytest.approx(0.150)  # position of the far clamp
    still = replace(beam.clamp_imperfections, far_shift=(0.0, 0.0))
    ideal = model.scenes.beam(i, STATE, time=10.0, fidelity=COARSE)
    assert replace(beam, length=0.15, clamp_imperfections=still) == ideal


def test_a_grip_that_holds_deeper_frees_both_ends_of_a_bridge(model: OutlineModel) -> None:
    for i, t in enumerate(model.trials):
        beam = model.scenes.beam(i, stepped("grip-length"), time=10.0, fidelity=COARSE)
        ends = 2 if t.supports == "clamped-clamped" else 1
        assert beam.length == pytest.approx(t.free_length + ends * EFFECTS["grip-length"].step)


def test_photographs_share_what_they_can(tmp_path: Path) -> None:
    """Photographs at several times share one solved scene, unless an effect depends on time."""
    experiment = tiny(tmp_path, lengths_mm=(50.0,), times=(10.0, 100.0, 1000.0))
    model = beam_model(experiment, simulator=BARE, workers=1)
    same = model.results(STATE)
    assert same[0] is same[1] is same[2]
    creeping = model.results(State(u=STATE.u, amplitudes={Candidate(effect="creep"): 0.05}))
    sag = [r.positions[-1][:, 2].min() for r in creeping]
    assert sag[0] > sag[1] > sag[2]


@pytest.mark.parametrize("loss", [0.0, 0.1, 0.3, 0.6, 0.85])
def test_a_void_bends_as_much_as_one_with_sharp_ends(model: OutlineModel, loss: float) -> None:
    """The void adds the same flexibility (beam theory) as 15 mm of beam without this fraction of E I."""
    trial = model.trials[0]
    ideal = model.scenes.beam(0, STATE, time=10.0, fidelity=COARSE)
    situation = Situation(trial=trial, time=10.0, position=0.5)
    hole = EFFECTS["void"].bend(ideal, loss, situation).imperfections.void  # type: ignore[misc]
    assert hole is not None
    assert hole.position == pytest.approx(0.5 * trial.free_length)
    x = np.linspace(-hole.length, hole.length, 40001)
    out = np.clip((np.abs(x) - 0.5 * (hole.length - hole.edge)) / hole.edge, 0.0, 1.0)
    left = 1.0 - hole.fraction * np.cos(0.5 * np.pi * out) ** 2
    assert np.trapezoid(1.0 / left - 1.0, x) == pytest.approx(0.015 * loss / (1.0 - loss), rel=1e-6)
