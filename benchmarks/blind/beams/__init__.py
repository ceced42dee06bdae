"""Photographed silicone beams under their own weight, with a hidden effect.

Elements, solver, tracing, registration and noise are the laboratory's own. `make` generates and stores cases,
`run` diagnoses and scores them.
"""
