"""Evaluation: cases, summaries, symmetry, clouds, intervals, the report."""

from learn.evaluation.evaluation import Evaluation, ensembles, evaluate, split_of, together
from learn.evaluation.intervals import Intervals, coverage, fit_intervals
from learn.evaluation.kept import load_intervals, save_intervals
from learn.evaluation.report import write_report

__all__ = [
    "Evaluation",
    "Intervals",
    "coverage",
    "ensembles",
    "evaluate",
    "fit_intervals",
    "load_intervals",
    "save_intervals",
    "split_of",
    "together",
    "write_report",
]
