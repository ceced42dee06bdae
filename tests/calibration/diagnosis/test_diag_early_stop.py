"""Beams as the paper's rule stops them: where one long run has them at that time, however long it took."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.diagnosis.beams import simulators
from calibration.diagnosis.beams.simulators import SIMULATORS
from tisim import Beam, Status, material_from_moduli, simulate
from tisim.paper_stop import paper_stop

EARLY = SIMULATORS["early-stop"]


def released(shear: float, length: float) -> Beam:
    material = material_from_moduli("neo-hookean", shear=shear, bulk=100.0 * shear)
    return Beam(material=material, length=length, rings=1, layer=0.01, solver=EARLY.fidelity.solver)


@pytest.fixture(scope="module")
def beams() -> list[Beam]:
    # the softest of three alike takes longest; another length in between
    return [released(60e3, 0.05), released(30e3, 0.06), released(40e3, 0.05), released(15e3, 0.05)]


def test_beams_are_where_the_rule_stops_them(beams: list[Beam]) -> None:
    found = EARLY.run(beams, workers=1)
    times = []
    for beam, stopped in zip(beams, found, strict=True):
        whole = replace(beam, solver=replace(beam.solver, duration=1.0))
        run = simulate([whole], workers=1)[0]
        stop = paper_stop(run, run.mesh.nodes)
        assert stop is not None
        assert stopped.ok
        at = int(np.argmin(np.abs(run.load - stop.time)))
        np.testing.assert_allclose(stopped.positions[-1], run.positions[at], atol=1e-9)
        times.append(stop.time)
    assert max(times) > 1.2 * min(times)


def test_a_beam_that_the_rule_never_stops_says_so(beams: list[Beam], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulators, "_LONGEST", 0.1)  # the rule asks for 0.15 s
    monkeypatch.setattr(simulators, "_SHORTEST", 0.1)
    found = EARLY.run(beams[:1], workers=1)
    assert [r.status for r in found] == [Status.UNFINISHED]
