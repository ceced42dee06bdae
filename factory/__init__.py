"""Datasets of simulated pokes: built, resumed, inspected, verified."""
