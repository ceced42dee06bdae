"""Criterion for compression in homogeneous material tests."""

PRESSED = 0.97  # a uniaxial test that reaches a smaller stretch is a compression test
