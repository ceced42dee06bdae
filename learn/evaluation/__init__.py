"""Evaluation: cases, summaries, symmetry, clouds, intervals, the report."""

from learn.evaluation.evaluation import Evaluation, ensembles, evaluate, together
from learn.evaluation.intervals import Intervals, coverage, fit_intervals
from learn.evaluation.kept import load_intervals, save_intervals
from learn.evaluation.parts import parts_of, split_of
from learn.evaluation.report import write_report

__all__ = [
    "Evaluation",
    "Intervals",
    "coverage",
    "ensembles",
    "evaluate",
    "fit_intervals",
    "load_intervals",
    "parts_of",
    "save_intervals",
    "split_of",
    "together",
    "write_report",
]
