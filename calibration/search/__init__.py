"""The search: CMA-ES on a population at once, a Gauss-Newton polish, and what the data cannot see."""

from calibration.search.cma_search import CmaOptions, Found, Generation, search
from calibration.search.guess import guess
from calibration.search.identify import Estimate, Identification, identify
from calibration.search.polish import Polished, polish
from calibration.search.problem import Objective, Problem
from calibration.search.profile import profile

__all__ = [
    "CmaOptions",
    "Estimate",
    "Found",
    "Generation",
    "Identification",
    "Objective",
    "Polished",
    "Problem",
    "guess",
    "identify",
    "polish",
    "profile",
    "search",
]
