"""Benchmarks: references by other solvers, costs beside other programs, and the blind laboratory."""
