"""Modulus errors of simulation shortcuts, each alone: `python -m studies.corrections`."""
