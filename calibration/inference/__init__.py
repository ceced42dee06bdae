"""Inference: a law's constants from measurements, by global search, Gauss-Newton and profile likelihood.

Nothing here knows what is measured. An `Objective` turns search coordinates u of a law
(`calibration.parameters`) into whitened residuals; a `Problem` is one law and any number of objectives:

    problem = Problem(parametrisation=parametrisation("ogden"), objectives=(outlines, coupon))
    start = guess(problem)                                        scan of the shear modulus
    found = search(problem, start=start, spread=...)              CMA-ES: resumable, one batch a generation
    end = polish(problem, found.u)                                Gauss-Newton with step control
    known = identify(problem.parametrisation, end.u, end.jacobian, reduced_chi2=...)
    profile(problem, end, known)                                  likelihood intervals where bars are wide

An objective whose residuals are linearised (nuisances, mesh error) also has `linearise(u) -> bool`.
Measurement models become objectives by `calibration.measurements.objective.ModelObjective`, objectives that
depend on the material alone by `OfMaterial`.
"""

from calibration.inference.polish import Polished, polish
from calibration.inference.problem import Linearised, MaterialObjective, Objective, OfMaterial, Problem
from calibration.inference.profile_likelihood import profile
from calibration.inference.search import CmaOptions, Found, Generation, HistoryError, guess, search
from calibration.inference.uncertainty import (
    LEVEL,
    WIDTH,
    Estimate,
    Identification,
    between_specimens,
    identify,
    with_prior_sd,
)

__all__ = [
    "LEVEL",
    "WIDTH",
    "CmaOptions",
    "Estimate",
    "Found",
    "Generation",
    "HistoryError",
    "Identification",
    "Linearised",
    "MaterialObjective",
    "Objective",
    "OfMaterial",
    "Polished",
    "Problem",
    "between_specimens",
    "guess",
    "identify",
    "polish",
    "profile",
    "search",
    "with_prior_sd",
]
