"""Measurements that a fit follows over time: compression, indentation, and all of them together."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from timed_coupons import REST, SOLID, TRUTH, trial

from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Solid
from calibration.errors import InputError
from calibration.experiment.model import Experiment, MaterialBelief, PokeRecord, PokeTrial, Trial
from calibration.inference import Problem, guess, identify, polish
from calibration.measurements._baseline import Baseline
from calibration.measurements._kinds import compared
from calibration.measurements._state import State
from calibration.measurements.compression.model import CompressionModel
from calibration.measurements.indentation._record import records_of
from calibration.measurements.indentation.over_time import OVER_TIME
from calibration.parameters import parametrisation
from calibration.study import parts
from calibration.study.measurements import measurements
from tisim import Block

VISCOUS = replace(SOLID, softening=None)
WORN = replace(SOLID, prony=Prony())
HELD = REST.ramp(0.8, 0.1).hold(60.0).ramp(0.65, 0.1).hold(60.0)
CYCLED = REST.ramp(0.85, 0.05).ramp(0.95, 0.05).ramp(0.65, 0.05).ramp(0.95, 0.05)


def experiment(*trials: Trial) -> Experiment:
    beliefs = {t.material: MaterialBelief(name=t.material) for t in trials}
    return Experiment(name="e", folder=Path(), notes="", materials=beliefs, trials=trials, digest="")


def poke(*, ramp: float, hold: float, noise: float = 0.0) -> PokeTrial:
    """Indentation to 1 mm and back, with ten rows per second."""
    end = 2.0 * ramp + hold
    time = np.linspace(0.0, end, round(10.0 * end) + 1)
    depth = 1e-3 * np.interp(time, [0.0, ramp, ramp + hold, end], [0.0, 1.0, 1.0, 0.0])
    depth = depth + noise * np.random.default_rng(1).standard_normal(time.size)
    return PokeTrial(
        id="p",
        material="M",
        block=Block(size=(0.05, 0.05, 0.02)),
        rod_radius=0.004,
        rod_tip="hemisphere",
        start=(0.0, 0.0, 0.02),
        direction=(0.0, 0.0, -1.0),
        record=PokeRecord(time=time, depth=depth, force=1e3 * depth),
        force_sd=0.01,
        depth_sd=noise,
    )


@pytest.mark.parametrize(
    ("solid", "course", "specs"),
    [(VISCOUS, HELD, ("prony:2",)), (WORN, CYCLED, ("mullins",))],
)
def test_a_cylinder_is_that_of_the_blind_laboratory(
    solid: Solid, course: Course, specs: tuple[str, ...]
) -> None:
    own = experiment(trial("c", "uniaxial", course, solid=solid))
    parts.check(own, ["M"], specs)
    law = parts.with_parts(parametrisation("ogden").holding("bulk_ratio"), specs, own, "M")
    ((kind, _),) = compared(own)
    assert kind.name == "compression"
    model = CompressionModel(own, baseline=Baseline.of_law(own.trials, law), last=0.4)
    u = law.start(shear=SOLID.shear_modulus)
    for k, c in enumerate(law.coordinates):
        u[k] = c.inside(TRUTH[c.name]) if c.name in TRUTH else u[k]
    state = State(u=np.concatenate([u, np.zeros(len(model.baseline.extras))]))
    (stress,) = model.stresses(state)
    (record,) = model.records
    assert record.course is not None
    assert record.course.pushes
    assert np.abs(stress - record.stress).max() < 1e-3 * np.abs(record.stress).max()


def test_a_fit_of_a_cylinder_finds_the_truth() -> None:
    own = experiment(trial("c", "uniaxial", HELD, solid=VISCOUS, noise=0.005, seed=2))
    law = parts.with_parts(parametrisation("ogden"), ("prony:2",), own, "M").holding("bulk_ratio")
    problem = Problem(parametrisation=law, objectives=measurements(own, "M", law, workers=1).objectives)
    start = guess(problem)
    assert start is not None
    end = polish(problem, start)
    assert end.converged
    chi2 = float(end.residuals @ end.residuals) / problem.points
    found = {e.name: e for e in identify(law, end.u, end.jacobian, reduced_chi2=chi2).estimates}
    fitted = [n for n in TRUTH if n in found]
    assert len(fitted) == 6
    assert all(found[n].low <= TRUTH[n] <= found[n].high for n in fitted)


def test_the_window_is_that_of_all_tests_together() -> None:
    both = experiment(trial("c", "uniaxial", REST.ramp(1.5, 0.1).hold(300.0)), poke(ramp=0.5, hold=20.0))
    law = parts.with_parts(parametrisation("ogden"), ("prony:1",), both, "M")
    window = law.parts[0].window
    assert window.first == pytest.approx(0.4)  # from the rows of the ramp
    assert window.last == pytest.approx(300.0, rel=0.05)
    alone = OVER_TIME.window(experiment(both.trials[1]))
    assert alone.last == pytest.approx(20.0, rel=0.05)
    assert alone.peaks == 1


@pytest.mark.parametrize("noise", [0.0, 5e-6])
def test_an_indentation_has_its_points_on_its_course(noise: float) -> None:
    made = poke(ramp=0.5, hold=60.0, noise=noise)
    (record,) = records_of([made], courses=True)
    assert record.course is not None
    assert (np.diff(record.course.time) >= 0.0).all()
    assert record.course.depth[record.course.at] == pytest.approx(record.depth)
    assert record.course.time[record.course.at] == pytest.approx(record.time)
    held = np.flatnonzero(record.direction == 0.0)
    assert record.count[held[0]] == 1.0  # closest at the beginning of the hold
    assert record.count[held].max() > 10.0
    (corner,) = np.flatnonzero(np.isclose(record.course.time, made.record.time[5]))[:1]
    assert record.course.depth[corner] == pytest.approx(1e-3, rel=0.05)
    part = record.only(record.depth < 0.5e-3)
    assert part.course is not None
    assert part.course.time.size == record.course.time.size
    assert part.course.depth[part.course.at] == pytest.approx(part.depth)


def test_what_was_below_the_surface_at_first_was_touched_before() -> None:
    made = poke(ramp=0.5, hold=5.0)
    late = replace(
        made,
        record=PokeRecord(
            time=made.record.time[2:], depth=made.record.depth[2:], force=made.record.force[2:]
        ),
    )
    (record,) = records_of([late], courses=True)
    assert record.course is not None
    assert record.course.depth[0] == 0.0
    assert record.course.time[0] == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize(
    ("trials", "specs", "sentence"),
    [
        (
            (poke(ramp=1.0, hold=5.0),),
            ("prony:1", "mullins"),
            "trial p: --damage: expected no indentation, whose",
        ),
        (
            (poke(ramp=1.0, hold=5.0),),
            ("fibres",),
            "trial p: --fibres: expected no indentation, whose strain",
        ),
        (
            (trial("c", "uniaxial", CYCLED, solid=WORN),),
            ("fibres",),
            "trial c: --fibres: expected no compression",
        ),
    ],
)
def test_what_is_not_followed_is_said(
    trials: tuple[Trial, ...], specs: tuple[str, ...], sentence: str
) -> None:
    with pytest.raises(InputError) as error:
        parts.check(experiment(*trials), ["M"], specs)
    assert str(error.value).startswith(sentence)
    assert "\n" not in str(error.value)
