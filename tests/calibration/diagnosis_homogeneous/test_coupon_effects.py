"""Each effect on homogeneous tests: its stress, and the protocols in which it is not identifiable."""

from __future__ import annotations

import numpy as np
import pytest
from diagnosis_coupon_cases import G, coupon_model, experiment, neo_hookean, ramps, trial

from calibration.diagnosis.catalogue import effects_of
from calibration.measurements._effect import Candidate
from calibration.measurements._state import State
from calibration.measurements.homogeneous import nominal_stress
from calibration.measurements.homogeneous.model import HomogeneousModel
from tisim import Material

MODES = ("uniaxial", "equibiaxial", "planar", "simple-shear")
NAMES = {
    "rate-dependence",
    "hysteresis",
    "mullins",
    "anisotropy",
    "strain-offset",
    "machine-compliance",
    "platen-friction",
    "strain-stiffening",
    "second-invariant",
    "limited-extensibility",
}
FURTHER = {
    "law-form",
    "set-between-tests",
    "test-order",
    "tension-compression-asymmetry",
    "permanent-set",
    "relaxation",
    "gauge-length",
}


def everything() -> HomogeneousModel:
    """A design in which every effect is visible."""
    cycles = ramps(1.8, 4)
    return coupon_model(
        experiment(
            trial("pull", "uniaxial", cycles),
            trial("fast", "uniaxial", cycles, rate=0.1),
            trial("press", "uniaxial", ramps(0.6, 1)),
            trial("sheet", "equibiaxial", ramps(1.5, 1)),
            trial("strip", "planar", ramps(1.7, 1)),
            trial("block", "simple-shear", ramps(1.5, 1)),
        )
    )


def with_effect(model: HomogeneousModel, name: str, amplitude: float, at: str = "all") -> list[np.ndarray]:
    candidate = Candidate(effect=name, at=at)
    return model.stresses(State(u=np.full(1, np.log(G)), amplitudes={candidate: amplitude}))


def test_the_catalogue_is_that_of_the_issue() -> None:
    effects = effects_of("homogeneous")
    assert {n for n, e in effects.items() if not e.further} == NAMES
    assert {n for n, e in effects.items() if e.further} == FURTHER
    for effect in effects.values():
        assert effect.belongs_to == (
            "rig"
            if effect.name in ("strain-offset", "machine-compliance", "platen-friction", "gauge-length")
            else "specimen"
        )
        assert effect.bounds[0] <= 0.0 < effect.bounds[1]
        assert 0.0 < effect.step < effect.prior_scale <= effect.bounds[1]


@pytest.mark.parametrize("name", sorted(NAMES))
def test_zero_is_the_baseline_and_more_is_not(name: str) -> None:
    model = everything()
    base = model.stresses(State(u=np.full(1, np.log(G))))
    for a, b, r in zip(with_effect(model, name, 0.0), base, model.records, strict=True):
        assert a == pytest.approx(b, rel=1e-12)
        assert b == pytest.approx(neo_hookean(r.mode, r.stretch), rel=2e-3, abs=1e-6 * G)
    moved = with_effect(model, name, 0.01 if name != "machine-compliance" else 1e-7)
    assert max(np.abs(a - b).max() for a, b in zip(moved, base, strict=True)) > 1e-4 * G


def test_permanent_set_is_the_part_of_the_largest_strain_that_stays() -> None:
    model = coupon_model(experiment(trial("pull", "uniaxial", ramps(1.8, 2))), further=True)
    (stress,) = with_effect(model, "permanent-set", 0.1)
    (record,) = model.records
    back = record.branch == record.branch.max()
    order = np.argsort(stress[back])
    left = np.interp(0.0, stress[back][order], record.stretch[back][order])
    assert left - 1.0 == pytest.approx(0.1 * 0.8, rel=1e-2)


@pytest.mark.parametrize(
    ("name", "amplitude", "law"),
    [
        ("strain-stiffening", 0.1, "yeoh"),
        ("second-invariant", 0.3, "mooney-rivlin"),
        ("limited-extensibility", 0.15, "eight-chain"),
    ],
)
def test_constitutive_effects_are_the_laws_of_tisim(name: str, amplitude: float, law: str) -> None:
    model = everything()
    state = State(u=np.full(1, np.log(G)), amplitudes={Candidate(effect=name): amplitude})
    # as compressible as meshes need: K/G 300
    parameters: dict[str, float | tuple[float, ...]] = {
        "strain-stiffening": {"mu": G, "stiffening": amplitude, "bulk": 300.0 * G},
        "second-invariant": {
            "c10": 0.5 * G * (1.0 - amplitude),
            "c01": 0.5 * G * amplitude,
            "bulk": 300.0 * G,
        },
        "limited-extensibility": {"mu": G, "locking": amplitude**-0.5, "bulk": 300.0 * G},
    }[name]  # type: ignore[assignment]
    material = Material(law=law, parameters=parameters)
    for r, p in zip(model.records, model.stresses(state), strict=True):
        largest = np.abs(p).max()
        assert nominal_stress(material, r.mode, r.stretch) == pytest.approx(p, rel=0.01, abs=0.01 * largest)


def test_the_rig_gives_way_by_its_own_stress() -> None:
    model = everything()
    c = 8e-7
    for r, p in zip(model.records, with_effect(model, "machine-compliance", c), strict=True):
        assert p == pytest.approx(neo_hookean(r.mode, r.stretch - c * p), rel=2e-3, abs=1e-6 * G)


