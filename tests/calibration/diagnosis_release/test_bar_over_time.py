"""Released beams in a fit: agreement with the diagnosis; a relaxation spectrum from two loads."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.blind.release import Truth, write_bars
from calibration.diagnosis import model_of
from calibration.diagnosis.engine.search import fit_baseline
from calibration.errors import InputError
from calibration.experiment import read
from calibration.measurements.objective import ModelObjective
from calibration.measurements.release._fem import uncorrected
from calibration.measurements.release._forward import at_frequency
from calibration.measurements.release.model import ReleaseModel
from calibration.parameters import ProtocolWindow, parametrisation, part_coordinates
from calibration.study import calibrate, measurements, parts
from tisim import Prony

NEO = parametrisation("neo-hookean")
SHEAR, BRANCHES = 6e5, ((0.25, 0.02), (0.15, 0.6))


def released(folder: Path, law: str, specs: tuple[str, ...] = ()) -> ModelObjective[ReleaseModel]:
    """Objective of a fit without FEM, since the synthetic beams follow beam theory."""
    experiment = read(folder)
    (material,) = experiment.materials
    data = measurements(
        experiment,
        material,
        parts.with_parts(parametrisation(law), specs, experiment, material),
        workers=1,
    )
    (objective,) = data.objectives
    assert isinstance(objective, ModelObjective)
    return _of_beam_theory(objective)


def _of_beam_theory(objective: ModelObjective[ReleaseModel]) -> ModelObjective[ReleaseModel]:
    model = objective.model
    model.fem = False
    model.forward = replace(model.forward, corrections=[uncorrected(r, usual=False) for r in model.records])
    return objective


def test_a_fit_and_a_diagnosis_agree(tmp_path: Path) -> None:
    """Agreement to 0.1 standard deviations: the same model, noise and modulus of vibration."""
    experiment = read(write_bars(tmp_path, Truth(), hung=(0.0,)))
    model = model_of(experiment, kind="release", workers=1)
    assert isinstance(model, ReleaseModel)
    model.fem = False
    baseline = fit_baseline(model)
    ((material, modulus),) = model.shear_moduli(baseline.state.u).items()
    weights = model.baseline.modulus_weights(material, baseline.state.u)
    sd = modulus * float(np.sqrt(weights @ baseline.covariance() @ weights))
    data = measurements(experiment, material, NEO, workers=1)
    for objective in data.objectives:
        assert isinstance(objective, ModelObjective)
        assert isinstance(objective.model, ReleaseModel)
        objective.model.fem = False
    found = calibrate(data)
    assert found.shear_modulus == pytest.approx(modulus, abs=0.1 * sd)
    assert found.shear_modulus_sd == pytest.approx(sd, rel=0.3)


def test_the_spectrum_of_a_bar_comes_back(tmp_path: Path) -> None:
    """Storage modulus and loss factor at the vibration, and the relaxation from 0.2 to 2 s."""
    folder = write_bars(
        tmp_path, Truth(shear=SHEAR, viscous=1e-9, branches=BRANCHES), hung=(0.0,), seconds=4.0
    )
    objective = released(folder, "neo-hookean", ("prony:spectrum",))
    law = objective.model.baseline.law
    u = objective.suggested_start()
    assert u is not None
    truth = Prony(fractions=tuple(g for g, _ in BRANCHES), times=tuple(t for _, t in BRANCHES))
    material = law.material(u)
    assert material.viscosity is not None
    spectrum, long_time = material.viscosity.spectrum(), law.moduli(u).shear_modulus
    period = objective.model.records[0].period / (2.0 * np.pi)
    storage, branches = at_frequency(long_time, spectrum, period)
    right, known = at_frequency(SHEAR, truth.spectrum(), period)
    assert storage == pytest.approx(right, rel=0.01)
    assert _loss(branches, period) == pytest.approx(_loss(known, period), rel=0.06)
    # the initial pose is uncertain, and with it the immediate relaxation, but not the later one
    lost = long_time * (spectrum.modulus(0.2) - spectrum.modulus(2.0)) / storage
    there = truth.spectrum()
    assert lost == pytest.approx(SHEAR * (there.modulus(0.2) - there.modulus(2.0)) / right, rel=0.2)


def _loss(branches: tuple[tuple[float, float], ...], period: float) -> float:
    return sum(g * (t / period) / (1.0 + (t / period) ** 2) for g, t in branches)


def test_a_hung_mass_does_not_teach_damping(tmp_path: Path) -> None:
    """Its free vibration is left out of a fit over time, with a remark; a fit without time uses it."""
    folder = write_bars(tmp_path, Truth(), hung=(0.0, 0.01))
    plain = released(folder, "neo-hookean")
    over_time = released(folder, "neo-hookean", ("prony:1",))
    assert plain.model.left_out() == []
    assert [s.partition(":")[0] for s in over_time.model.left_out()] == ["run-1"]
    rows = over_time.model.row_record[over_time.model.noise.used]
    whole = plain.model.row_record[plain.model.noise.used]
    assert (rows == 0).sum() == (whole == 0).sum()
    assert 0 < (rows == 1).sum() < 0.5 * (whole == 1).sum()


def test_where_a_mass_hangs(tmp_path: Path) -> None:
    """On the upper edge the lever arm grows as the end face rotates, and the beam settles lower.

    Heights without a load, or outside the face, are refused.
    """
    middle, edge = (
        read(write_bars(tmp_path / str(z), Truth(), hung=(0.05,), tip_force_height_mm=z)) for z in (0.0, 10.0)
    )
    drops = []
    for experiment in (middle, edge):
        (objective,) = measurements(experiment, "S0", NEO, workers=1).objectives
        assert isinstance(objective, ModelObjective)
        state = objective.state(np.log([6e5, 300.0]))
        drops.append(-objective.model.tip_height(0, state, np.array([60.0]))[0])
    assert 1.005 < drops[1] / drops[0] < 1.05
    with pytest.raises(
        InputError, match=r"tip_force_height_mm: expected a height on the end face, -10 to 10"
    ):
        read(write_bars(tmp_path / "far", Truth(), hung=(0.05,), tip_force_height_mm=12.0))
    with pytest.raises(InputError, match=r"tip_force_N: missing, expected it beside tip_force_height_mm"):
        read(write_bars(tmp_path / "none", Truth(), hung=(0.0,), tip_force_height_mm=5.0))


def test_a_bar_that_does_not_swing_has_no_spectrum(tmp_path: Path) -> None:
    experiment = read(write_bars(tmp_path, Truth(viscous=0.1), hung=(0.0,)))
    with pytest.raises(InputError, match=r"run-0.*for --time prony:1"):
        parts.check(experiment, ["S0"], ("prony:1",))


def test_storage_modulus_and_branches() -> None:
    """A Maxwell element adds G w^2 tau^2 / (1 + w^2 tau^2); branches are fractions of the storage modulus."""
    shear, branches = at_frequency(1e3, Prony(fractions=(0.5,), times=(0.02,)).spectrum(), 0.02)
    assert shear == pytest.approx(1250.0)
    assert branches == ((pytest.approx(0.4), 0.02),)


def test_the_window_reaches_to_what_damps(tmp_path: Path) -> None:
    experiment = read(write_bars(tmp_path, Truth(), hung=(0.0,)))
    law = parts.with_parts(NEO, ("prony:spectrum",), experiment, "S0")
    window = law.parts[0].window
    assert 0.0005 < window.first < 0.003
    assert 1.4 < window.last < 1.6
    assert part_coordinates("prony:1", ProtocolWindow(first=1.0, last=2.0, peaks=0)).field == "viscosity"
