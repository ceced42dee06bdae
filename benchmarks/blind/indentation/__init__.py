"""Indentation tests with a hidden cause."""

from benchmarks.blind.indentation.cases import draw_cases, make_poke, write
from benchmarks.blind.indentation.model import LIBRARY, OUTSIDE, Case, Hidden, Trial

__all__ = ["LIBRARY", "OUTSIDE", "Case", "Hidden", "Trial", "draw_cases", "make_poke", "write"]
