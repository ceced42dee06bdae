"""Dynamics of beams: BDF2 and central differences."""
