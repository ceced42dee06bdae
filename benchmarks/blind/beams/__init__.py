"""Silicone beams under their own weight, photographed, with a hidden effect.

Elements, solver, tracing, registration and noise are the laboratory's own. `make` makes and stores cases,
`run` diagnoses and scores them.
"""
