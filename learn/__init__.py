"""Surrogates of simulated pokes: the dataset's loader, models, training, evaluation, prediction.

Reads the dataset's file format and imports none of the programs that write it.
"""
