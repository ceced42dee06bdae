"""Beams stopped by the paper's rule: equal to one long run at that time, for any duration of the runs."""

from dataclasses import replace

import numpy as np
import pytest
from diag_beams import SHEAR, beam_model, tiny

from calibration.measurements._effect import Candidate
from calibration.measurements._state import Linearisation, State
from calibration.measurements.outlines import simulators
from calibration.measurements.outlines.model import OutlineModel
from calibration.measurements.outlines.simulators import SIMULATORS
from tisim import Beam, Status, material_from_moduli, paper_stop, simulate

EARLY = SIMULATORS["early-stop"]


def released(shear: float, length: float) -> Beam:
    material = material_from_moduli("neo-hookean", shear_modulus=shear, bulk_modulus=100.0 * shear)
    return Beam(
        material=material,
        length=length,
        radial_elements=1,
        axial_element_size=0.01,
        solver=EARLY.fidelity.solver,
    )


@pytest.fixture(scope="module")
def beams() -> list[Beam]:
    # the softest of the three beams of 50 mm takes longest; the one of 60 mm lies in between
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


# -- the model: beams at rest are the surrogate for derivatives --


@pytest.fixture(scope="module")
def early(tmp_path_factory: pytest.TempPathFactory) -> OutlineModel:
    """Two short beams photographed at rest."""
    experiment = tiny(tmp_path_factory.mktemp("rest"), lengths_mm=(50.0, 60.0))
    model = beam_model(experiment, simulator=EARLY, workers=1)
    model.update_nuisances(State(u=np.full(1, np.log(SHEAR))))
    return model


def columns(model: OutlineModel, names: list[str]) -> tuple[Linearisation, list[Candidate]]:
    some = [next(c for c in model.candidates if c.effect == n and c.at == "all") for n in names]
    return model.linearise(State(u=np.full(1, np.log(SHEAR))), some), some


def test_a_beam_that_goes_on_to_rest_is_where_rest_is(early: OutlineModel) -> None:
    """The column of the fault is the difference of the residuals at rest and at the stop.

    An amplitude of 1 gives static equilibrium, where the experiment was photographed and chi-square is small.
    """
    linear, (fault,) = columns(early, ["not-at-equilibrium"])
    state = replace(linear.state, amplitudes={fault: 1.0})
    stopped, rested = early.residuals([linear.state, state])
    np.testing.assert_allclose(linear.z, stopped, atol=1e-9)
    np.testing.assert_allclose(rested - stopped, linear.columns[:, 0], atol=1e-6 * np.abs(stopped).max())
    assert rested @ rested < 0.05 * (stopped @ stopped)


def test_what_else_may_be_is_seen_in_beams_at_rest(early: OutlineModel) -> None:
    """Columns of moduli and effects are those of a static simulator on the same mesh."""
    names = ["residual-curvature", "coarse-mesh"]
    guided, some = columns(early, names)
    still = beam_model(early.experiment, simulator=replace(EARLY.as_surrogate, name="still"), workers=1)
    still.noise, still._updated = early.noise, True
    plain = still.linearise(guided.state, some)
    np.testing.assert_allclose(guided.columns, plain.columns, atol=1e-6 * np.abs(plain.columns).max())
    np.testing.assert_allclose(guided.by_u, plain.by_u, atol=1e-6 * np.abs(plain.by_u).max())
    assert np.abs(guided.z - plain.z).max() > 1.0
