"""Dice as an objective, against a cylinder's closed form and an independent elastica."""

from __future__ import annotations

import numpy as np
import pytest
from planar_elastica import edges

import tisim
from calibration.errors import InputError
from calibration.experiment import BeamTrial, Capture, MaterialBelief, TracedOutline
from calibration.inference import CmaOptions, OfMaterial, Problem, search
from calibration.measurements.outlines import Fidelity
from calibration.measurements.outlines.dice import SCALE, DiceObjective
from calibration.parameters import parametrisation

DENSITY, RATIO = 1050.0, 1000.0
BELIEF = MaterialBelief(name="soft", density=DENSITY)


def neo_hookean(shear: float) -> tisim.Material:
    return tisim.material_from_moduli("neo-hookean", shear_modulus=shear, bulk_modulus=RATIO * shear)


def trial(upper, lower, *, length, radius, gravity=-9.81):
    outline = TracedOutline(upper=upper, lower=lower, sd=1e-4, correlation=5e-3)
    return BeamTrial(
        id="cantilever",
        material="soft",
        section=tisim.Circle(radius=radius),
        free_length=length,
        grip_length=0.02,
        supports="clamped-free",
        gravity=(0.0, 0.0, gravity),
        captures=(Capture(time=60.0), Capture(time=100.0, outline=outline)),
    )


def straight(shift):
    """An unloaded 100 mm beam of 20 mm diameter, traced `shift` too high."""
    x = np.linspace(0.001, 0.1, 60)
    edge = [np.column_stack([x, np.full_like(x, shift + side)]) for side in (0.01, -0.01)]
    return trial(*edge, length=0.1, radius=0.01, gravity=0.0)


def bent(shear):
    """A slender beam that sags by a third of its length; shear and clamp change this by 0.5 %."""
    young = 9 * RATIO / (3 * RATIO + 1) * shear
    upper, lower = edges(young=young, density=DENSITY, length=0.1, radius=0.003)
    assert lower[-1, 1] < -0.03
    return trial(upper, lower, length=0.1, radius=0.003)


@pytest.mark.parametrize("shift", [0.0005, 0.002])
def test_overlap_of_a_displaced_cylinder_is_that_of_two_circles(shift):
    objective = DiceObjective([straight(shift)], BELIEF, workers=1)
    found = objective.overlaps([neo_hookean(20e3)])
    half = shift / 0.02
    wanted = 2 / np.pi * (np.arccos(half) - half * np.sqrt(1 - half**2))
    assert found.shape == (1, 1) == (1, objective.size())
    # the simulated section's flat triangles lose 0.3 % of the area
    assert found[0, 0] == pytest.approx(wanted, abs=0.002)


def test_cost_is_the_dice_lost_over_the_scale():
    objective = DiceObjective([straight(0.001)], BELIEF, workers=1)
    law = parametrisation("neo-hookean")
    problem = Problem(parametrisation=law, objectives=(OfMaterial(law, objective),))
    u = problem.parametrisation.start(shear=20e3)
    lost = 1 - objective.overlaps([problem.parametrisation.material(u)])[0, 0]
    assert objective.points == 1
    assert problem.costs(u[None])[0] == pytest.approx(lost / SCALE**2, rel=1e-9)
    assert problem.linearise(u)  # there are no nuisances to update


def test_dice_is_largest_at_the_modulus_that_the_elastica_was_made_with():
    shear = 500e3
    objective = DiceObjective([bent(shear)], BELIEF, workers=1)
    factors = np.exp(np.arange(-4, 5) * 0.02)
    cost = (objective.residuals([neo_hookean(f * shear) for f in factors]) ** 2).sum(axis=1)
    assert abs(np.log(factors[cost.argmin()])) <= 0.0201
    assert cost[0] > 3 * cost.min() < cost[-1]


def test_material_without_an_answer_has_none_and_leaves_the_others_theirs():
    coarse = Fidelity(radial_elements=1, axial_element_size=0.02)
    objective = DiceObjective([bent(500e3)], BELIEF, fidelity=coarse, workers=1)
    rows = objective.residuals([neo_hookean(500e3), neo_hookean(60.0)])
    assert np.isfinite(rows[0]).all()
    assert np.isnan(rows[1]).all()


def test_refuses_what_it_cannot_use():
    good = straight(0.0)
    with pytest.raises(InputError, match=r"materials\.soft\.density_kg_m3"):
        DiceObjective([good], MaterialBelief(name="soft"))
    with pytest.raises(InputError, match="at least one beam with a traced outline"):
        DiceObjective([], BELIEF)
    outline = good.captures[1].outline
    short = trial(outline.upper[:20], outline.lower[:20], length=0.1, radius=0.01)
    with pytest.raises(InputError, match="trial cantilever at 100 s: outline"):
        DiceObjective([short], BELIEF)


@pytest.mark.slow
def test_search_finds_the_modulus():
    shear = 500e3
    objective = DiceObjective([bent(shear)], BELIEF, workers=1)
    law = parametrisation("neo-hookean").holding("bulk_ratio")
    problem = Problem(parametrisation=law, objectives=(OfMaterial(law, objective),))
    found = search(
        problem, start=law.start(shear=300e3), spread=law.spread, options=CmaOptions(max_generations=100)
    )
    assert found.reason.startswith("converged")
    assert law.moduli(found.u).shear_modulus == pytest.approx(shear, rel=0.015)