def test_anisotropy_is_a_stiffer_direction() -> None:
    model = everything()
    base = model.stresses(State(u=np.full(1, np.log(G))))
    h = 1e-5
    for r, p, b in zip(model.records, with_effect(model, "anisotropy", 0.3), base, strict=True):
        energy = [0.3 * G / 8.0 * ((r.stretch + e) ** 2 - 1.0) ** 2 for e in (-h, h)]
        axes = {"equibiaxial": 2.0, "simple-shear": np.inf}.get(r.mode, 1.0)
        assert p - b == pytest.approx((energy[1] - energy[0]) / (2.0 * h) / axes, rel=1e-5, abs=1e-5 * G)


def test_an_offset_is_added_to_what_is_written_down() -> None:
    model = everything()
    for r, p in zip(model.records, with_effect(model, "strain-offset", 0.02), strict=True):
        assert p == pytest.approx(neo_hookean(r.mode, r.stretch + 0.02), rel=2e-3, abs=1e-4 * G)


def test_a_loop_closes_at_both_ends() -> None:
    model = everything()
    base = model.stresses(State(u=np.full(1, np.log(G))))[0]
    lost = with_effect(model, "hysteresis", 0.4)[0] - base
    record = model.records[0]
    assert np.abs(lost[: record.points // 4]).max() == 0.0  # first loading
    back = slice(40, 79)
    assert lost[back].min() < -0.05 * G
    assert lost[back][0] == pytest.approx(0.0, abs=0.04 * G)
    assert lost[back][-1] == pytest.approx(0.0, abs=1e-3 * G)
    assert np.abs(lost[79:118]).max() == 0.0  # reloading: unchanged by hysteresis, softened by Mullins
    worn = with_effect(model, "mullins", 0.4)[0] - base
    assert np.abs(worn[:40]).max() == 0.0
    assert worn[79:118].min() < -0.05 * G
    # Ogden and Roxburgh: at half of the largest energy, erf(1/2) / erf(1) of the softening at rest
    s = model.records[0].stretch[81:118]
    energy = (s**2 + 2.0 / s - 3.0) / (1.8**2 + 2.0 / 1.8 - 3.0)
    part = np.interp(0.5, energy, worn[81:118] / base[81:118])
    assert part == pytest.approx(-0.4 * 0.5205 / 0.8427, rel=0.01)


def test_friction_of_platens_for_little_of_it() -> None:
    model = everything()
    base = model.stresses(State(u=np.full(1, np.log(G))))
    rubbed = with_effect(model, "platen-friction", 1e-3)
    pressed = model.records[2].stretch
    assert rubbed[2][1:] / base[2][1:] - 1.0 == pytest.approx(1e-3 * pressed[1:] ** -1.5, rel=0.01)
    assert rubbed[0] == pytest.approx(base[0])  # no effect in tension
    # the formulas for small and larger friction agree at their limit
    lower, upper = (with_effect(model, "platen-friction", a)[2][1:] for a in (0.0033, 0.0034))
    assert upper / lower - 1.0 == pytest.approx(1e-4 * pressed[1:] ** -1.5, rel=0.05)


def test_what_no_protocol_shows_has_no_column() -> None:
    plain = coupon_model(experiment(trial("pull", "uniaxial", ramps(1.8, 1))))
    assert invisible(plain) == {"rate-dependence", "hysteresis", "mullins", "anisotropy"}
    for seed in range(6):  # noise near rest is no second loading
        one = trial("pull", "uniaxial", ramps(1.8, 2), stretch_sd=0.002, seed=seed)
        assert invisible(coupon_model(experiment(one))) == {"rate-dependence", "mullins", "anisotropy"}
    twice = coupon_model(experiment(trial("pull", "uniaxial", ramps(1.8, 3), stretch_sd=0.002)))
    assert invisible(twice) == {"rate-dependence", "anisotropy"}
    again = experiment(
        *(trial(n, "uniaxial", ramps(1.8, 1), rate=r, specimen="S") for n, r in (("a", 0.01), ("b", 0.1)))
    )
    assert invisible(coupon_model(again)) == {"hysteresis"}
    timeless = experiment(*(trial(n, m, ramps(1.5, 1), rate=None) for n, m in zip("ab", MODES, strict=False)))
    assert invisible(coupon_model(timeless)) == {"rate-dependence", "hysteresis", "mullins"}


def invisible(model: HomogeneousModel) -> set[str]:
    """Effects whose candidates have no column, except those without candidates."""
    linear = model.linearise(State(u=np.full(len(model.names), np.log(G))), model.candidates)
    seen = {c.effect for c, column in zip(linear.candidates, linear.columns.T, strict=True) if column.any()}
    return {c.effect for c in model.candidates} - seen


def test_a_hold_shows_the_rate() -> None:
    ramp = np.linspace(1.0, 1.5, 40)
    stretch = np.concatenate([ramp, np.full(60, 1.5)])
    time = np.concatenate([50.0 * (ramp - 1.0) / 0.5, 50.0 + np.geomspace(1.0, 5000.0, 60)])
    held = trial("held", "uniaxial", stretch, rate=None)
    held = type(held)(**{**held.__dict__, "time": time})
    model = coupon_model(experiment(held))
    assert "rate-dependence" not in invisible(model)
    record = model.records[0]
    assert record.rate[:38] == pytest.approx(0.01, rel=0.02)
    assert record.rate[-1] == pytest.approx(0.5 / 5050.0, rel=0.02)
