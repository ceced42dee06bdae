"""Relaxation found in a homogeneous test predicts creep of a beam, both made by the blind laboratory."""

from __future__ import annotations

from pathlib import Path

import pytest

import calibration
from benchmarks.blind.beams.model import Beam
from benchmarks.blind.timed.cases import Case, CouponTest, HungBeam, write
from benchmarks.blind.timed.course import Course
from benchmarks.blind.timed.material import Prony, Solid

G = 3e4
TERMS = tuple(10.0 ** (k / 2) for k in range(-1, 6))
SOLID = Solid(mu=(G,), alpha=(2.0,), prony=Prony(fractions=(0.06,) * len(TERMS), times=TERMS))
PULL = Course(start=1.0, samples=30).ramp(1.2, 0.1).hold(300.0)


@pytest.mark.slow
def test_relaxation_of_a_coupon_predicts_the_creep_of_a_beam(tmp_path: Path) -> None:
    beam = Beam(length=0.09, bridge=False, mu=G, density=1000.0, radius=0.010)
    case = Case(
        seed=1,
        kind="across",
        solid=SOLID,
        coupons=(CouponTest(id="pull", mode="uniaxial", course=PULL, stress_sd=100.0),),
        beams=(HungBeam(id="beam", beam=beam, stated_length=0.09, times=(1.0, 30.0, 300.0)),),
    )
    write(case, tmp_path / "made")
    found = calibration.predict(
        tmp_path / "made", calibrate="pull", predict="beam", law="neo-hookean", workers=1
    )
    print(found)
    p = found.prediction
    assert [r.name for r in p.records] == ["beam at 1 s", "beam at 30 s", "beam at 300 s"]
    skill = found.skill["outlines"]
    assert skill is not None
    assert skill > 0.8
    assert p.rms(p.records, "extended") < 2.0 * p.noise(p.records)
    assert found.coverage["outlines"]["extended"] > 0.85
