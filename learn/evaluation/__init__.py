"""Evaluation: metrics of trained runs beside baselines, conformal intervals, the report."""

from learn.evaluation.ensembles import ensembles, join_runs
from learn.evaluation.evaluation import Evaluation, evaluate
from learn.evaluation.intervals import Intervals, coverage, fit_intervals
from learn.evaluation.intervals_file import load_intervals, replaced_text, save_intervals
from learn.evaluation.new_to_run import parts_of
from learn.evaluation.predictions import predict_on, predict_part, symmetry_error
from learn.evaluation.summary import Value, by_softness, over_folds, summarise

__all__ = [
    "Evaluation",
    "Intervals",
    "Value",
    "by_softness",
    "coverage",
    "ensembles",
    "evaluate",
    "fit_intervals",
    "join_runs",
    "load_intervals",
    "over_folds",
    "parts_of",
    "predict_on",
    "predict_part",
    "replaced_text",
    "save_intervals",
    "summarise",
    "symmetry_error",
]
