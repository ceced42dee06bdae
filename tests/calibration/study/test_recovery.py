"""Data from other code (a bench by another solver; photographs made by this suite) recover the truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from _folders import measured
from made_beams import made

import tisim
from calibration.experiment import read
from calibration.inference import Problem, identify, polish, profile
from calibration.parameters import parametrisation
from calibration.study import FitOptions, calibrate, measurements

SHAPES = {"mooney-rivlin": {"second_share": 0.35}, "ogden": {"alpha": 4.0}, "arruda-boyce": {"locking": 2.5}}


@pytest.mark.slow
@pytest.mark.parametrize("material", ["S0", "S0.5", "S1"])
def test_the_clean_bench(material: str) -> None:
    folder = measured() / "bench" / "clean"
    experiment = read(folder)
    found = calibrate(
        measurements(experiment, material, parametrisation("neo-hookean")),
        options=FitOptions(),
    )
    truth = yaml.safe_load((folder / "truth.yaml").read_text())["shear_modulus_Pa"][material]
    assert found.status == "converged"
    assert found.shear_modulus == pytest.approx(truth, rel=0.02)
    assert 0.8 < found.reduced_chi2 < 1.25


@pytest.mark.slow
@pytest.mark.parametrize("law", tisim.laws.names())
def test_intervals_hold_the_truth(law: str, tmp_path: Path) -> None:
    """95 % intervals contain the truth for at least 90 % of 20 seeds; polish only, from a perturbed start."""
    p = parametrisation(law)
    # the softest beam that each law can support: St Venant-Kirchhoff collapses at the clamp below 50 kPa, on
    # a mesh as fine as that of the data
    shear = 50e3 if law == "st-venant-kirchhoff" else 12e3
    values = {"shear_modulus": shear, "bulk_ratio": 400.0, **SHAPES.get(law, {})}
    truth = np.array([c.inside(values[c.name]) for c in p.coordinates])
    material = p.material(truth, density=1000.0)
    inside = []
    for seed in range(20):
        folder = made(
            tmp_path / str(seed),
            material,
            lengths_mm=(50.0, 100.0),
            bridges_mm=(150.0,),
            photographs=2,
            seed=seed,
        )
        data = measurements(read(folder), "S0", p, workers=1)
        problem = Problem(parametrisation=p, objectives=data.objectives)
        end = polish(problem, truth + 0.3 * p.spread)
        known = identify(p, end.u, end.jacobian, reduced_chi2=1.0)
        inside.append([e.low <= values[e.name] <= e.high for e in profile(problem, end, known)])
    share = np.mean(inside, axis=0)
    assert (share >= 0.9).all(), dict(zip(p.names, share, strict=True))
