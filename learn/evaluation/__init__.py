"""Evaluation: cases, summaries, symmetry, clouds, intervals, the report."""

from learn.evaluation.evaluation import Evaluation, evaluate, split_of
from learn.evaluation.intervals import Intervals, coverage, fit_intervals
from learn.evaluation.report import write_report

__all__ = ["Evaluation", "Intervals", "coverage", "evaluate", "fit_intervals", "split_of", "write_report"]
